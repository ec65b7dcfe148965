// Dequantization: time of the 8-bit ball at 128^3 and 256^3, on one and on all cores.
#include <benchmark/benchmark.h>

#include "palpate/filters/dequantize.hpp"
#include "palpate/scenes/volumes.hpp"

namespace palpate::benchmarks {
namespace {

void dequantize(benchmark::State& state) {
    const Volume volume = scenes::ball(Index3::Constant(static_cast<int>(state.range(0))));
    filters::DequantizeOptions options;
    options.threads = static_cast<int>(state.range(1));
    for (auto _ : state) {
        benchmark::DoNotOptimize(filters::dequantized(volume, options).data());
    }
    state.counters["samples_per_s"] =
        benchmark::Counter(double(volume.bytes()), benchmark::Counter::kIsIterationInvariantRate);
}
BENCHMARK(dequantize)
    ->ArgNames({"edge", "threads"})
    ->ArgsProduct({{128, 256}, {1, 0}})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime()
    ->MeasureProcessCPUTime();

}  // namespace
}  // namespace palpate::benchmarks
