// What an empty window shows: what can be opened, how to touch it, and which devices there are.
#pragma once

#include <QWidget>

class QLabel;
class QVBoxLayout;

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

}  // namespace palpate::viewer
