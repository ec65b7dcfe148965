// Trilinear interpolation, one axis after the other: first the coarse row at the place of a fine
// row, then along it.
#include "stream/loader/upsample.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <type_traits>
#include <vector>

namespace palpate::stream {
namespace {

/// Place of a fine sample between two coarse ones along an axis.
struct Between {
    std::ptrdiff_t low, high;  // offsets in the coarse samples
    float part;                // of the higher
};

std::vector<Between> places_along(int axis, const Geometry& coarse, const Geometry& fine,
                                  const SampleBox& box) {
    const std::array<std::ptrdiff_t, 3> strides{
        1, coarse.size[0], static_cast<std::ptrdiff_t>(coarse.size[0]) * coarse.size[1]};
    const std::ptrdiff_t stride = strides[static_cast<std::size_t>(axis)];
    const std::ptrdiff_t last = coarse.size[axis] - 1;
    std::vector<Between> places;
    for (int i = box.low[axis]; i <= box.high[axis]; ++i) {
        Vec3 index = Vec3::Zero();
        index[axis] = i;
        const double at = std::clamp(
            index_from_physical(coarse, physical_from_index(fine, index))[axis], 0.0, double(last));
        const auto low = std::clamp<std::ptrdiff_t>(static_cast<std::ptrdiff_t>(at), 0,
                                                    std::max<std::ptrdiff_t>(0, last - 1));
        places.push_back(
            {low * stride, std::min(low + 1, last) * stride, static_cast<float>(at - double(low))});
    }
    return places;
}

float mix(float a, float b, float part) {
    return a + part * (b - a);
}

/// To nearest, halves up; a conversion rounds down only what is not negative.
template <class T>
T sample_from(float value) {
    if constexpr (std::is_integral_v<T>) {
        constexpr int lowest = std::numeric_limits<T>::lowest();
        return static_cast<T>(static_cast<int>(value + (0.5F - lowest)) + lowest);
    } else {
        return value;
    }
}

template <class T>
void upsample(const Geometry& coarse, const T* samples, const Geometry& fine, const SampleBox& box,
              T* first, const Target& target) {
    const auto x = places_along(0, coarse, fine, box);
    const auto y = places_along(1, coarse, fine, box);
    const auto z = places_along(2, coarse, fine, box);
    std::vector<float> row(static_cast<std::size_t>(coarse.size[0]));
    for (std::size_t k = 0; k < z.size(); ++k) {
        for (std::size_t j = 0; j < y.size(); ++j) {
            const std::array corners{samples + y[j].low + z[k].low, samples + y[j].high + z[k].low,
                                     samples + y[j].low + z[k].high,
                                     samples + y[j].high + z[k].high};
            for (std::ptrdiff_t i = x.front().low; i <= x.back().high; ++i) {
                const auto at = [&](std::size_t corner) {
                    return static_cast<float>(corners[corner][i]);
                };
                row[static_cast<std::size_t>(i)] =
                    mix(mix(at(0), at(1), y[j].part), mix(at(2), at(3), y[j].part), z[k].part);
            }
            T* to = first + static_cast<std::ptrdiff_t>(k) * target.slice +
                    static_cast<std::ptrdiff_t>(j) * target.row;
            for (const Between& place : x) {
                *to++ = sample_from<T>(mix(row[static_cast<std::size_t>(place.low)],
                                           row[static_cast<std::size_t>(place.high)], place.part));
            }
        }
    }
}

}  // namespace

Geometry geometry_of(const Geometry& level, const SampleBox& box) {
    Geometry part = level;
    part.origin = physical_from_index(level, box.low.cast<double>());
    part.size = box.high - box.low + Index3::Ones();
    return part;
}

void upsample(const Geometry& coarse, const std::byte* samples, SampleType type,
              const Geometry& fine, const SampleBox& box, const Target& target) {
    with_type(type, [&](auto zero) {
        using T = decltype(zero);
        upsample(coarse, reinterpret_cast<const T*>(samples), fine, box,
                 reinterpret_cast<T*>(target.first), target);
    });
}

}  // namespace palpate::stream
