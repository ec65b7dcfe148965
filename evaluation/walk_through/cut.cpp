// Makes cuts: a synthetic one, and slices of the user's volumes.
#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "evaluation/walk_through/walk.hpp"

namespace palpate::evaluation {
namespace {

constexpr int slices = 3;  // the middle one is shown

/// A volume of three equal slices; sample (0, 0) of the shown one at (0, 0, spacing z).
template <class Sample>
Volume extruded(int width, int height, double dx, double dy, Sample&& sample) {
    std::vector<float> samples;
    for (int k = 0; k < slices; ++k) {
        for (int j = 0; j < height; ++j) {
            for (int i = 0; i < width; ++i) samples.push_back(static_cast<float>(sample(i, j)));
        }
    }
    Geometry geometry;
    geometry.size = {width, height, slices};
    geometry.spacing = {dx, dy, std::min(dx, dy)};
    return {geometry, std::move(samples)};
}

/// Where a ray along a row of the plane first meets the surface; rows from the middle outwards.
RayHit contact_in(const Subject& subject, double z) {
    const Geometry& geometry = subject.field.geometry();
    const int height = geometry.size[1];
    const double width = geometry.size[0] * geometry.spacing[0];
    for (int i = 0; i < height; ++i) {
        const int row = height / 2 + (i % 2 ? (i + 1) / 2 : -i / 2);
        if (row < 0 || row >= height) continue;
        // Off the samples, where a ray would run in the walls of the lattice.
        const double y = (row + 0.3) * geometry.spacing[1];
        const RayHit hit =
            cast_ray(subject.field, subject.isovalue, Vec3(-width, y, z), Vec3(2 * width, y, z));
        // Not where the border of the data closes a body: there is nothing to see.
        if (hit.hit && hit.point[0] > 0) return hit;
    }
    throw std::invalid_argument(subject.name +
                                ": no row of its middle slice meets the surface within the data; "
                                "choose another level or volume");
}

}  // namespace

Cut wall_cut() {
    constexpr int width = 11, height = 7, wall = 8;
    constexpr std::array<double, width> ground{4.35, 4.3, 4.2, 3.95, 2.7, 1.75,
                                               1.45, 1.3, 0,   1.4,  1.5};
    const auto density = [&](int i, int j) {
        if (i == wall) return j <= 5 ? 96.0 : 20.0;
        return std::round(
            std::clamp(50 + 22 * (ground[static_cast<std::size_t>(i)] - j), 0.0, 100.0));
    };
    Cut cut{{"wall", Field(extruded(width, height, 1, 1, density)), 50}};
    cut.z = 1;
    cut.high = {width - 1, height - 1, 0};
    cut.start = {0.6, 5.8, 1};
    cut.hip_before = {0.7, 3.7, 1};
    cut.hip = {7.7, 0.3, 1};
    return cut;
}

Cut slice_of(const Subject& subject) {
    const Volume& volume = subject.field.volume();
    const Geometry& geometry = volume.geometry();
    const Index3 size = geometry.size;
    const auto sample = [&](int i, int j) { return volume.sample({i, j, size[2] / 2}); };
    Cut cut{{subject.name,
             Field(extruded(size[0], size[1], geometry.spacing[0], geometry.spacing[1], sample),
                   subject.field.solid(), subject.field.background()),
             subject.isovalue,
             {},
             subject.note}};
    const Field& field = cut.subject.field;
    const Vec3 voxel = field.geometry().spacing;
    cut.z = voxel[2];
    const RayHit hit = contact_in(cut.subject, cut.z);
    const Vec3 normal = Vec3(hit.normal[0], hit.normal[1], 0).normalized();
    const Vec3 along(-normal[1], normal[0], 0);
    const double unit = voxel.minCoeff();
    cut.start = hit.point - 0.01 * unit * Vec3::UnitX();
    cut.hip_before = hit.point - 0.4 * unit * normal;
    cut.hip = hit.point + unit * (4 * along - 1.5 * normal);
    const Vec3 middle = (hit.point + 2 * unit * along).cwiseQuotient(voxel);
    for (int a = 0; a < 2; ++a) {
        const int half = a == 0 ? 5 : 4;
        const int at = static_cast<int>(std::lround(middle[a]));
        cut.low[a] = std::clamp(at - half, 0, std::max(0, size[a] - 1 - 2 * half));
        cut.high[a] = std::min(size[a] - 1, cut.low[a] + 2 * half);
    }
    return cut;
}

}  // namespace palpate::evaluation
