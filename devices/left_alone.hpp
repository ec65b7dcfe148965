// Work that cannot be stopped, such as the lookup of a name or a call of a vendor's library.
#pragma once

#include <chrono>
#include <functional>
#include <future>
#include <thread>
#include <utility>

#include "palpate/progress.hpp"

namespace palpate::devices {

/// The result of work(). With `progress`, the work has a thread of its own, and `progress` is
/// called every 20 ms. If that throws, `when_stopped` is called and the exception is passed on at
/// once. The thread then ends by itself, so the work must not use anything of the caller's.
template <class Work>
auto left_alone_when_stopped(
    const OnProgress& progress, Work work, const std::function<void()>& when_stopped = [] {}) {
    constexpr std::chrono::milliseconds between{20};
    if (!progress) return work();
    progress(0);
    std::packaged_task<decltype(work())()> task(std::move(work));
    auto result = task.get_future();
    std::thread(std::move(task)).detach();
    try {
        while (result.wait_for(between) != std::future_status::ready) progress(0);
    } catch (...) {
        when_stopped();
        throw;
    }
    return result.get();
}

}  // namespace palpate::devices
