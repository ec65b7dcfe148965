// Samples spread over a volume.
#include "filters/sites.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::filters {
namespace {

double near_sample(const Volume& volume, const Index3& at) {
    const Index3 last = volume.geometry().size - Index3::Ones();
    return volume.sample(at.cwiseMax(0).cwiseMin(last));
}

}  // namespace

void for_sites(const Index3& size, double most, const SampleBox& core,
               const std::function<void(const Index3&)>& work) {
    const double apart = std::cbrt(double(size.cast<std::int64_t>().prod()) / most);
    const int stride = std::max(1, int(std::ceil(apart)));
    // The first of 1, 1 + stride, ... in the core, and the last sample before its end or the
    // border.
    const Index3 first =
        Index3::Ones() + (core.low.cwiseMax(1).array() - 1 + stride - 1).matrix() / stride * stride;
    const Index3 last = core.high.cwiseMin(size - 2 * Index3::Ones());
    for (int k = first[2]; k <= last[2]; k += stride) {
        for (int j = first[1]; j <= last[1]; j += stride) {
            for (int i = first[0]; i <= last[0]; i += stride) work({i, j, k});
        }
    }
}

double slope_at(const Volume& volume, const Index3& at) {
    Vec3 slope;
    for (int axis = 0; axis < 3; ++axis) {
        const Index3 two = 2 * Index3::Unit(axis);
        slope[axis] = (near_sample(volume, at + two) - near_sample(volume, at - two)) / 4;
    }
    return slope.norm();
}

Smooth smooth_at(const Volume& volume, const Index3& at, int step) {
    constexpr double once[5] = {0, 0.25, 0.5, 0.25, 0};
    constexpr double twice[5] = {0.0625, 0.25, 0.375, 0.25, 0.0625};
    Smooth smooth{0, 0};
    for (int k = 0; k < 5; ++k) {
        for (int j = 0; j < 5; ++j) {
            for (int i = 0; i < 5; ++i) {
                const double s = near_sample(volume, at + step * Index3(i - 2, j - 2, k - 2));
                smooth.mean += once[i] * once[j] * once[k] * s;
                smooth.twice += twice[i] * twice[j] * twice[k] * s;
            }
        }
    }
    return smooth;
}

}  // namespace palpate::filters
