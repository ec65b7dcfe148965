// Other costs by the size of the data: a density at a point, the whole surface.
#include <benchmark/benchmark.h>

#include <string>
#include <vector>

#include "palpate/field.hpp"
#include "palpate/scenes/volumes.hpp"
#include "palpate/surface.hpp"
#include "scenes/random.hpp"

namespace palpate::benchmarks {
namespace {

/// Points all over the cylinder's volume, and a little outside.
std::vector<Vec3> scattered_points() {
    scenes::Random random(5);
    std::vector<Vec3> points(4096);
    for (Vec3& p : points) {
        p = {random.uniform(-52, 52), random.uniform(-52, 52), random.uniform(-16, 16)};
    }
    return points;
}

template <class Evaluate>
void evaluate(benchmark::State& state, Evaluate&& at) {
    const Field field =
        linear_field(scenes::make_volume("cylinder:100x100x30", SampleType::uint8).volume);
    const std::vector<Vec3> points = scattered_points();
    std::size_t i = 0;
    for (auto _ : state) {
        benchmark::DoNotOptimize(at(field, points[i]));
        i = (i + 1) % points.size();
    }
}

void density(benchmark::State& state) {
    evaluate(state, [](const Field& f, const Vec3& p) { return value_at(f, p); });
}
void gradient(benchmark::State& state) {
    evaluate(state, [](const Field& f, const Vec3& p) { return gradient_at(f, p); });
}

void surface(benchmark::State& state, const std::string& spec) {
    const scenes::Scene scene = scenes::make_volume(spec);
    const Field field = linear_field(scene.volume);
    std::size_t triangles = 0;
    for (auto _ : state) triangles = extract_surface(field, scene.isovalue).triangles.size();
    // Cells of the padded grid: one more than samples along each axis.
    const Index3 n = scene.volume.geometry().size + Index3::Ones();
    const double cells = double(n[0]) * n[1] * n[2];
    using benchmark::Counter;
    state.counters["triangles"] = double(triangles);
    // Seconds by this unit; the console shows it as 12n, nanoseconds.
    state.counters["s_per_cell"] =
        Counter(cells, Counter::kIsIterationInvariantRate | Counter::kInvert);
    state.counters["s_per_triangle"] =
        Counter(double(triangles), Counter::kIsIterationInvariantRate | Counter::kInvert);
}

BENCHMARK(density)->Name("point/value_at");
BENCHMARK(gradient)->Name("point/gradient_at");
BENCHMARK_CAPTURE(surface, cylinder, "cylinder:100x100x30")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(surface, marschner_lobb, "marschner-lobb:96x96x96")
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(surface, noise, "noise:48x48x48")->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace palpate::benchmarks
