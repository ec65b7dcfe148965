// Dequantization as its formula says, sample by sample, in double: the slow reference.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "palpate/volume.hpp"

namespace palpate::support {

/// A grid of doubles.
struct Grid {
    Index3 size;
    std::vector<double> samples;

    double& at(const Index3& index) {
        return samples[(std::size_t(index[2]) * std::size_t(size[1]) + std::size_t(index[1])) *
                           std::size_t(size[0]) +
                       std::size_t(index[0])];
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

/// A sample, or what stands for it beyond the border: along each axis the samples `step` apart go
/// on as a straight line, 2 v(0) - v(k) at -k.
inline double sample_of(Grid& grid, const Index3& index, int step) {
    for (int axis = 0; axis < 3; ++axis) {
        int end = index[axis];
        while (end < 0) end += step;
        while (end >= grid.size[axis]) end -= step;
        if (end == index[axis]) continue;
        int mirrored = 2 * end - index[axis];
        while (mirrored >= grid.size[axis]) mirrored -= step;
        while (mirrored < 0) mirrored += step;
        Index3 at_end = index, there = index;
        at_end[axis] = end;
        there[axis] = mirrored;
        return 2 * sample_of(grid, at_end, step) - sample_of(grid, there, step);
    }
    return grid.at(index);
}

/// The 27 neighbours `step` apart, weighted (1 2 1)/4 along each axis, of `times` such means.
inline double binomial(Grid& grid, const Index3& index, int step, int times) {
    if (times == 0) return sample_of(grid, index, step);
    double sum = 0;
    for (int n = 0; n < 27; ++n) {
        const Index3 offset(n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1);
        const Index3 weight = 2 * Index3::Ones() - offset.cwiseAbs();
        sum += binomial(grid, index + step * offset, step, times - 1) * weight.prod() / 64;
    }
    return sum;
}

inline Grid grid_of(const Volume& volume) {
    Grid grid{volume.geometry().size, {}};
    grid.for_each([&](const Index3& index) { grid.samples.push_back(volume.sample(index)); });
    return grid;
}

/// One round: u = 2b - Bb, within `half` of the volume's samples and within its range, where
/// moves(index) says so. Where b and Bb differ by more than `straight` it counts less, from twice
/// of it on not at all.
template <class Moves>
void dequantize_once(Grid& state, const Volume& volume, int step, double half, double straight,
                     const Moves& moves) {
    Grid before = state;
    state.for_each([&](const Index3& index) {
        if (!moves(index)) return;
        const double own = volume.sample(index), mean = binomial(before, index, step, 1);
        const double bend = mean - binomial(before, index, step, 2);
        const double low = std::max(own - half, volume.minimum());
        const double high = std::min(own + half, volume.maximum());
        const double part = std::clamp(2 - std::abs(bend) / straight, 0.0, 1.0);
        double& value = state.at(index);
        value = std::clamp(value + part * (mean + bend - value), low, high);
    });
}

}  // namespace palpate::support
