// A ball for tests of the C interface: 64 x 64 x 64 samples of 1 mm round the origin, whose density
// falls from the middle; level 100 is a sphere of 20 mm.
#pragma once

#include <cmath>
#include <vector>

#include "palpate-c/palpate.h"

namespace palpate::c::test {

inline palpate_geometry ball_geometry() {
    PALPATE_STRUCT(palpate_geometry, geometry);
    for (int a = 0; a < 3; ++a) {
        geometry.size[a] = 64;
        geometry.origin[a] = -31.5;
    }
    return geometry;
}

inline std::vector<float> ball_samples() {
    std::vector<float> samples;
    for (int k = 0; k < 64; ++k) {
        for (int j = 0; j < 64; ++j) {
            for (int i = 0; i < 64; ++i) {
                const double r = std::hypot(i - 31.5, j - 31.5, k - 31.5);
                samples.push_back(static_cast<float>(200 - 5 * r));
            }
        }
    }
    return samples;
}

inline palpate_volume* ball() {
    const std::vector<float> samples = ball_samples();
    const palpate_geometry geometry = ball_geometry();
    palpate_volume* volume = nullptr;
    palpate_volume_copy(&geometry, PALPATE_FLOAT32, samples.data(), 4 * samples.size(), &volume);
    return volume;
}

}  // namespace palpate::c::test
