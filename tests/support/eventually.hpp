// Waits until a condition that other threads or programs cause becomes true. Tests of a class
// with a step() call that instead and do not wait.
#pragma once

#include <chrono>
#include <thread>

namespace palpate::support {

/// Whether `condition` comes to hold. What is waited for comes in milliseconds; the patience of two
/// minutes is for slow machines.
template <class Condition>
bool comes_true(Condition&& condition) {
    using namespace std::chrono_literals;
    const auto end = std::chrono::steady_clock::now() + 2min;
    while (!condition()) {
        if (std::chrono::steady_clock::now() > end) return false;
        std::this_thread::sleep_for(1ms);
    }
    return true;
}

}  // namespace palpate::support
