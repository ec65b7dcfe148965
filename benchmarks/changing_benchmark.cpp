// The cost of changing data: updates in edited samples and between two frames, in comparison with
// plain samples, and the edits themselves. docs/changing_data.md.
#include <string>

#include "benchmarks/hand.hpp"
#include "benchmarks/timing.hpp"
#include "palpate/edit.hpp"
#include "palpate/scenes/volumes.hpp"

namespace palpate::benchmarks {
namespace {

void contact(benchmark::State& state, const Touch& touch) {
    Proxy proxy;
    place(proxy, touch.field, touch.path.front(), touch.isovalue);
    HandMotion hand(touch.path);
    const auto tick = [&] { update_exact(proxy, touch.field, hand.next()); };
    for (std::size_t i = 0; i < touch.path.size(); ++i) tick();
    time_ticks(state, tick);
}

void add_contact(const std::string& resolution, double voxels_per_mm) {
    const auto add = [&](const std::string& kind, auto make) {
        const std::string name = "changing/contact/" + kind + "/uint8/" + resolution;
        benchmark::RegisterBenchmark(name.c_str(), [=](benchmark::State& state) {
            contact(state, make(cylinder_touch(SampleType::uint8, voxels_per_mm, 1)));
        })->Unit(benchmark::kMicrosecond);
    };
    add("plain", [](Touch touch) { return touch; });
    add("edited", all_in_bricks);
    add("between", between_frames);
}

/// A ball carved in the middle of a solid uint8 block; the bytes that it takes beyond the samples.
void carve(benchmark::State& state) {
    const double radius = static_cast<double>(state.range(0));
    const int size = 256;
    const auto block = std::make_shared<const Samples>(
        Volume(scenes::centred(Index3::Constant(size)),
               std::vector<std::uint8_t>(std::size_t{size} * size * size, 200)));
    const Field field = linear_field(block, Solid::above, 0);
    const Brush brush = brush_for(BrushKind::carve, field, 100, radius);
    const edit::Stroke stroke{brush, Vec3(0.3, 0.2, 0.4), Vec3(0.3, 0.2, 0.4)};
    std::size_t bytes = 0;
    for (auto _ : state) {
        const Edited after = edited(block, stroke);
        bytes = bytes_apart(*after.samples, *block);
    }
    state.counters["bricks"] = double(bytes) / Bricks::per_brick;
    state.counters["edited_bytes"] = double(bytes);
    // Beyond the samples, where a single sample was edited.
    const Bricks none(block->geometry().size);
    const edit::Fill one{{{0, 0, 0}, {0, 0, 0}}, 1};
    state.counters["table_share"] =
        double(edited(block, one).samples->bricks()->table_bytes_apart(none)) /
        double(block->volume().bytes());
}
BENCHMARK(carve)
    ->Name("changing/edit/carve_voxels")
    ->Arg(2)
    ->Arg(5)
    ->Arg(20)
    ->Unit(benchmark::kMillisecond);

[[maybe_unused]] const bool added = [] {
    add_contact("0.5", 0.5);
    add_contact("3", 3);
    return true;
}();

}  // namespace
}  // namespace palpate::benchmarks
