// The status bar: messages, and beside them the readout, which makes room for a message that needs
// it. A message that is too long even then ends with dots, and the tip has all of it.
#pragma once

#include <QLabel>
#include <QStatusBar>

namespace palpate::viewer {

class StatusBar : public QStatusBar {
    Q_OBJECT

  public:
    explicit StatusBar(QWidget* parent);

    void show_readout(const QString& text);

  protected:
    void paintEvent(QPaintEvent* event) override;
    void resizeEvent(QResizeEvent* event) override;

  private:
    void show_message(const QString& text);
    void make_room();
    /// Left of the widgets that are seen.
    QRect room() const;

    QLabel* readout_;
};

}  // namespace palpate::viewer
