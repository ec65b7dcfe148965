// Slow reference of the smooth field: each Bernstein coefficient as a mean of the samples, from the
// definition, in long double. Shares nothing with src/cubic.cpp.
#pragma once

#include <array>
#include <cmath>

#include "palpate/volume.hpp"

namespace palpate::support {

using Vec3l = Eigen::Matrix<long double, 3, 1>;

/// A Bernstein coefficient of the tetrahedron with the corners: sample, centre of the face towards
/// +d, ends of the edge of that face towards +s at -e and +e.
struct CubicMask {
    std::array<int, 4> index;     ///< multiples of the corners, together 3
    std::array<int, 27> weights;  ///< in 1/192, of the neighbours at (d, s, e), e fastest
};
// clang-format off
inline constexpr std::array<CubicMask, 20> cubic_masks{{
    {{0, 0, 0, 3}, {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 24, 24, 0, 24, 24, 0, 0, 0, 0, 24, 24, 0, 24, 24}},
    {{0, 0, 1, 2}, {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 40, 8, 0, 40, 8, 0, 0, 0, 0, 40, 8, 0, 40, 8}},
    {{0, 0, 2, 1}, {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 8, 40, 0, 8, 40, 0, 0, 0, 0, 8, 40, 0, 8, 40, 0}},
    {{0, 0, 3, 0}, {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 24, 24, 0, 24, 24, 0, 0, 0, 0, 24, 24, 0, 24, 24, 0}},
    {{0, 1, 0, 2}, {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 40, 24, 0, 24, 8, 0, 0, 0, 0, 40, 24, 0, 24, 8}},
    {{0, 1, 1, 1}, {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 6, 52, 6, 2, 28, 2, 0, 0, 0, 6, 52, 6, 2, 28, 2}},
    {{0, 1, 2, 0}, {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 24, 40, 0, 8, 24, 0, 0, 0, 0, 24, 40, 0, 8, 24, 0}},
    {{0, 2, 0, 1}, {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 3, 1, 3, 52, 17, 1, 17, 2, 0, 3, 1, 3, 52, 17, 1, 17, 2}},
    {{0, 2, 1, 0}, {0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 3, 0, 17, 52, 3, 2, 17, 1, 1, 3, 0, 17, 52, 3, 2, 17, 1}},
    {{0, 3, 0, 0}, {0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 10, 1, 10, 52, 10, 1, 10, 1, 1, 10, 1, 10, 52, 10, 1, 10, 1}},
    {{1, 0, 0, 2}, {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 48, 32, 0, 32, 16, 0, 0, 0, 0, 32, 16, 0, 16, 0}},
    {{1, 0, 1, 1}, {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 8, 64, 8, 4, 40, 4, 0, 0, 0, 4, 40, 4, 0, 16, 0}},
    {{1, 0, 2, 0}, {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 32, 48, 0, 16, 32, 0, 0, 0, 0, 16, 32, 0, 0, 16, 0}},
    {{1, 1, 0, 1}, {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 4, 2, 4, 64, 24, 2, 24, 4, 0, 2, 0, 2, 40, 10, 0, 10, 0}},
    {{1, 1, 1, 0}, {0, 0, 0, 0, 0, 0, 0, 0, 0, 2, 4, 0, 24, 64, 4, 4, 24, 2, 0, 2, 0, 10, 40, 2, 0, 10, 0}},
    {{1, 2, 0, 0}, {0, 0, 0, 0, 0, 0, 0, 0, 0, 2, 14, 2, 14, 64, 14, 2, 14, 2, 0, 6, 0, 6, 40, 6, 0, 6, 0}},
    {{2, 0, 0, 1}, {0, 0, 0, 0, 4, 2, 0, 2, 0, 0, 4, 2, 4, 72, 28, 2, 28, 4, 0, 2, 0, 2, 28, 4, 0, 4, 0}},
    {{2, 0, 1, 0}, {0, 0, 0, 2, 4, 0, 0, 2, 0, 2, 4, 0, 28, 72, 4, 4, 28, 2, 0, 2, 0, 4, 28, 2, 0, 4, 0}},
    {{2, 1, 0, 0}, {0, 1, 0, 1, 4, 1, 0, 1, 0, 2, 16, 2, 16, 72, 16, 2, 16, 2, 0, 3, 0, 3, 28, 3, 0, 3, 0}},
    {{3, 0, 0, 0}, {0, 2, 0, 2, 16, 2, 0, 2, 0, 2, 16, 2, 16, 72, 16, 2, 16, 2, 0, 2, 0, 2, 16, 2, 0, 2, 0}},
}};
// clang-format on

/// The point (index space) seen from the sample whose cube it is in.
struct CubicPlace {
    Index3 sample;
    std::array<int, 3> axis;  ///< d, s, e: by falling distance from the sample
    std::array<int, 3> sign;
    std::array<long double, 4> barycentric;
};
inline CubicPlace cubic_place(const Vec3l& index) {
    CubicPlace place;
    Vec3l from;
    for (int a = 0; a < 3; ++a) {
        place.sample[a] = static_cast<int>(std::lround(index[a]));
        from[a] = index[a] - place.sample[a];
    }
    place.axis = {0, 1, 2};
    std::ranges::sort(place.axis,
                      [&](int a, int b) { return std::abs(from[a]) > std::abs(from[b]); });
    std::array<long double, 3> u;
    for (int i = 0; i < 3; ++i) {
        place.sign[i] = from[place.axis[i]] < 0 ? -1 : 1;
        u[i] = std::abs(from[place.axis[i]]);
    }
    place.barycentric = {1 - 2 * u[0], 2 * (u[0] - u[1]), u[1] - u[2], u[1] + u[2]};
    return place;
}

/// Value and gradient (index axes) of the smooth field at a point in index space. `sample` gives
/// the density at an Index3, background included.
struct CubicValue {
    long double value = 0;
    Vec3l gradient = Vec3l::Zero();
};
template <class Sample>
CubicValue cubic_value(const Vec3l& index, Sample&& sample) {
    const CubicPlace place = cubic_place(index);
    // Gradients of the barycentric coordinates in (d, s, e).
    const std::array<Vec3l, 4> slope{Vec3l(-2, 0, 0), Vec3l(2, -2, 0), Vec3l(0, 1, -1),
                                     Vec3l(0, 1, 1)};
    CubicValue result;
    Vec3l folded = Vec3l::Zero();
    for (const CubicMask& mask : cubic_masks) {
        long double coefficient = 0;
        for (int n = 0; n < 27; ++n) {
            if (mask.weights[n] == 0) continue;
            const std::array<int, 3> offset{n / 9 - 1, n / 3 % 3 - 1, n % 3 - 1};
            Index3 at = place.sample;
            for (int i = 0; i < 3; ++i) at[place.axis[i]] += place.sign[i] * offset[i];
            coefficient += static_cast<long double>(sample(at)) * mask.weights[n] / 192;
        }
        // The Bernstein polynomial 3! / (i0! i1! i2! i3!) product of l_j^i_j, and its derivatives.
        long double product = coefficient * 6;
        for (int j = 0; j < 4; ++j) {
            for (int k = 1; k <= mask.index[j]; ++k) product *= place.barycentric[j] / k;
        }
        result.value += product;
        for (int j = 0; j < 4; ++j) {
            if (mask.index[j] == 0) continue;
            long double derivative = coefficient * 6;
            for (int m = 0; m < 4; ++m) {
                const int power = mask.index[m] - (m == j);
                for (int k = 1; k <= power; ++k) derivative *= place.barycentric[m] / k;
            }
            folded += derivative * slope[j];
        }
    }
    for (int i = 0; i < 3; ++i) result.gradient[place.axis[i]] = place.sign[i] * folded[i];
    return result;
}

}  // namespace palpate::support
