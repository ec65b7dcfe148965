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

/// |b - Bb|, or what it is at the nearest of the samples `step` apart.
inline double bend_at(Grid& grid, Index3 index, int step) {
    for (int axis = 0; axis < 3; ++axis) {
        while (index[axis] < 0) index[axis] += step;
        while (index[axis] >= grid.size[axis]) index[axis] -= step;
    }
    return std::abs(binomial(grid, index, step, 1) - binomial(grid, index, step, 2));
}

/// Samples that are moved by what is `step` apart: those whose indices in the whole volume are
/// multiples of `apart`, where moves(index) says so. low: the first sample in the whole volume.
template <class Moves>
struct Moving {
    const Volume& volume;
    int step, apart;
    Index3 low;
    double half, straight;  ///< [data units]
    const Moves& moves;

    /// Moves samples by part(index) of the way to value(index), within `half` of the volume's
    /// samples and within its range.
    template <class Part, class Value>
    void move(Grid& state, const Part& part, const Value& value) const {
        state.for_each([&](const Index3& index) {
            const Index3 at = low + index;
            if (at.unaryExpr([&](int i) { return i % apart; }).any() || !moves(index)) return;
            const double own = volume.sample(index);
            double& sample = state.at(index);
            sample = std::clamp(sample + part(index) * (value(index) - sample),
                                std::max(own - half, volume.minimum()),
                                std::min(own + half, volume.maximum()));
        });
    }
    double part_of(double bend) const { return std::clamp(2 - bend / straight, 0.0, 1.0); }

    /// One round: u = 2b - Bb. Where b and Bb differ by more than `straight` it counts less, from
    /// twice of it on not at all.
    void round(Grid& state) const {
        Grid before = state;
        move(
            state,
            [&](const Index3& i) { return step == 1 ? 1 : part_of(bend_at(before, i, step)); },
            [&](const Index3& i) {
                return 2 * binomial(before, i, step, 1) - binomial(before, i, step, 2);
            });
    }
    /// Cubic interpolation of the samples 2 step apart, less where these bend.
    void refine(Grid& state) const {
        Grid before = state;
        move(
            state, [&](const Index3& i) { return part_between(before, i, 0); },
            [&](const Index3& i) { return value_between(before, i, 0); });
    }

  private:
    bool is_between(const Index3& index, int axis) const {
        return (low[axis] + index[axis]) % (2 * step) != 0;
    }
    double value_between(Grid& grid, const Index3& index, int axis) const {
        if (axis == 3) return sample_of(grid, index, 2 * step);
        const auto value = [&](int steps) {
            return value_between(grid, index + steps * step * Index3::Unit(axis), axis + 1);
        };
        if (!is_between(index, axis)) return value(0);
        return (9 * (value(-1) + value(1)) - (value(-3) + value(3))) / 16;
    }
    double part_between(Grid& grid, const Index3& index, int axis) const {
        if (axis == 3) return part_of(bend_at(grid, index, 2 * step));
        const auto part = [&](int steps) {
            return part_between(grid, index + steps * step * Index3::Unit(axis), axis + 1);
        };
        return is_between(index, axis) ? (part(-1) + part(1)) / 2 : part(0);
    }
};

}  // namespace palpate::support
