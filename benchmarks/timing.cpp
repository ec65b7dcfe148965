// The figures of a benchmark, from its times.
#include "benchmarks/timing.hpp"

#include <numeric>

namespace palpate::benchmarks {
namespace {

/// The value that a share of all values does not exceed. Sorted input.
double quantile(const std::vector<double>& sorted, double share) {
    const double last = static_cast<double>(sorted.size() - 1);
    return sorted[static_cast<std::size_t>(share * last)];
}

/// The time of an empty interval (median).
double clock_cost() {
    std::vector<double> empty(10001);
    for (double& ns : empty) {
        const auto begin = Clock::now();
        ns = nanoseconds(Clock::now() - begin);
    }
    std::sort(empty.begin(), empty.end());
    return quantile(empty, 0.5);
}

}  // namespace

void report_times(benchmark::State& state, std::vector<double> batch_means,
                  std::vector<double> single_ticks) {
    std::sort(batch_means.begin(), batch_means.end());
    std::sort(single_ticks.begin(), single_ticks.end());
    const double sum = std::accumulate(batch_means.begin(), batch_means.end(), 0.0);
    state.counters["mean_ns"] = sum / static_cast<double>(batch_means.size());
    state.counters["median_ns"] = quantile(batch_means, 0.5);
    state.counters["least_ns"] = batch_means.front();
    state.counters["p50"] = quantile(single_ticks, 0.5);
    state.counters["p99"] = quantile(single_ticks, 0.99);
    state.counters["p99.9"] = quantile(single_ticks, 0.999);
    state.counters["max"] = single_ticks.back();
    state.counters["clock_ns"] = clock_cost();
}

}  // namespace palpate::benchmarks
