// Watches a task: its thread wakes the window's thread, which looks how far it is.
#include "apps/viewer/window/background_task.hpp"

#include <QString>
#include <utility>

#include "apps/viewer/window/messages.hpp"

namespace palpate::viewer {

void BackgroundTask::start(const QString& label, Work::Task task, std::function<void()> then) {
    abandon();
    then_ = std::move(then);
    Q_EMIT began(label);
    work_ = std::make_unique<Work>(std::move(task), [this] {
        QMetaObject::invokeMethod(
            this, [this] { look(); }, Qt::QueuedConnection);
    });
}

void BackgroundTask::look() {
    if (!work_) return;
    Q_EMIT progressed(work_->progress());
    if (!work_->ended()) return;
    const auto ended_work = std::move(work_);
    const auto then = std::exchange(then_, nullptr);
    Q_EMIT ended();
    messages_.guarded([&] {
        if (ended_work->finish()) then();
    });
}

void BackgroundTask::cancel() {
    if (work_) work_->cancel();
}

void BackgroundTask::abandon() {
    if (!work_) return;
    work_.reset();
    then_ = nullptr;
    Q_EMIT ended();
}

}  // namespace palpate::viewer
