// One round of dequantization. Slices a step apart form a chain that no other slice enters. A chain
// is done in slabs, and a slab's result waits beside the samples until the next slab has read them.
#include "filters/round.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "filters/sweep.hpp"

namespace palpate::filters {
namespace {

constexpr int strip_rows = 32, most_slices = 32, fewest_slices = 8;

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

    PALPATE_INLINE void operator()(const SweptRow& row) const {
        const int count = strip.end_x - strip.begin_x;
        const T* own = own_row<T>(samples, row.y, row.z) + strip.begin_x;
        const std::int16_t* moved = moved_row(samples, row.y, row.z) + strip.begin_x;
        std::int16_t* __restrict out = result.data() + place(row.y, row.z) + strip.begin_x;
        const float half = settings.half;
        const float per_straight = 1 / settings.straight;
        for (int i = 0; i < count; ++i) {
            const float sample = in_levels(own[i], scale);
            const float mean = row.mean[i];
            const float bend = mean - binomial(row.before[i], row.here[i], row.after[i]);
            const float low = std::max(-half, -sample), high = std::min(half, scale.top - sample);
            const float from = static_cast<float>(moved[i]) * moved_unit;
            float to = mean + bend - sample;
            if constexpr (is_coarse) {
                const float part =
                    std::min(std::max(2 - std::abs(bend) * per_straight, 0.0F), 1.0F);
                to = from + part * (to - from);
            }
            // Adding and taking this rounds to the nearest whole number.
            constexpr float round = 3 << 22;
            const float units = std::min(std::max(to, low), high) * (1 / moved_unit);
            out[i] = static_cast<std::int16_t>(static_cast<int>(units + round - round));
        }
        keep_others(row, out);
    }

    std::ptrdiff_t place(int y, int z) const {
        const int k = (z - strip.z.at(strip.begin_z)) / strip.z.step;
        return (std::ptrdiff_t{k} * samples.size[1] + y) * samples.size[0];
    }
    /// What is in no terraced brick does not move.
    void keep_others(const SweptRow& row, std::int16_t* out) const {
        const std::uint8_t* is_terraced =
            bricks.row(bricks.brick_of(1, row.y), bricks.brick_of(2, row.z));
        const int last = bricks.brick_of(0, strip.end_x - 1);
        for (int brick = bricks.brick_of(0, strip.begin_x); brick <= last; ++brick) {
            if (is_terraced[brick]) continue;
            const int from = std::max(bricks.first_of(0, brick), strip.begin_x);
            const int to = std::min(bricks.first_of(0, brick + 1), strip.end_x);
            std::fill(out + (from - strip.begin_x), out + (to - strip.begin_x), std::int16_t{0});
        }
    }
};

template <class T, bool is_coarse>
void move_strip(const MoveRow<T, is_coarse>& move) {
    sweep<T>(move.samples, move.scale, move.strip, move);
}
#ifdef PALPATE_FOR_AVX2
template <class T, bool is_coarse>
PALPATE_FOR_AVX2 void move_strip_avx2(const MoveRow<T, is_coarse>& move) {
    sweep<T>(move.samples, move.scale, move.strip, move);
}
#endif

/// The strips of this slab that have terraced bricks in them, without long stretches that have not.
void add_strips(const TerracedBricks& bricks, const Index3& size, Strip slab,
                std::vector<Strip>& strips) {
    const auto first = [&](int axis, const Chain& chain, int at) {
        return bricks.brick_of(axis, chain.at(at));
    };
    std::vector<std::uint8_t> any(std::size_t(bricks.count()[0]));
    int before = -1;
    for (int k = slab.begin_z; k < slab.end_z; ++k) {
        const int z = first(2, slab.z, k);
        if (z == before) continue;
        before = z;
        int below = -1;
        for (int j = slab.begin_y; j < slab.end_y; ++j) {
            const int y = first(1, slab.y, j);
            if (y == below) continue;
            below = y;
            const std::uint8_t* row = bricks.row(y, z);
            for (std::size_t i = 0; i < any.size(); ++i) any[i] |= row[i];
        }
    }
    const int gap = 1 + slab.y.step / 4;  // [bricks] what a strip smooths beyond its ends
    for (int brick = 0, count = int(any.size()); brick < count; ++brick) {
        if (!any[std::size_t(brick)]) continue;
        int end = brick + 1;
        for (int i = end; i < std::min(end + gap, count); ++i) {
            if (any[std::size_t(i)]) end = i + 1;
        }
        slab.begin_x = std::max(bricks.first_of(0, brick), 0);
        slab.end_x = std::min(bricks.first_of(0, end), size[0]);
        strips.push_back(slab);
        brick = end;
    }
}

class Round {
  public:
    Round(const MovedSamples& samples, const LevelScale& scale, const RoundSettings& settings,
          const TerracedBricks& bricks, const Parallel& parallel)
        : samples_(samples),
          scale_(scale),
          settings_(settings),
          bricks_(bricks),
          parallel_(parallel) {}

    void run_chain(const Chain& chain, const std::function<void(int)>& at_slab) {
        const int slices =
            std::min(chain.size, std::clamp(samples_.size[2] / 8, fewest_slices, most_slices));
        for (Slab& slab : slabs_) {
            slab.result.resize(std::size_t(slices) * std::size_t(samples_.size[0]) *
                               std::size_t(samples_.size[1]));
            slab.strips.clear();
        }
        for (int begin = 0; begin < chain.size; begin += slices) {
            const int end = std::min(begin + slices, chain.size);
            std::swap(slabs_[0], slabs_[1]);
            slabs_[0].strips = strips_of(chain, begin, end);
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

    std::vector<Strip> strips_of(const Chain& chain, int begin, int end) const {
        std::vector<Strip> strips;
        const int height = samples_.size[1];
        for (int first = 0; first < std::min(settings_.step, height); ++first) {
            const Chain rows = chain_of(first, settings_.step, height);
            for (int y = 0; y < rows.size; y += strip_rows) {
                const int end_y = std::min(y + strip_rows, rows.size);
                add_strips(bricks_, samples_.size, {rows, chain, 0, 0, y, end_y, begin, end},
                           strips);
            }
        }
        return strips;
    }

    void move(const Strip& strip, Result& result) const {
        const bool is_coarse = settings_.step > 1;
        if (samples_.floats) {
            is_coarse ? move_as<float, true>(strip, result) : move_as<float, false>(strip, result);
        } else {
            is_coarse ? move_as<std::uint16_t, true>(strip, result)
                      : move_as<std::uint16_t, false>(strip, result);
        }
    }

    template <class T, bool is_coarse>
    void move_as(const Strip& strip, Result& result) const {
        const MoveRow<T, is_coarse> move{samples_, scale_, settings_, bricks_, strip, result};
#ifdef PALPATE_FOR_AVX2
        if (__builtin_cpu_supports("avx2")) return move_strip_avx2(move);
#endif
        move_strip(move);
    }

    void put(const Strip& strip, const Result& result) const {
        for (int k = strip.begin_z; k < strip.end_z; ++k) {
            for (int j = strip.begin_y; j < strip.end_y; ++j) {
                const int y = strip.y.at(j);
                const std::ptrdiff_t place =
                    (std::ptrdiff_t{k - strip.begin_z} * samples_.size[1] + y) * samples_.size[0];
                std::copy(result.begin() + place + strip.begin_x,
                          result.begin() + place + strip.end_x,
                          moved_row(samples_, y, strip.z.at(k)) + strip.begin_x);
            }
        }
    }

    const MovedSamples& samples_;
    const LevelScale& scale_;
    const RoundSettings& settings_;
    const TerracedBricks& bricks_;
    const Parallel& parallel_;
    std::array<Slab, 2> slabs_;  ///< the one that is computed, and the one before
};

}  // namespace

void run_round(const MovedSamples& samples, const LevelScale& scale, const RoundSettings& settings,
               const TerracedBricks& bricks, const Parallel& parallel,
               const std::function<void(int)>& at_slab) {
    Round round(samples, scale, settings, bricks, parallel);
    for (int first = 0; first < std::min(settings.step, samples.size[2]); ++first) {
        round.run_chain(chain_of(first, settings.step, samples.size[2]), at_slab);
    }
}

}  // namespace palpate::filters
