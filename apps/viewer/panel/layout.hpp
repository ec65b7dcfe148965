// Short ways to build sections of the panel: named widgets, rows, columns and form rows without
// margins, notes, and headings that fold.
#pragma once

#include <QAbstractButton>
#include <QDialogButtonBox>
#include <QFormLayout>
#include <QLabel>
#include <QRegularExpression>
#include <QToolButton>
#include <QWidget>

#include <initializer_list>
#include <type_traits>

class QBoxLayout;
class QDialog;
class QPushButton;

namespace palpate::viewer {

/// What a tip begins with, up to its first sign.
inline QString first_words(const QString& tip) {
    return tip.left(tip.indexOf(QRegularExpression("[.;:\\n]"))).trimmed();
}

/// Sets object name and tooltip, and by its first words the name for screen readers, which that of
/// a button or a label overrides; returns the widget.
template <class Widget>
Widget* named(Widget* widget, const QString& name, const QString& tip = {}) {
    widget->setObjectName(name);
    widget->setToolTip(tip);
    constexpr bool has_words =
        std::is_base_of_v<QAbstractButton, Widget> || std::is_base_of_v<QLabel, Widget>;
    if constexpr (!has_words) widget->setAccessibleName(first_words(tip));
    return widget;
}

/// Lays widgets out in `owner`, side by side or one below the other. More can be added. A row that
/// is too narrow goes on in the next line.
QBoxLayout* row_in(QWidget* owner, std::initializer_list<QWidget*> widgets = {});
QBoxLayout* column_in(QWidget* owner, std::initializer_list<QWidget*> widgets = {});
/// A widget that holds these side by side, or one below the other. Of a row, the `wide`-th, from 0,
/// takes the room that is left.
QWidget* row_of(std::initializer_list<QWidget*> widgets, int wide = -1);
QWidget* column_of(std::initializer_list<QWidget*> widgets);
QLabel* label_for(const QString& text, QWidget* field);
/// A form without margins, dense. Where it is narrow, labels are above their fields.
QFormLayout* form_in(QWidget* owner = nullptr);
/// A row of a form, whose label has the tip, too, and is the field's name for screen readers.
void add_row(QFormLayout& form, const QString& label, QWidget* field, const QString& tip);

/// Puts the content into a dialog, over a button that accepts it, which is returned, and one that
/// cancels.
QPushButton* fill(QDialog& dialog, QWidget* content, QDialogButtonBox::StandardButton accept);
/// Empty: it can be used. Else it is grey, and its tip says why instead of what it is for.
void allow(QWidget& widget, const QString& why);
void make_bold(QWidget& widget, bool bold = true);
/// Return presses the buttons in `parent` that are there now: the space bar is the window's, for
/// the forces.
void let_return_press_buttons(QWidget& parent);

/// A text about its owner that holds for now. It takes no room, so that nothing jumps when it
/// comes: the window shows it over the picture (Hints), and the tip of its section's heading has
/// it, too.
class Note : public QLabel {
    Q_OBJECT

  public:
    enum class Kind { plain, warning };
    Note(QWidget* owner, const QString& name, Kind kind);
    void say(const QString& text);
    Kind kind() const { return kind_; }

  private:
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
    /// Marks the heading while there are notes, and puts them into its tip.
    void show_notes();

  private:
    const QString title_;
    QToolButton* heading_;
    QWidget* content_;
    Note* message_;
};

}  // namespace palpate::viewer
