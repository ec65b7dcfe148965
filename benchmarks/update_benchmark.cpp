// Times one proxy update: in contact and free, for all methods and sample types, on noise, after a
// change of isovalue, and in volumes of any size. Counts the tetrahedra that it enters.
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>

#include "benchmarks/hand.hpp"
#include "benchmarks/timing.hpp"
#include "palpate/baselines/methods.hpp"

namespace palpate::benchmarks {
namespace {

using MakeTouch = std::function<Touch()>;

/// Google Benchmark calls a benchmark several times to find the number of iterations. The volume is
/// made once; only the last one is kept, for they may be large.
const Touch& kept(const std::string& name, const MakeTouch& make) {
    static std::string kept_name;
    static std::unique_ptr<Touch> touch;
    if (kept_name != name) {
        touch.reset();
        touch = std::make_unique<Touch>(make());
        kept_name = name;
    }
    return *touch;
}

/// Follows the path forth and back. The first time forth is not timed: caches are warm.
void run_updates(benchmark::State& state, const Touch& touch, ProxyMethod method,
                 double other_isovalue) {
    Proxy proxy;
    place(proxy, touch.field, touch.path.front(), touch.isovalue);
    HandMotion hand(touch.path);
    std::int64_t updates = 0, tetrahedra = 0, constrained = 0;
    const auto tick = [&] {
        if (++updates & 1) {
            proxy.isovalue = touch.isovalue;
        } else {
            proxy.isovalue = other_isovalue;
        }
        const ProxyUpdate update = method(proxy, touch.field, hand.next(), {}, {});
        tetrahedra += update.tetrahedra;
        constrained += update.mode == Mode::constrained;
    };
    for (std::size_t i = 0; i < touch.path.size(); ++i) tick();
    updates = tetrahedra = constrained = 0;
    time_ticks(state, tick);
    const auto per_update = [&](std::int64_t n) { return double(n) / double(updates); };
    state.counters["tetrahedra"] = per_update(tetrahedra);
    state.counters["constrained"] = per_update(constrained);
}

void add(const std::string& name, const char* method, const MakeTouch& make,
         double isovalue_step = 0) {
    benchmark::RegisterBenchmark(name.c_str(), [=](benchmark::State& state) {
        const Touch& touch = kept(name, make);
        const double other = touch.isovalue + isovalue_step * touch.field.range();
        run_updates(state, touch, baselines::method_named(method), other);
    })->Unit(benchmark::kMicrosecond);
}

struct Resolution {
    const char* name;
    double voxels_per_mm;
};
constexpr Resolution resolutions[] = {{"0.5", 0.5}, {"3", 3}};

bool add_cylinder() {
    constexpr SampleType types[] = {SampleType::uint8, SampleType::int16, SampleType::uint16,
                                    SampleType::float32};
    for (const auto& [resolution, v] : resolutions) {
        for (const SampleType type : types) {
            const std::string rest = "/exact/" + std::string(name_of(type)) + "/" + resolution;
            add("contact" + rest, "exact", [=, v = v] { return cylinder_touch(type, v, 1); });
            add("free" + rest, "exact", [=, v = v] { return cylinder_touch(type, v, -3); });
        }
        for (const char* method : {"paper", "gradient", "gradient-improved"}) {
            add("contact/" + std::string(method) + "/uint8/" + resolution, method,
                [v = v] { return cylinder_touch(SampleType::uint8, v, 1); });
        }
        // Every second update the surface has moved 5 voxels outwards, every other back.
        add(
            "recovery/exact/uint8/" + std::string(resolution), "exact",
            [v = v] { return cylinder_touch(SampleType::uint8, v, 1); }, -0.1);
    }
    return true;
}

bool add_noise() {
    for (const auto& [resolution, v] : resolutions) {
        for (const char* method : {"exact", "paper"}) {
            add("noise/" + std::string(method) + "/float32/" + resolution, method,
                [v = v] { return noise_touch(SampleType::float32, v); });
        }
    }
    return true;
}

bool add_smooth() {
    for (const auto& [resolution, v] : resolutions) {
        for (const SampleType type : {SampleType::uint8, SampleType::float32}) {
            const std::string rest = "/exact/" + std::string(name_of(type)) + "/" + resolution;
            add("smooth/contact" + rest, "exact",
                [=, v = v] { return smooth(cylinder_touch(type, v, 1)); });
            add("smooth/free" + rest, "exact",
                [=, v = v] { return smooth(cylinder_touch(type, v, -3)); });
        }
        add("smooth/noise/exact/float32/" + std::string(resolution), "exact",
            [v = v] { return smooth(noise_touch(SampleType::float32, v)); });
    }
    return true;
}

bool add_sizes() {
    for (const int size : {64, 128, 256, 512, 768}) {
        add("size/exact/uint8/" + std::to_string(size), "exact",
            [=] { return ball_touch(size, 3); });
    }
    return true;
}

[[maybe_unused]] const bool added = add_cylinder() && add_noise() && add_smooth() && add_sizes();

}  // namespace
}  // namespace palpate::benchmarks
