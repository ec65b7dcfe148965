// Builds small difficult volumes for tests, and code that these share with the scenes.
#include <algorithm>
#include <array>
#include <stdexcept>

#include "palpate/scenes/volumes.hpp"
#include "scenes/fill.hpp"
#include "scenes/random.hpp"

namespace palpate::scenes {

Scale unit_scale(SampleType type) {
    return with_type(type, [](auto zero) -> Scale {
        using T = decltype(zero);
        return {0, std::is_integral_v<T> ? static_cast<double>(std::numeric_limits<T>::max()) : 1};
    });
}

void check_size(const Geometry& geometry, SampleType type) {
    check(geometry);
    // Every axis has at most 2^20 samples by now, so the product fits in 64 bit.
    const auto bytes = static_cast<std::uint64_t>(sample_count(geometry)) * size_of(type);
    if (bytes <= largest_scene_bytes) return;
    const auto gibibytes = [](std::uint64_t b) { return std::to_string(b >> 30) + " GiB"; };
    throw std::invalid_argument("a synthetic volume of " + std::to_string(geometry.size[0]) + "x" +
                                std::to_string(geometry.size[1]) + "x" +
                                std::to_string(geometry.size[2]) + " " +
                                std::string(name_of(type)) + " takes " + gibibytes(bytes) +
                                ", the limit is " + gibibytes(largest_scene_bytes));
}

double shortest_length(const Geometry& geometry, int axes) {
    double shortest = 0;
    for (int a = 0; a < axes; ++a) {
        const double length = geometry.size[a] * geometry.spacing[a];
        if (geometry.size[a] > 1 && (shortest == 0 || length < shortest)) shortest = length;
    }
    return shortest > 0 ? shortest : geometry.spacing.minCoeff();
}

Geometry centred(const Index3& size, const Vec3& spacing, const Mat3& direction) {
    Geometry geometry{size, spacing, Vec3::Zero(), direction};
    geometry.oriented = false;  // no body's
    geometry.origin = -physical_centre(geometry);
    return geometry;
}

Volume noise(const Geometry& geometry, SampleType type, std::uint64_t seed, double amplitude,
             const OnProgress& progress) {
    Random random(seed);
    return filled(
        geometry, type, [&](const Vec3&) { return random.uniform() * amplitude; }, progress);
}

Volume salt(const Index3& size, double fraction, std::uint64_t seed) {
    Random random(seed);
    return filled(centred(size), SampleType::uint8,
                  [&](const Vec3&) { return random.uniform() < fraction ? 255.0 : 0.0; });
}

Volume box(const Index3& size, const Index3& lo, const Index3& hi) {
    const Vec3 middle = 0.5 * (size.cast<double>() - Vec3::Ones());
    const Vec3 low = lo.cast<double>() - middle, high = hi.cast<double>() - middle;
    return filled(centred(size), SampleType::uint8, [&](const Vec3& p) {
        const bool inside = (p.array() >= low.array()).all() && (p.array() <= high.array()).all();
        return inside ? 255.0 : 0.0;
    });
}

Volume thin_shell(const Index3& size, double radius, double thickness, SampleType type) {
    if (!(thickness > 0)) throw std::invalid_argument("a shell's thickness must be above 0 mm");
    const Scale scale = unit_scale(type);
    return filled(centred(size), type, [&](const Vec3& p) {
        return scale(std::max(0.0, 1 - std::abs(p.norm() - radius) / thickness));
    });
}

Volume ball(const Index3& size, double radius, double slope, SampleType type) {
    const Geometry geometry = centred(size);
    const double unit = shortest_length(geometry);
    const Scale scale = unit_scale(type);
    return filled(geometry, type, [&](const Vec3& p) {
        return scale(std::clamp(0.5 + slope * (radius - p.norm() / unit), 0.0, 1.0));
    });
}

}  // namespace palpate::scenes
