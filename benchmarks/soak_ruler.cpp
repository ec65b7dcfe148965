// palpate_soak_ruler: a loop that sleeps and wakes as the servo does and only multiplies. Whatever
// it takes beyond its median is due to the machine: interrupts within a tick count as the tick's
// own CPU time, and when they come depends on the phase of the loop.
#include <fmt/format.h>
#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <memory>

#include "benchmarks/soak_meter.hpp"

namespace palpate::benchmarks {
namespace {

constexpr std::int64_t cycle = 4'000'000;   // [ns] of a kernel with 250 timer interrupts a second
constexpr std::int64_t period = 1'000'370;  // [ns] moves through the cycle, place by place
constexpr std::size_t places = 100;
constexpr int multiplications = 5000;  // some 8 us

/// Uses no memory, and does not depend on earlier calls.
std::uint64_t multiply(std::uint64_t x) {
    for (int i = 0; i < multiplications; ++i) x = x * 6364136223846793005U + 1442695040888963407U;
    return x;
}

void sleep_until(std::int64_t ns) {
    const timespec t{ns / 1'000'000'000, ns % 1'000'000'000};
    while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &t, nullptr) == EINTR) {
    }
}

/// CPU time of ticks by when in a cycle they are due, and of all.
struct Measured {
    std::array<LatencyHistogram, places> at;
    LatencyHistogram all;
};

void measure(Measured& measured, std::int64_t ticks) {
    std::uint64_t x = 1;
    std::int64_t due = now_ns(CLOCK_MONOTONIC) + period;
    for (std::int64_t i = 0; i < ticks; ++i) {
        sleep_until(due);
        const std::int64_t begin = now_ns(CLOCK_THREAD_CPUTIME_ID);
        x = multiply(x);
        const std::int64_t cpu = now_ns(CLOCK_THREAD_CPUTIME_ID) - begin;
        measured.all.add(cpu);
        measured.at[static_cast<std::size_t>(due % cycle) * places / cycle].add(cpu);
        due += period * std::max<std::int64_t>(1, (now_ns(CLOCK_MONOTONIC) - due) / period);
    }
    if (x == 0) std::abort();  // never; so x is needed
}

double us(std::int64_t ns) {
    return 1e-3 * static_cast<double>(ns);
}

}  // namespace
}  // namespace palpate::benchmarks

int main(int argc, char** argv) {
    using namespace palpate::benchmarks;
    const std::int64_t ticks = argc > 1 ? std::atoll(argv[1]) : 60'000;
    sched_param parameter{};
    parameter.sched_priority = 80;
    const bool real_time = pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameter) == 0;
    const auto measured = std::make_unique<Measured>();
    const bool locked = mlockall(MCL_CURRENT) == 0;
    measure(*measured, ticks);

    const palpate::LatencySummary all = measured->all.summary();
    fmt::print(
        "{} ticks, SCHED_FIFO: {}, memory locked: {}\n"
        "CPU time of multiplying: p50 {:.1f}, p99 {:.1f}, p99.9 {:.1f}, max {:.1f} us\n",
        ticks, real_time, locked, us(all.p50), us(all.p99), us(all.p999), us(all.max));
    std::array<std::int64_t, places> p99{};
    for (std::size_t i = 0; i < places; ++i) p99[i] = measured->at[i].summary().p99;
    fmt::print("p99 by when in {} ms a tick is due: {:.1f} to {:.1f} us; above twice the median at",
               cycle / 1'000'000, us(std::ranges::min(p99)), us(std::ranges::max(p99)));
    for (std::size_t i = 0; i < places; ++i) {
        if (p99[i] > 2 * all.p50) fmt::print(" {:.2f}", 1e-3 * us(i * cycle / places));
    }
    fmt::print(" ms\n");
}
