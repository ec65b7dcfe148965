// What a new user reads: the page of an empty window, and the dialogs of the menu Help.
#pragma once

#include <QWidget>

class QLabel;
class QVBoxLayout;

class QDialog;
class QWidget;

namespace palpate::viewer {

class Welcome : public QWidget {
    Q_OBJECT

  public:
    explicit Welcome(QWidget* parent = nullptr);

    /// The recent files as they are now.
    void refresh();
    /// A sentence about the devices that were found.
    void set_devices(const QString& words);

  Q_SIGNALS:
    void open_asked();
    void folder_asked();
    void sample_asked();
    void recent_chosen(const QString& path);

  private:
    QWidget* recent_;
    QLabel* devices_;
};

/// How to open, touch and edit a volume, on a page.
QDialog* make_first_steps_dialog(QWidget* window);
/// The shortcuts of all actions of `window`, and what the mouse does.
QDialog* make_shortcuts_dialog(QWidget* window);
/// Versions, source and licence.
QDialog* make_about_dialog(QWidget* window);

}  // namespace palpate::viewer
