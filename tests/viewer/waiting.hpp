// Waits of the tests of windows: for what must come, for as long as it takes. No clock decides
// whether a test passes; what never comes ends with ctest's timeout.
#pragma once

#include <QApplication>
#include <QEventLoop>
#include <QTimer>
#include <QWidget>
#include <QWindow>

#include <cstdio>
#include <functional>
#include <source_location>

namespace palpate::viewer {

/// Handles the events that are there, and deletes what is to be deleted later.
inline void handle_events(QEventLoop::ProcessEventsFlags how = QEventLoop::AllEvents) {
    QCoreApplication::processEvents(how);
    QCoreApplication::sendPostedEvents(nullptr, QEvent::DeferredDelete);
}

/// Handles events until it is so. What a thread does may come without an event: looks every few
/// milliseconds. A long wait tells where it is, for whoever reads the log of a test that hangs.
inline void wait_until(const std::function<bool()>& so,
                       const std::source_location& here = std::source_location::current()) {
    constexpr int look_ms = 2, tell_after = 15'000;
    int looks = 0;
    QTimer look;
    QObject::connect(&look, &QTimer::timeout, [&] {
        if (++looks % tell_after == 0) {
            std::fprintf(stderr, "still waiting at %s:%u\n", here.file_name(), here.line());
        }
    });
    look.start(look_ms);
    while (!so()) handle_events(QEventLoop::WaitForMoreEvents);
}

inline void wait_until_exposed(const QWidget& window) {
    wait_until([&] { return window.windowHandle() && window.windowHandle()->isExposed(); });
}

/// Keys go to the window of this widget from now on.
inline void activate(QWidget& widget) {
    wait_until_exposed(*widget.window());
    QApplication::setActiveWindow(widget.window());
}

/// Whether something is held back: a timer that ends once waits.
inline bool holds_back(const QObject& object) {
    for (const QTimer* timer : object.findChildren<QTimer*>()) {
        if (timer->isSingleShot() && timer->isActive()) return true;
    }
    return false;
}

/// Until nothing is held back any more, and what that led to is done.
inline void wait_until_quiet(const QObject& object) {
    do {
        wait_until([&] { return !holds_back(object); });
        handle_events();
    } while (holds_back(object));
}

}  // namespace palpate::viewer
