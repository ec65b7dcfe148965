// A section of the panel under a heading that folds it, with a note for refusals.
#pragma once

#include <QLabel>
#include <QToolButton>
#include <QWidget>

namespace palpate::viewer {

/// A line or more of text that wraps, and is not there while it is empty.
class Note : public QLabel {
  public:
    enum class Kind { plain, warning };
    Note(const QString& name, Kind kind);
    void say(const QString& text);

  protected:
    void changeEvent(QEvent* event) override;

  private:
    void paint_text();

    Kind kind_;
};

class Section : public QWidget {
    Q_OBJECT

  public:
    /// Takes ownership of the content. `name` is that of the object; its heading is NAME_heading,
    /// its message NAME_message.
    Section(const QString& title, const QString& name, QWidget* content);

    void set_open(bool open);
    bool is_open() const { return heading_->isChecked(); }
    /// Why something was refused; empty: all is well. Opens the section.
    void say(const QString& why);

  private:
    QToolButton* heading_;
    QWidget* content_;
    Note* message_;
};

}  // namespace palpate::viewer
