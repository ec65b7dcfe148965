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

void for_sites(const Volume& volume, double most, const std::function<void(const Index3&)>& work) {
    const Index3 size = volume.geometry().size;
    const double apart = std::cbrt(double(sample_count(volume.geometry())) / most);
    const int stride = std::max(1, int(std::ceil(apart)));
    for (int k = 1; k < size[2] - 1; k += stride) {
        for (int j = 1; j < size[1] - 1; j += stride) {
            for (int i = 1; i < size[0] - 1; i += stride) work({i, j, k});
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

bool is_mask(const Volume& volume, double level) {
    return volume.range() <= 1.5 * level;
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
