// A whole tick, from device state to force, plain and with every effect on.
#include "benchmarks/hand.hpp"
#include "benchmarks/timing.hpp"
#include "palpate/renderer.hpp"

namespace palpate::benchmarks {
namespace {

constexpr double voxels_per_mm = 3;

RendererSettings plain() {
    RendererSettings settings;
    settings.transform.scale = voxels_per_mm;  // a voxel is 1 mm
    return settings;
}

RendererSettings everything() {
    RendererSettings settings = plain();
    settings.proxy.friction = {0.3, 0.2};
    settings.penetrability = penetrability_threshold(2, 0);  // not passed: contact stays contact
    settings.force.damping = 1e-4;
    settings.force.viscosity = 1e-4;
    settings.force.magnet = {2, 0.3};
    settings.force.texture = {0.1, 2};
    return settings;
}

void tick(benchmark::State& state, double depth, const RendererSettings& settings) {
    const Touch touch = cylinder_touch(SampleType::uint8, voxels_per_mm, depth);
    Renderer renderer = make_renderer(touch.field, touch.isovalue, settings);
    place(renderer.proxy, touch.field, touch.path.front(), touch.isovalue);
    HandMotion hand(touch.path);
    std::int64_t ticks = 0;
    const auto one = [&] {
        TickInput device;
        device.time = 1e-3 * static_cast<double>(++ticks);
        device.position = device_from_physical(settings.transform, hand.next());
        benchmark::DoNotOptimize(render(renderer, device).force);
    };
    for (int i = 0; i < 10000; ++i) one();
    time_ticks(state, one);
}

BENCHMARK_CAPTURE(tick, contact_plain, 1.0, plain())->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(tick, free_plain, -3.0, plain())->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(tick, contact_everything, 1.0, everything())->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(tick, free_everything, -3.0, everything())->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace palpate::benchmarks
