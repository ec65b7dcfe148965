// The slowest updates of a hand that jumps to anywhere: time and work of points, layers and tools,
// within the default budget. docs/smooth.md has the results.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include "benchmarks/hand.hpp"
#include "palpate/layers.hpp"
#include "palpate/tool_proxy.hpp"

using namespace palpate;
using namespace palpate::benchmarks;

namespace {

std::mt19937_64 engine(1);

double uniform(double low, double high) {
    return low + (high - low) * static_cast<double>(engine() >> 11) * 0x1p-53;
}

Vec3 anywhere(const Geometry& geometry) {
    Vec3 index;
    for (int a = 0; a < 3; ++a) index[a] = uniform(-3, geometry.size[a] + 2);
    return physical_from_index(geometry, index);
}

/// Updates of one kind. Each is run four times from the same state, and the least time counts: what
/// interrupts the program does not belong to it.
template <class State, class Update>
void run(const std::string& name, long updates, State state, Update&& update) {
    double slowest = 0, dearest = 0, sum = 0;
    long work_of_all = 0, most_work = 0, unfinished = 0;
    for (long i = 0; i < updates; ++i) {
        const auto input = update.next();
        State after = state;
        double least = 1e300;
        int work = 0;
        for (int pass = 0; pass < 4; ++pass) {
            State copy = state;
            const auto begin = std::chrono::steady_clock::now();
            const auto result = update(copy, input);
            const auto end = std::chrono::steady_clock::now();
            least = std::min(least, std::chrono::duration<double, std::micro>(end - begin).count());
            work = result.work;
            if (pass == 0) unfinished += result.status != UpdateStatus::done;
            if (pass == 0) after = copy;
            if (least < 20) break;
        }
        state = after;
        slowest = std::max(slowest, least);
        if (work > 500) dearest = std::max(dearest, 1000 * least / work);
        most_work = std::max<long>(most_work, work);
        work_of_all += work;
        sum += least;
    }
    std::printf(
        "%-28s slowest %6.1f us, most work %5ld, per unit %5.1f ns, at most %5.1f, not done %ld\n",
        name.c_str(), slowest, most_work, 1000 * sum / double(work_of_all), dearest, unfinished);
    std::fflush(stdout);
}

struct OfPoint {
    const Field& field;
    ProxySettings settings;

    Vec3 next() { return anywhere(field.geometry()); }
    ProxyUpdate operator()(Proxy& proxy, const Vec3& hip) {
        return update_exact(proxy, field, hip, settings);
    }
};

/// The isovalue jumps, so the proxy has to recover.
struct OfRecovery : OfPoint {
    double isovalue;

    ProxyUpdate operator()(Proxy& proxy, const Vec3& hip) {
        proxy.isovalue = isovalue + 0.3 * field.range() * (std::fmod(std::abs(hip[0]), 1) - 0.5);
        return update_exact(proxy, field, hip, settings);
    }
};

struct InLayers {
    Proxy proxy;
    LayerState state;
};
struct OfLayers {
    const Field& field;
    std::shared_ptr<const Layers> layers;
    LayerInput input;

    Vec3 next() { return anywhere(field.geometry()); }
    ProxyUpdate operator()(InLayers& in, const Vec3& hip) {
        input.hip = hip;
        return update_layers(layers, in.state, in.proxy, field, input).proxy;
    }
};

struct OfTool {
    const Field& field;
    ToolSettings settings;

    Pose next() {
        const Vec3 at = anywhere(field.geometry());
        const Quaternion turn(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1), uniform(-1, 1));
        return {at, turn.normalized()};
    }
    ToolUpdate operator()(ToolProxy& proxy, const Pose& hand) {
        return update_tool(proxy, field, hand, settings);
    }
};

void run_point(const std::string& name, const Field& field, double isovalue, long updates) {
    Proxy proxy;
    proxy.isovalue = isovalue;
    run(name, updates, proxy, OfPoint{field, {}});
    run(name + ", friction", updates, proxy, OfPoint{field, {.friction = {0.5, 0.4}}});
    run(name + ", recovery", updates / 4, proxy, OfRecovery{{field, {}}, isovalue});
}

void run_all(const std::string& name, const Touch& touch, long updates) {
    const Touch smooth_one = smooth(touch);
    run_point(name + " linear", touch.field, touch.isovalue, updates);
    run_point(name, smooth_one.field, touch.isovalue, updates);
    run_point(name + " edited", smooth(all_in_bricks(touch)).field, touch.isovalue, updates);
    run_point(name + " resident", smooth(all_resident(touch)).field, touch.isovalue, updates);
    run_point(name + " between", smooth(between_frames(touch)).field, touch.isovalue, updates);
    for (const bool linear : {true, false}) {
        const auto layers = std::make_shared<Layers>();
        for (int i = 0; i < 6; ++i) {
            layers->layers.push_back({.name = std::to_string(i)});
            layers->layers.back().level = touch.isovalue + 0.08 * (i - 3) * touch.field.range();
            layers->layers.back()[HapticProperty::puncture_force] = 0.3;
        }
        InLayers in;
        in.state.opening.fill(Vec3::Zero());
        run(name + (linear ? " linear layers" : " layers"), updates, in,
            OfLayers{linear ? touch.field : smooth_one.field, layers, {}});
    }
    for (const int edge : {3, 9, 14}) {
        std::vector<Vec3> points;
        for (int i = 0; i < edge * edge * edge; ++i) {
            const Index3 at(i % edge, i / edge % edge, i / edge / edge);
            if (at.minCoeff() > 0 && at.maxCoeff() < edge - 1) continue;
            points.push_back(0.5 * (at.cast<double>() - Vec3::Constant(0.5 * (edge - 1))));
        }
        ToolProxy proxy(std::make_shared<const Tool>(points));
        proxy.isovalue = touch.isovalue;
        for (const double friction : {0.0, 0.5}) {
            const std::string of = name + " tool " + std::to_string(points.size());
            run(friction > 0 ? of + ", friction" : of, updates / 100, proxy,
                OfTool{smooth_one.field, {.friction = {friction, friction}}});
        }
        run(name + " tool between", updates / 100, proxy,
            OfTool{smooth(between_frames(touch)).field, {}});
    }
}

}  // namespace

/// UPDATES [NAME ISOVALUE X Y Z SPACING_Z FILE]: noise, or a file of 8-bit samples (16-bit if it is
/// twice as large).
int main(int argc, char** argv) {
    const long updates = argc > 1 ? std::atol(argv[1]) : 100'000;
    if (argc != 8 + 1) {
        Touch noise = noise_touch(SampleType::uint8, 3);
        run_all("noise", noise, updates);
        return 0;
    }
    const Geometry geometry{{std::atoi(argv[4]), std::atoi(argv[5]), std::atoi(argv[6])},
                            {1, 1, std::atof(argv[7])},
                            Vec3::Zero(),
                            Mat3::Identity()};
    std::ifstream file(argv[8], std::ios::binary);
    const std::vector<char> bytes(std::istreambuf_iterator<char>(file), {});
    const auto count = static_cast<std::size_t>(sample_count(geometry));
    const auto volume = [&](auto zero) {
        std::vector<decltype(zero)> samples(count);
        std::memcpy(samples.data(), bytes.data(), std::min(bytes.size(), count * sizeof zero));
        return Volume(geometry, std::move(samples));
    };
    Field field =
        linear_field(bytes.size() < 2 * count ? volume(std::uint8_t{}) : volume(std::int16_t{}));
    run_all(argv[2], {std::move(field), std::atof(argv[3]), {}}, updates);
    return 0;
}
