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

constexpr int most_slices = 32, fewest_slices = 8;

struct Slab {
    int begin_z, end_z;
    std::vector<Strip> strips;
    std::int16_t* result = nullptr;
};

struct Round {
    const MovedSamples& samples;
    const Levels& levels;
    const TerracedBricks& bricks;
    const MovedSamples* coarser;

    void move(const Strip& strip, const Slab& slab) const {
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
            float to = row.mean(i) + bend - sample;
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

    void put(const Strip& strip, const Slab& slab) const {
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
    std::int16_t* row_of(const Slab& slab, const Strip& strip, int y, int z) const {
        const std::ptrdiff_t row = std::ptrdiff_t{z - slab.begin_z} * samples.size[1] + y;
        return slab.result + row * samples.size[0] + strip.begin_x;
    }
};

}  // namespace

void repeat_round(const MovedSamples& samples, const Levels& levels, const TerracedBricks& bricks,
                  int count, const Parallel& parallel, const std::function<void(int)>& at_slab,
                  const MovedSamples* coarser) {
    const Round round{samples, levels, bricks, coarser};
    const Index3& size = samples.size;
    const int slices = std::min(size[2], std::clamp(size[2] / 8, fewest_slices, most_slices));
    const std::size_t most = std::size_t(slices) * std::size_t(size[0]) * std::size_t(size[1]);
    std::array<std::vector<std::int16_t>, 2> results;  // of this slab and of the one before
    for (auto& result : results) result.resize(most);
    std::vector<Slab> slabs;
    for (int begin = 0; begin < size[2]; begin += slices) {
        slabs.push_back(
            {begin, std::min(begin + slices, size[2]), {}, results[slabs.size() % 2].data()});
    }
    parallel(int(slabs.size()), [&](int i) {
        Slab& slab = slabs[static_cast<std::size_t>(i)];
        slab.strips = strips_of(bricks, samples, slab.begin_z, slab.end_z);
    });
    const auto for_strips = [&](const Slab& slab, const auto& work) {
        parallel(int(slab.strips.size()),
                 [&](int i) { (round.*work)(slab.strips[static_cast<std::size_t>(i)], slab); });
    };
    for (int i = 0; i < count; ++i) {
        const Slab* before = nullptr;
        for (const Slab& slab : slabs) {
            for_strips(slab, &Round::move);
            if (before) for_strips(*before, &Round::put);
            before = &slab;
            at_slab(slab.end_z - slab.begin_z);
        }
        for_strips(*before, &Round::put);
    }
}

}  // namespace palpate::filters
