// Runs long work on a thread of its own and handles its result on the window's thread.
#pragma once

#include <QObject>
#include <QString>
#include <functional>
#include <memory>

#include "apps/viewer/model/worker.hpp"

class QWidget;

namespace palpate::viewer {

class Messages;

/// One task at a time.
class BackgroundTask : public QObject {
    Q_OBJECT

  public:
    explicit BackgroundTask(Messages& messages) : messages_(messages) {}

    /// Abandons the previous task. `then` runs on the window's thread once `task` is done, not if
    /// it was cancelled. What either throws is shown.
    void start(const QString& label, Worker::Task task, std::function<void()> then);
    /// The task stops at its next progress.
    void cancel();
    /// Stops the task and waits for its thread.
    void abandon();
    bool busy() const { return worker_ != nullptr; }

  Q_SIGNALS:
    void began(const QString& label);
    /// `fraction` from 0 to 1.
    void progressed(double fraction);
    /// Before `then` runs.
    void ended();

  private:
    void look();

    Messages& messages_;
    std::unique_ptr<Worker> worker_;
    std::function<void()> then_;
};

/// Shows the progress of a task, with a button to cancel it; hidden while there is none.
QWidget* make_progress_strip(BackgroundTask& task);

}  // namespace palpate::viewer
