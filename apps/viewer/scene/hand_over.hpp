// Work for the window's thread from other threads.
#pragma once

#include <QMetaObject>
#include <QObject>

#include <utility>

namespace palpate::viewer {

/// Calls `work` on the thread of `object`, unless that was destroyed before.
template <class Work>
void hand_over(QObject* object, Work work) {
    QMetaObject::invokeMethod(object, std::move(work), Qt::QueuedConnection);
}

}  // namespace palpate::viewer
