// Messages to the user: problems in a dialog and on standard error, results in the status bar, and
// the progress of work on a thread of its own.
#pragma once

#include <QObject>
#include <QString>

#include <chrono>
#include <functional>
#include <memory>

#include "apps/options/exit_status.hpp"
#include "apps/viewer/model/worker.hpp"

class QDialog;
class QMessageBox;
class QWidget;

namespace palpate::viewer {

class BackgroundTask;

class Messages : public QObject {
    Q_OBJECT

  public:
    /// Dialogs belong to `window`.
    explicit Messages(QWidget* window) : window_(window) {}

    /// Runs `action` and shows what it throws. False if it threw.
    bool guarded(const std::function<void()>& action);
    void show_problem(const QString& what, int status = app::bad_input);
    void show_done(const QString& what) { Q_EMIT done(what); }
    /// The last problem as shown and the exit status that stands for it; empty if there was none
    /// since forget().
    const QString& problem() const { return problem_; }
    int problem_status() const { return problem_status_; }
    void forget() { problem_.clear(); }
    /// Nobody is there to answer: questions are problems, or answered with No.
    void set_unattended() { unattended_ = true; }
    /// Opens a dialog that does not block the live run and is deleted afterwards. If nobody is
    /// there, it is a problem in these words, or else in its title.
    void ask(QDialog* dialog, const QString& otherwise = {});
    /// Asks, and returns the button; QMessageBox::Discard if nobody is there.
    int answer_to(QMessageBox& question);
    /// Asks whether to save. True: go on without saving. Calls `save` if the answer is to save.
    /// `name`: of the dialog. `without`: text of the button that does not save; empty: the usual
    /// one.
    bool may_lose(const char* name, const QString& question, const QString& without,
                  const std::function<void()>& save);
    /// What dialogs belong to.
    QWidget* window() const { return window_; }
    /// Those whose progress is shown: all but those that were taken out, by setParent(nullptr).
    QList<BackgroundTask*> tasks() const;

  Q_SIGNALS:
    void done(const QString& what);

  private:
    QWidget* window_;
    QString problem_;
    int problem_status_ = 0;
    bool unattended_ = false;
};

// Runs long work on a thread of its own and handles its result on the window's thread.

/// One task at a time.
class BackgroundTask : public QObject {
    Q_OBJECT

  public:
    explicit BackgroundTask(Messages& messages) : QObject(&messages), messages_(messages) {}

    /// Abandons the previous task. `then` runs on the window's thread once `task` is done, not if
    /// it was cancelled. What either throws is shown.
    void start(const QString& label, Worker::Task task, std::function<void()> then);
    /// The task stops at its next progress.
    void cancel();
    /// Stops the task and waits for its thread.
    void abandon();
    /// Waits for the task, at most for this time, and then abandons it.
    void end_within(std::chrono::milliseconds time);
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

/// Shows the progress of a task that is not done soon, with a button to cancel it.
QWidget* make_progress_strip(BackgroundTask& task);

}  // namespace palpate::viewer
