// Long work on a thread of its own, while the caller's thread reports progress and may stop it:
// also where a server keeps everybody waiting. For the libraries and programs.
#pragma once

#include <chrono>
#include <functional>
#include <future>
#include <stop_token>

namespace palpate::stream {

/// What work(stop) returns or throws. `tell` is called every 20 ms until then; what it throws stops
/// the work and is thrown. Without `tell`, this thread works itself.
template <class Work>
auto while_telling(const std::function<void()>& tell, Work&& work) {
    constexpr std::chrono::milliseconds between{20};
    std::stop_source stop;
    if (!tell) return work(stop.get_token());
    auto made = std::async(std::launch::async, [&] { return work(stop.get_token()); });
    while (made.wait_for(between) != std::future_status::ready) {
        try {
            tell();
        } catch (...) {
            stop.request_stop();
            made.wait();
            throw;
        }
    }
    return made.get();
}

}  // namespace palpate::stream
