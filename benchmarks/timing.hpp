// Times every benchmark of the servo loop in two ways: batches, which a busy machine disturbs
// little, and single ticks, whose tail matters for a servo loop.
#pragma once

#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <vector>

namespace palpate::benchmarks {

using Clock = std::chrono::steady_clock;

inline double nanoseconds(Clock::duration duration) {
    return std::chrono::duration<double, std::nano>(duration).count();
}

/// Ticks of a batch. A benchmark's iteration is a batch, so its time in us is a tick's in ns.
inline constexpr int batch = 1000;

/// Writes the counters: mean_ns, median_ns, least_ns over the means of the batches; p50, p99,
/// p99.9, max [ns] over single ticks; clock_ns, what reading the clock adds to each of these.
void report_times(benchmark::State& state, std::vector<double> batch_means,
                  std::vector<double> single_ticks);

/// Times `tick` as the iterations of `state`, then as often again one by one (a thousand to a
/// million times).
template <class Tick>
void time_ticks(benchmark::State& state, Tick&& tick) {
    std::vector<double> batch_means;
    for (auto _ : state) {
        const auto begin = Clock::now();
        for (int i = 0; i < batch; ++i) tick();
        batch_means.push_back(nanoseconds(Clock::now() - begin) / batch);
    }
    const std::int64_t singles =
        std::clamp<std::int64_t>(state.iterations() * batch, batch, 1000000);
    std::vector<double> single_ticks(static_cast<std::size_t>(singles));
    for (double& ns : single_ticks) {
        const auto begin = Clock::now();
        tick();
        ns = nanoseconds(Clock::now() - begin);
    }
    report_times(state, std::move(batch_means), std::move(single_ticks));
}

}  // namespace palpate::benchmarks
