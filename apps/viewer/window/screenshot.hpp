// Saves a picture of the window for scripts, once everything is loaded and drawn.
#pragma once

#include <QObject>
#include <QTimer>

namespace palpate::viewer {

class MainWindow;

/// Waits until the run or recording has reached the time and the window has settled, writes the
/// picture and closes the window.
class Screenshot : public QObject {
  public:
    /// `after` [s] of the session; of a recording, from its beginning.
    Screenshot(MainWindow& window, const QString& path, double after);
    int status() const { return status_; }

  private:
    void look();
    bool reached();

    MainWindow& window_;
    QString path_;
    double after_;
    bool held_ = false;
    int quiet_ = 0, status_ = 0;
    QTimer timer_;
};

}  // namespace palpate::viewer
