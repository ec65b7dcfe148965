// One round of dequantization. It is done in slabs, and a slab's result waits beside the samples
// until the next slab has read them.
#include "filters/round.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "filters/sweep.hpp"

namespace palpate::filters {
namespace {

/// Of a strip, so that a sweep stays in the second-level cache.
constexpr int most_rows = 32, most_bricks = 16;
constexpr int most_slices = 32, fewest_slices = 8;

using Result = std::vector<std::int16_t>;

/// u = 2b - Bb, kept within half a level of the volume's sample and inside its range.
template <class T, bool is_coarse>
struct MoveRow {
    const MovedSamples& samples;
    const LevelScale& scale;
    const RoundSettings& settings;
    const TerracedBricks& bricks;
    const Strip& strip;
    Result& result;
    bool every_second;  ///< row of every second slice

    PALPATE_INLINE void operator()(const SweptRow& row) const {
        if (every_second && !(is_coarser(samples, 1, row.y) && is_coarser(samples, 2, row.z))) {
            return;
        }
        const int count = strip.end_x - strip.begin_x;
        const T* own = own_row<T>(samples, row.y, row.z) + strip.begin_x;
        const std::int16_t* moved = moved_row(samples, row.y, row.z) + strip.begin_x;
        std::int16_t* __restrict out = result.data() + place(row.y, row.z) + strip.begin_x;
        const Limits limits{settings.half, scale.top};
        const float per_straight = 1 / settings.straight;
        for (int i = 0; i < count; ++i) {
            const float sample = in_levels(own[i], scale), bend = row.bend(i);
            float to = row.mean[i] + bend - sample;
            if constexpr (is_coarse) {
                const float from = static_cast<float>(moved[i]) * moved_unit;
                to = from + part_of(bend, per_straight) * (to - from);
            }
            out[i] = limits.moved(to, sample);
        }
        bricks.for_others(samples, row.y, row.z, strip.begin_x, strip.end_x, [&](int from, int to) {
            std::fill(out + (from - strip.begin_x), out + (to - strip.begin_x), std::int16_t{0});
        });
    }

    std::ptrdiff_t place(int y, int z) const {
        return (std::ptrdiff_t{z - strip.begin_z} * samples.size[1] + y) * samples.size[0];
    }
};

class Round {
  public:
    Round(const MovedSamples& samples, const LevelScale& scale, const RoundSettings& settings,
          const TerracedBricks& bricks, const Parallel& parallel, const MovedSamples* coarser)
        : samples_(samples),
          scale_(scale),
          settings_(settings),
          bricks_(bricks),
          parallel_(parallel),
          coarser_(coarser) {}

    void run(const std::function<void(int)>& at_slab) {
        const Index3& size = samples_.size;
        const int slices = std::min(size[2], std::clamp(size[2] / 8, fewest_slices, most_slices));
        for (Slab& slab : slabs_) {
            slab.result.resize(std::size_t(slices) * std::size_t(size[0]) * std::size_t(size[1]));
        }
        for (int begin = 0; begin < size[2]; begin += slices) {
            const int end = std::min(begin + slices, size[2]);
            std::swap(slabs_[0], slabs_[1]);
            slabs_[0].strips = strips_of(begin, end);
            for_strips(slabs_[0], [&](const Strip& strip) { move(strip, slabs_[0].result); });
            for_strips(slabs_[1], [&](const Strip& strip) { put(strip, slabs_[1].result); });
            at_slab(end - begin);
        }
        for_strips(slabs_[0], [&](const Strip& strip) { put(strip, slabs_[0].result); });
    }

  private:
    struct Slab {
        std::vector<Strip> strips;
        Result result;
    };

    template <class Work>
    void for_strips(const Slab& slab, const Work& work) const {
        parallel_(int(slab.strips.size()),
                  [&](int i) { work(slab.strips[static_cast<std::size_t>(i)]); });
    }

    /// The strips of a slab that have terraced bricks in them.
    std::vector<Strip> strips_of(int begin_z, int end_z) const {
        std::vector<Strip> strips;
        const int height = samples_.size[1];
        for (int begin = 0; begin < height; begin += most_rows) {
            const int end = std::min(begin + most_rows, height);
            bricks_.for_runs(samples_, {0, begin, begin_z}, {samples_.size[0], end, end_z},
                             most_bricks * samples_.step, [&](int from, int to) {
                                 strips.push_back({from, to, begin, end, begin_z, end_z});
                             });
        }
        return strips;
    }

    void move(const Strip& strip, Result& result) const {
        with_own_type(samples_, [&](auto zero) {
            using T = decltype(zero);
            const auto run = [&](const auto& row) {
                vectorized([&]() PALPATE_INLINE_LAMBDA { sweep<T>(samples_, scale_, strip, row); });
            };
            if (samples_.step > 1) {
                run(MoveRow<T, true>{samples_, scale_, settings_, bricks_, strip, result,
                                     coarser_ != nullptr});
            } else {
                run(MoveRow<T, false>{samples_, scale_, settings_, bricks_, strip, result,
                                      coarser_ != nullptr});
            }
        });
    }

    void put(const Strip& strip, const Result& result) const {
        for (int z = strip.begin_z; z < strip.end_z; ++z) {
            for (int y = strip.begin_y; y < strip.end_y; ++y) {
                const std::int16_t* const from =
                    result.data() +
                    (std::ptrdiff_t{z - strip.begin_z} * samples_.size[1] + y) * samples_.size[0];
                if (coarser_) {
                    put_every_second(from, strip, y, z);
                } else {
                    std::copy(from + strip.begin_x, from + strip.end_x,
                              moved_row(samples_, y, z) + strip.begin_x);
                }
            }
        }
    }
    void put_every_second(const std::int16_t* from, const Strip& strip, int y, int z) const {
        if (!is_coarser(samples_, 1, y) || !is_coarser(samples_, 2, z)) return;
        std::int16_t* const to = moved_row(*coarser_, y / 2, z / 2);
        for (int x = strip.begin_x; x < strip.end_x; ++x) {
            if (is_coarser(samples_, 0, x)) to[x / 2] = from[x];
        }
    }

    const MovedSamples& samples_;
    const LevelScale& scale_;
    const RoundSettings& settings_;
    const TerracedBricks& bricks_;
    const Parallel& parallel_;
    const MovedSamples* coarser_;
    std::array<Slab, 2> slabs_;  ///< the one that is computed, and the one before
};

}  // namespace

void run_round(const MovedSamples& samples, const LevelScale& scale, const RoundSettings& settings,
               const TerracedBricks& bricks, const Parallel& parallel,
               const std::function<void(int)>& at_slab, const MovedSamples* coarser) {
    Round(samples, scale, settings, bricks, parallel, coarser).run(at_slab);
}

}  // namespace palpate::filters
