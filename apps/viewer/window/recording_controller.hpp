// Records the live run, all hands into one file.
#pragma once

#include <QObject>
#include <QString>

namespace palpate::io {
class RecordingWriter;
}

namespace palpate::viewer {

class Content;
class Messages;

class RecordingController : public QObject {
    Q_OBJECT

  public:
    RecordingController(Content& content, Messages& messages);

    /// Errors are shown.
    void start(const QString& path);
    void stop();
    bool recording() const { return writer() != nullptr; }
    /// Ends a recording that cannot be written any more, which shows why.
    void check();
    /// 0, or the status for a program in which a recording was lost.
    int exit_status() const { return exit_status_; }

  Q_SIGNALS:
    void changed();

  private:
    const io::RecordingWriter* writer() const;
    void tell_playback();
    double seconds() const;

    Content& content_;
    Messages& messages_;
    int exit_status_ = 0;
    double began_ = 0;  // [s] of the run
};

}  // namespace palpate::viewer
