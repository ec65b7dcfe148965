// Long work on a thread of its own, while the caller's thread reports progress and may stop it:
// also where a server keeps everybody waiting. For the libraries and programs.
#pragma once

#include <atomic>
#include <chrono>
#include <future>
#include <stop_token>
#include <type_traits>

namespace palpate::stream {

/// Calls work(stop) or work(stop, made) on another thread, and returns or throws its result. `tell`
/// (an OnProgress, or a function without arguments) is called on this thread before the work and
/// then every 20 ms. An exception of `tell` stops the work and is passed on. `tell` gets `made`,
/// the part that the work says is done, at first 0. Without `tell`, the work runs on this thread.
template <class Tell, class Work>
auto while_telling(const Tell& tell, Work&& work) {
    constexpr std::chrono::milliseconds between{20};
    std::atomic<double> made{0};
    const auto run = [&](const std::stop_token& stop) {
        if constexpr (std::is_invocable_v<Work, std::stop_token, std::atomic<double>&>) {
            return work(stop, made);
        } else {
            return work(stop);
        }
    };
    const auto say = [&] {
        if constexpr (std::is_invocable_v<Tell, double>) {
            tell(made);
        } else {
            tell();
        }
    };
    if (!tell) return run({});
    say();
    std::stop_source stop;
    auto result = std::async(std::launch::async, [&] { return run(stop.get_token()); });
    while (result.wait_for(between) != std::future_status::ready) {
        try {
            say();
        } catch (...) {
            stop.request_stop();
            result.wait();
            throw;
        }
    }
    return result.get();
}

}  // namespace palpate::stream
