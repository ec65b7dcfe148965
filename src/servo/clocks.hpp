// What the servo asks of the system's clocks and threads: time, sleep until a time, CPU time, and
// whether a thread could run. clocks.cpp for Linux, clocks_windows.cpp for Windows.
#pragma once

#include <cstdint>

namespace palpate {

/// The machine's monotonic clock [ns].
std::int64_t monotonic_ns() noexcept;

/// CPU time of the calling thread [ns]. Where the system counts it too coarsely for a tick, the
/// monotonic clock.
std::int64_t thread_cpu_ns() noexcept;

/// Sleeps until a time of the monotonic clock, as exactly as the system can. For one thread.
class Alarm {
  public:
    Alarm() noexcept;
    ~Alarm();  // NOLINT(performance-trivially-destructible): does something on Windows
    Alarm(const Alarm&) = delete;
    Alarm& operator=(const Alarm&) = delete;

    /// Returns at once when `ns` is past.
    void sleep_until(std::int64_t ns) noexcept;

  private:
    void* timer_ = nullptr;  // the system's, where it has one
};

/// How other threads ask about a thread. Aligned so that clang, too, exchanges it without a lock.
struct alignas(8) ThreadId {
    std::int32_t number = 0;  // as the kernel counts
    std::int32_t clock = 0;   // of its CPU time
};
ThreadId calling_thread() noexcept;

/// CPU time of a thread [ns]; 0 if the system does not tell.
std::int64_t cpu_ns(ThreadId thread) noexcept;

/// Whether the thread could run or does, as opposed to waiting. False if the system does not tell.
/// Allocates nothing: the thread asked about may hold the heap's lock.
bool is_runnable(ThreadId thread) noexcept;

}  // namespace palpate
