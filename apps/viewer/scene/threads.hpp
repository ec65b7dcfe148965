// Background threads: their priority, and work that they leave to the window's thread.
#pragma once

#include <QMetaObject>
#include <QObject>

#include <sys/resource.h>
#include <utility>

namespace palpate::viewer {

/// Calls `work` on the thread of `object`, unless that was destroyed before.
template <class Work>
void hand_over(QObject* object, Work work) {
    QMetaObject::invokeMethod(object, std::move(work), Qt::QueuedConnection);
}

/// Lowers the priority of the calling thread and of those that it starts below the servo's and the
/// window's: Linux keeps the niceness by thread. Does nothing where the system does not support it.
inline void lower_thread_priority() noexcept {
    constexpr int niceness = 10;
    (void)::setpriority(PRIO_PROCESS, 0, niceness);
}

}  // namespace palpate::viewer
