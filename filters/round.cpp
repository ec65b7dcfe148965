// One round of dequantization. It is done in slabs, and a slab's result waits beside the samples
// until the next slab has read them.
#include "filters/round.hpp"

#include <algorithm>
#include <array>
#include <type_traits>
#include <vector>

#include "filters/sweep.hpp"

namespace palpate::filters {
namespace {

/// Of a strip, so that a sweep stays in the second-level cache.
constexpr int most_rows = 32, most_bricks = 16;
constexpr int most_slices = 32, fewest_slices = 8;

struct Slab {
    std::vector<Strip> strips;
    std::vector<std::int16_t> result;
};

struct Round {
    const MovedSamples& samples;
    const Levels& levels;
    const TerracedBricks& bricks;
    const MovedSamples* coarser;

    /// The strips of a slab that have some of the bricks in them.
    std::vector<Strip> strips_of(int begin_z, int end_z) const {
        std::vector<Strip> strips;
        const int height = samples.size[1];
        for (int begin = 0; begin < height; begin += most_rows) {
            const int end = std::min(begin + most_rows, height);
            bricks.for_runs(samples, begin, end, begin_z, end_z, most_bricks * samples.step,
                            [&](int from, int to) {
                                strips.push_back({from, to, begin, end, begin_z, end_z});
                            });
        }
        return strips;
    }

    void move(const Strip& strip, Slab& slab) const {
        with_own_type(samples, [&](auto zero) {
            using T = decltype(zero);
            const auto run = [&](auto is_coarse) {
                constexpr bool coarse = decltype(is_coarse)::value;
                const auto to_row = [&](const SweptRow& row) PALPATE_INLINE_LAMBDA {
                    move_row<T, coarse>(row, strip, row_of(slab, strip, row.y, row.z));
                };
                vectorized([&]()
                               PALPATE_INLINE_LAMBDA { sweep<T>(samples, levels, strip, to_row); });
            };
            samples.step > 1 ? run(std::true_type()) : run(std::false_type());
        });
    }

    /// u = 2b - Bb, kept within half a level of the volume's sample and inside its range.
    template <class T, bool is_coarse>
    PALPATE_INLINE void move_row(const SweptRow& row, const Strip& strip,
                                 std::int16_t* __restrict out) const {
        if (coarser && !(is_coarser(samples, 1, row.y) && is_coarser(samples, 2, row.z))) return;
        const T* own = own_row<T>(samples, row.y, row.z) + strip.begin_x;
        const std::int16_t* moved = moved_row(samples, row.y, row.z) + strip.begin_x;
        for (int i = 0; i < strip.end_x - strip.begin_x; ++i) {
            const float sample = in_levels(own[i], levels), bend = row.bend(i);
            float to = row.mean[i] + bend - sample;
            if constexpr (is_coarse) {
                const float from = static_cast<float>(moved[i]) * moved_unit;
                to = from + part_of(bend, levels) * (to - from);
            }
            out[i] = moved_to(to, sample, levels);
        }
        bricks.for_others(samples, row.y, row.z, strip.begin_x, strip.end_x, [&](int from, int to) {
            std::fill(out + (from - strip.begin_x), out + (to - strip.begin_x), std::int16_t{0});
        });
    }

    void put(const Strip& strip, Slab& slab) const {
        for (int z = strip.begin_z; z < strip.end_z; ++z) {
            for (int y = strip.begin_y; y < strip.end_y; ++y) {
                const std::int16_t* const from = row_of(slab, strip, y, z);
                if (!coarser) {
                    std::copy(from, from + (strip.end_x - strip.begin_x),
                              moved_row(samples, y, z) + strip.begin_x);
                } else if (is_coarser(samples, 1, y) && is_coarser(samples, 2, z)) {
                    std::int16_t* const to = moved_row(*coarser, y / 2, z / 2);
                    for (int x = strip.begin_x; x < strip.end_x; ++x) {
                        if (is_coarser(samples, 0, x)) to[x / 2] = from[x - strip.begin_x];
                    }
                }
            }
        }
    }

    /// Where the result of a strip's row waits.
    std::int16_t* row_of(Slab& slab, const Strip& strip, int y, int z) const {
        const std::ptrdiff_t row = std::ptrdiff_t{z - strip.begin_z} * samples.size[1] + y;
        return slab.result.data() + row * samples.size[0] + strip.begin_x;
    }
};

}  // namespace

void run_round(const MovedSamples& samples, const Levels& levels, const TerracedBricks& bricks,
               const Parallel& parallel, const std::function<void(int)>& at_slab,
               const MovedSamples* coarser) {
    const Round round{samples, levels, bricks, coarser};
    const Index3& size = samples.size;
    const int slices = std::min(size[2], std::clamp(size[2] / 8, fewest_slices, most_slices));
    std::array<Slab, 2> slabs;  // the one that is computed, and the one before
    for (Slab& slab : slabs) {
        slab.result.resize(std::size_t(slices) * std::size_t(size[0]) * std::size_t(size[1]));
    }
    const auto for_strips = [&](Slab& slab, const auto& work) {
        parallel(int(slab.strips.size()),
                 [&](int i) { (round.*work)(slab.strips[static_cast<std::size_t>(i)], slab); });
    };
    for (int begin = 0; begin < size[2]; begin += slices) {
        const int end = std::min(begin + slices, size[2]);
        std::swap(slabs[0], slabs[1]);
        slabs[0].strips = round.strips_of(begin, end);
        for_strips(slabs[0], &Round::move);
        for_strips(slabs[1], &Round::put);
        at_slab(end - begin);
    }
    for_strips(slabs[0], &Round::put);
}

}  // namespace palpate::filters
