// Waits of the tests of windows: until something is so, however slow the machine.
#pragma once

#include <QElapsedTimer>
#include <QTest>
#include <QWidget>
#include <functional>

namespace palpate::viewer {

/// In milliseconds; far longer than anything takes. Qt's own patience (5 s) is too short where
/// several programs with windows start at once.
constexpr int patience = 120'000;

/// Runs the event loop until it is so; false if it never is within `patience`.
inline bool wait_until(const std::function<bool()>& so) {
    QElapsedTimer clock;
    clock.start();
    while (!so()) {
        if (clock.elapsed() > patience) return false;
        QTest::qWait(5);
    }
    return true;
}

inline bool wait_until_exposed(QWidget& window) {
    return QTest::qWaitForWindowExposed(&window, patience);
}

/// Until keys go to the window of a widget. Before, those that it does not claim (arrows in a list
/// of choices) go to the shortcuts of the window that is active. X refuses the focus to a window
/// that is not mapped yet, and without a window manager nothing asks again: this does.
inline bool wait_until_active(QWidget& widget) {
    QWidget& window = *widget.window();
    return wait_until_exposed(window) && wait_until([&window] {
               if (!window.isActiveWindow()) window.activateWindow();
               return window.isActiveWindow();
           });
}

}  // namespace palpate::viewer
