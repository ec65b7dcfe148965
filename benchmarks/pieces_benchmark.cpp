// The cost of a tetrahedron: updates over 1 to 64 voxels at once, straight through free space and
// along a flat surface, and a line fitted through them.
#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <string>

#include "benchmarks/hand.hpp"
#include "benchmarks/timing.hpp"

namespace palpate::benchmarks {
namespace {

struct Point {
    double tetrahedra;
    double ns;
};

/// Back and forth, each time on another path nearby, because a processor learns the branches of a
/// path that is repeated. The median of 1024 updates, which time slices do not disturb.
Point time_ways(const Touch& touch, const Vec3& from, const Vec3& to, const Vec3& up) {
    const Vec3 side = up.cross(to - from).normalized();
    HandPath hips;
    for (int i = 0; i < 1024; ++i) {
        const Vec3 shift = std::fmod(i * 2.4721359, 4) * side + std::fmod(i * 3.0195106, 4) * up;
        hips.push_back((i % 2 == 0 ? from : to) + shift);
    }
    Proxy proxy;
    place(proxy, touch.field, hips.front(), touch.isovalue);
    std::int64_t tetrahedra = 0;
    std::vector<double> each;  // [ns a tetrahedron]
    for (const Vec3& hip : hips) {
        const auto begin = Clock::now();
        const int moved = update_exact(proxy, touch.field, hip).tetrahedra;
        each.push_back(nanoseconds(Clock::now() - begin) / std::max(1, moved));
        tetrahedra += moved;
    }
    std::nth_element(each.begin(), each.begin() + 512, each.end());
    const double mean = double(tetrahedra) / double(hips.size());
    return {mean, each[512] * mean};
}

/// Least squares: ns = fixed + slope * tetrahedra, and the share of the variance it explains.
struct Fit {
    double fixed, slope, r_squared;
};
template <std::size_t count>
Fit fit(const std::array<Point, count>& points) {
    double x = 0, y = 0, xx = 0, xy = 0, yy = 0;
    for (const Point& p : points) {
        x += p.tetrahedra / count;
        y += p.ns / count;
    }
    for (const Point& p : points) {
        xx += (p.tetrahedra - x) * (p.tetrahedra - x);
        xy += (p.tetrahedra - x) * (p.ns - y);
        yy += (p.ns - y) * (p.ns - y);
    }
    return {y - xy / xx * x, xy / xx, xy * xy / (xx * yy)};
}

/// The ways lie `height` voxels or more above the flat surface (below it: negative), `along` it.
void pieces(benchmark::State& state, double height, const Vec3& along) {
    static const Touch touch = ramp_touch(96);
    const Vec3 up = -Vec3(1, 0.37, 0.21).normalized();
    const Vec3 direction = along.normalized();
    constexpr std::array lengths{1, 2, 4, 8, 16, 24, 32, 40, 48, 56, 64};
    std::array<Point, lengths.size()> points;
    for (auto _ : state) {
        for (std::size_t i = 0; i < lengths.size(); ++i) {
            const Vec3 half = 0.5 * lengths[i] * direction;
            points[i] = time_ways(touch, height * up - half, height * up + half, up);
        }
    }
    const Fit line = fit(points);
    state.counters["ns_per_tetrahedron"] = line.slope;
    state.counters["fixed_ns"] = line.fixed;
    state.counters["r_squared"] = line.r_squared;
    for (const std::size_t i : {std::size_t{0}, lengths.size() - 1}) {
        const std::string length = std::to_string(lengths[i]) + "_voxels";
        state.counters["tetrahedra_" + length] = points[i].tetrahedra;
        state.counters["ns_" + length] = points[i].ns;
    }
}

void pieces_free(benchmark::State& state) {
    pieces(state, 8, {0.1, 0.6, 0.64});
}
void pieces_slide(benchmark::State& state) {
    pieces(state, -4, Vec3(1, 0.37, 0.21).cross(Vec3(0.3, 0.5, -0.8)));
}

BENCHMARK(pieces_free)->Name("pieces/free")->Unit(benchmark::kMillisecond);
BENCHMARK(pieces_slide)->Name("pieces/slide")->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace palpate::benchmarks
