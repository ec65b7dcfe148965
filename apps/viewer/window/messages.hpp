// Messages for the user: problems in a dialog and on standard error, results in the status bar.
#pragma once

#include <QObject>
#include <QString>
#include <functional>

#include "apps/options/exit_status.hpp"

class QWidget;

namespace palpate::viewer {

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
    /// What dialogs belong to.
    QWidget* window() const { return window_; }

  Q_SIGNALS:
    void done(const QString& what);

  private:
    QWidget* window_;
    QString problem_;
    int problem_status_ = 0;
};

}  // namespace palpate::viewer
