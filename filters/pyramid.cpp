// Dequantization on grids of every second, fourth, ... sample.
#include "filters/pyramid.hpp"

#include <algorithm>

#include "filters/round.hpp"
#include "filters/sweep.hpp"

namespace palpate::filters {
Pyramid::Grid::Grid(const MovedSamples& every_second, const Parallel& parallel)
    : samples(every_second) {
    const Index3& size = samples.size;
    const std::ptrdiff_t slice = std::ptrdiff_t{size[0]} * size[1];
    const auto copy = [&](const auto* from, std::ptrdiff_t from_slice, auto& to) {
        to.resize(static_cast<std::size_t>(slice * size[2]));
        parallel(size[2], [&](int z) {
            for (int y = 0; y < size[1]; ++y) {
                const auto* const row = from + z * from_slice + y * every_second.row;
                const auto begin = to.begin() + z * slice + std::ptrdiff_t{y} * size[0];
                for (int x = 0; x < size[0]; ++x) begin[x] = row[2 * x];
            }
        });
        return to.data();
    };
    if (samples.floats) samples.floats = copy(samples.floats, samples.own_slice, floats);
    if (samples.whole) samples.whole = copy(samples.whole, samples.own_slice, whole);
    samples.moved = copy(samples.moved, samples.moved_slice, moved);
    samples.own_slice = samples.moved_slice = slice;
    samples.row = size[0];
    samples.apart = 1;
}

void Pyramid::go_to(int step) {
    while (top().step < step) coarse_.emplace_back(every_second(top()), parallel_);
    while (top().step > step) {
        const Grid last = std::move(coarse_.back());
        coarse_.pop_back();
        const MovedSamples to = every_second(top());
        parallel_(to.size[2], [&](int z) {
            for (int y = 0; y < to.size[1]; ++y) {
                const std::int16_t* const from = moved_row(last.samples, y, z);
                std::int16_t* const row = moved_row(to, y, z);
                for (int x = 0; x < to.size[0]; ++x) row[2 * x] = from[x];
            }
        });
    }
}

void Pyramid::run(const DequantizePlan::Rounds& rounds, const std::function<void(double)>& done) {
    using Way = DequantizePlan::Rounds::Way;
    go_to(rounds.step);
    const double slices = top().size[2];
    const auto at_slab = [&](int count) { done(count / slices); };
    if (rounds.way == Way::down) {
        Grid next(every_second(top()), parallel_);
        repeat_round(top(), levels_, bricks_, 1, parallel_, at_slab, &next.samples);
        coarse_.push_back(std::move(next));
        return;
    }
    if (rounds.way == Way::up) refine(top(), levels_, bricks_, parallel_, at_slab);
    repeat_round(top(), levels_, bricks_, rounds.count, parallel_, at_slab);
}

}  // namespace palpate::filters
