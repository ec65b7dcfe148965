// Dequantization as its formula says, sample by sample, in double: the slow reference.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "palpate/volume.hpp"

namespace palpate::support {

/// A grid of doubles; samples beyond the border count as those on it.
struct Grid {
    Index3 size;
    std::vector<double> samples;

    double& at(const Index3& index) {
        const Index3 near = index.cwiseMax(0).cwiseMin(size - Index3::Ones());
        return samples[(std::size_t(near[2]) * std::size_t(size[1]) + std::size_t(near[1])) *
                           std::size_t(size[0]) +
                       std::size_t(near[0])];
    }
    template <class Work>
    void for_each(Work&& work) {
        for (int k = 0; k < size[2]; ++k) {
            for (int j = 0; j < size[1]; ++j) {
                for (int i = 0; i < size[0]; ++i) work(Index3(i, j, k));
            }
        }
    }
};

/// The 27 neighbours `step` apart, weighted (1 2 1)/4 along each axis.
inline Grid binomial(Grid grid, int step) {
    Grid result = grid;
    grid.for_each([&](const Index3& index) {
        double sum = 0;
        for (int n = 0; n < 27; ++n) {
            const Index3 offset(n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1);
            const Index3 weight = 2 * Index3::Ones() - offset.cwiseAbs();
            sum += grid.at(index + step * offset) * weight.prod() / 64;
        }
        result.at(index) = sum;
    });
    return result;
}

inline Grid grid_of(const Volume& volume) {
    Grid grid{volume.geometry().size, {}};
    grid.for_each([&](const Index3& index) { grid.samples.push_back(volume.sample(index)); });
    return grid;
}

/// One round: u = 2b - Bb, within `half` of the volume's samples and within its range. Where b and
/// Bb differ by more than `straight` it counts less, from twice of it on not at all.
inline void dequantize_once(Grid& state, const Volume& volume, int step, double half,
                            double straight) {
    Grid mean = binomial(state, step);
    Grid twice = binomial(mean, step);
    state.for_each([&](const Index3& index) {
        const double own = volume.sample(index), bend = mean.at(index) - twice.at(index);
        const double low = std::max(own - half, volume.minimum());
        const double high = std::min(own + half, volume.maximum());
        const double part = std::clamp(2 - std::abs(bend) / straight, 0.0, 1.0);
        double& value = state.at(index);
        value += part * (std::clamp(mean.at(index) + bend, low, high) - value);
    });
}

}  // namespace palpate::support
