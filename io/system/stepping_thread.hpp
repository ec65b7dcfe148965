// The thread behind a step(): it calls a function again and again, with a pause between two calls.
#pragma once

#include <chrono>
#include <condition_variable>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>

namespace palpate::io {

using SteadyTime = std::chrono::steady_clock::time_point;

/// Calls `step` with the time until the thread is asked to stop, which ends a pause at once. A step
/// that throws, mostly for want of memory, is tried again after the pause: the program goes on.
inline std::jthread stepping_thread(std::chrono::nanoseconds pause,
                                    std::function<void(SteadyTime now)> step) {
    return std::jthread([pause, step = std::move(step)](const std::stop_token& stop) {
        std::mutex mutex;
        std::condition_variable_any never;
        std::unique_lock lock(mutex);
        while (never.wait_for(lock, stop, pause, [] { return false; }), !stop.stop_requested()) {
            try {
                step(std::chrono::steady_clock::now());
            } catch (const std::exception&) {
            }
        }
    });
}

}  // namespace palpate::io
