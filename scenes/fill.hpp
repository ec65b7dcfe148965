// Fills a grid with a density function, in place and in any sample type. Internal to scenes/.
#pragma once

#include <cmath>
#include <limits>
#include <memory>
#include <type_traits>

#include "palpate/volume.hpp"

namespace palpate::scenes {

/// data value = offset + gain * density
struct Scale {
    double offset = 0;
    double gain = 1;
    double operator()(double density) const { return offset + gain * density; }
};

/// Density 0..1 on 0..1 for float32, on 0..largest value for integer types.
Scale unit_scale(SampleType type);

/// Throws std::invalid_argument unless the geometry is valid and its samples fit in
/// largest_scene_bytes.
void check_size(const Geometry& geometry, SampleType type);

template <class T>
T rounded_sample(double value) {
    if constexpr (std::is_floating_point_v<T>) {
        return static_cast<T>(value);
    } else {
        const double low = std::numeric_limits<T>::lowest();
        const double high = std::numeric_limits<T>::max();
        const double nearest = std::floor(value + 0.5);
        return static_cast<T>(nearest < low ? low : nearest > high ? high : nearest);
    }
}

template <class T, class Value>
Volume filled_as(const Geometry& geometry, Value&& value, const OnProgress& progress) {
    const auto count = static_cast<std::size_t>(sample_count(geometry));
    const std::shared_ptr<T[]> samples(new T[count]);
    ReportedItems reported(progress, count, std::size_t{1} << 16);
    T* out = samples.get();
    const Vec3 middle = 0.5 * (geometry.size.cast<double>() - Vec3::Ones());
    for (int k = 0; k < geometry.size[2]; ++k) {
        const double z = (k - middle[2]) * geometry.spacing[2];
        for (int j = 0; j < geometry.size[1]; ++j) {
            const double y = (j - middle[1]) * geometry.spacing[1];
            for (int i = 0; i < geometry.size[0]; ++i) {
                const double x = (i - middle[0]) * geometry.spacing[0];
                *out++ = rounded_sample<T>(value(Vec3(x, y, z)));
                reported.done();
            }
        }
    }
    return {geometry, sample_type_of<T>(), samples, count * sizeof(T), progress};
}

/// `value` gives the data value at a point [mm, from the grid's centre, grid axes]; it is called
/// once a sample, x fastest. check_size() first.
template <class Value>
Volume filled(const Geometry& geometry, SampleType type, Value&& value,
              const OnProgress& progress = {}) {
    check_size(geometry, type);
    return with_type(
        type, [&](auto zero) { return filled_as<decltype(zero)>(geometry, value, progress); });
}

/// The shortest axis [mm], sample to sample distance counted once per sample. Axes of one sample do
/// not count: a one-voxel-thin grid is a slice through the middle of the scene. `axes` of 3.
double shortest_length(const Geometry& geometry, int axes = 3);

}  // namespace palpate::scenes
