// Which bricks have terraces, and how wide these are.
#include "filters/terraced_bricks.hpp"

#include <algorithm>
#include <cmath>

#include "filters/sweep.hpp"

namespace palpate::filters {
namespace {

/// A hair less than half a level: samples on both sides of a mask's surface must not meet in it.
constexpr double half_level = 511.0 / 1024, half_level_of_mask = 127.0 / 256;
/// From this bend on a coarse step moves a sample less, from twice of it on not at all [levels].
constexpr double most_bend = 0.55, most_bend_of_mask = 0.05;

/// What is in a brick: weights of its samples, which are their slopes. Whole numbers, so that parts
/// of a volume have the same.
struct BrickSums {
    std::int32_t all = 0, stepped = 0;
};

/// Those of a row of bricks.
template <class T>
std::vector<BrickSums> sums_of(const MovedSamples& samples, const Levels& levels,
                               const TerracedBricks& bricks, int brick_y, int brick_z) {
    const auto begin = [&](int axis, int brick) {
        return std::clamp(bricks.first_of(axis, samples, brick), 0, samples.size[axis]);
    };
    std::vector<BrickSums> sums(static_cast<std::size_t>(bricks.count()[0]));
    const Strip strip{0,
                      samples.size[0],
                      begin(1, brick_y),
                      begin(1, brick_y + 1),
                      begin(2, brick_z),
                      begin(2, brick_z + 1)};
    const auto add = [&](const SweptRow& row) PALPATE_INLINE_LAMBDA {
        const T* own = own_row<T>(samples, row.y, row.z);
        for (int brick = 0; brick < bricks.count()[0]; ++brick) {
            const int from = begin(0, brick), to = begin(0, brick + 1);
            std::int32_t all = 0, stepped = 0;
            for (int i = from; i < to; ++i) {
                const float x = row.mean(i + 1) - row.mean(i - 1);
                const float y = row.mean(i + row.row) - row.mean(i - row.row);
                const float z = (row.after[i] - row.before[i]) * (1.0F / 1024);
                const float slope = 0.5F * std::sqrt(x * x + y * y + z * z);
                const float off = in_levels(own[i], levels) - (2 * row.mean(i) - row.twice(i));
                const auto weight = static_cast<std::int32_t>(16 * std::min(slope, 4096.0F));
                all += weight;
                stepped += std::abs(off) <= 0.5F ? weight : 0;
            }
            sums[std::size_t(brick)].all += all;
            sums[std::size_t(brick)].stepped += stepped;
        }
    };
    vectorized([&]() PALPATE_INLINE_LAMBDA { sweep<T>(samples, levels, strip, add); });
    return sums;
}

}  // namespace

MovedSamples every_second(const MovedSamples& samples) {
    MovedSamples some = samples;
    const Index3 first(first_coarser(samples, 0), first_coarser(samples, 1),
                       first_coarser(samples, 2));
    const std::ptrdiff_t row = first[1] * samples.row + first[0];
    if (samples.floats) some.floats += first[2] * samples.own_slice + row;
    if (samples.whole) some.whole += first[2] * samples.own_slice + row;
    some.moved += first[2] * samples.moved_slice + row;
    some.own_slice *= 2;
    some.moved_slice *= 2;
    some.row *= 2;
    some.apart *= 2;
    some.step *= 2;
    some.size = (samples.size - first + Index3::Ones()) / 2;
    some.low = (samples.low + Index3::Ones()) / 2;
    return some;
}

Levels::Levels(const DequantizePlan& plan)
    : least(float(plan.minimum)),
      per_level(float(1 / plan.level)),
      top(float((plan.maximum - plan.minimum) / plan.level)),
      half(float(plan.mask ? half_level_of_mask : half_level)),
      straight(float(plan.mask ? most_bend_of_mask : most_bend)) {}

TerracedBricks terraced_bricks(const MovedSamples& samples, const DequantizePlan& plan,
                               const Parallel& parallel) {
    const Levels levels(plan);
    MovedSamples own = samples;
    own.moved = nullptr;
    TerracedBricks bricks(samples.size, samples.low), flat = bricks;
    const Index3 count = bricks.count();
    parallel(count[1] * count[2], [&](int i) {
        const int y = i % count[1], z = i / count[1];
        const std::vector<BrickSums> sums = with_own_type(
            own, [&](auto zero) { return sums_of<decltype(zero)>(own, levels, bricks, y, z); });
        for (int x = 0; x < count[0]; ++x) {
            const BrickSums& sum = sums[static_cast<std::size_t>(x)];
            flat.row(y, z)[x] = sum.all == 0;
            bricks.row(y, z)[x] = sum.all > 0 && (plan.mask || 2 * sum.stepped >= sum.all);
        }
    });
    bricks.grow_into(flat);
    return bricks;
}

bool TerracedBricks::any(const MovedSamples& samples, int begin_y, int end_y, int begin_z,
                         int end_z) const {
    const int last_y = brick_of(1, samples, end_y - 1), last_z = brick_of(2, samples, end_z - 1);
    for (int z = brick_of(2, samples, begin_z); z <= last_z; ++z) {
        for (int y = brick_of(1, samples, begin_y); y <= last_y; ++y) {
            const std::uint8_t* const here = row(y, z);
            if (std::any_of(here, here + count_[0], [](auto is) { return is != 0; })) return true;
        }
    }
    return false;
}

void TerracedBricks::grow_into(const TerracedBricks& others) {
    const TerracedBricks before = *this;
    const auto near = [&](const Index3& at) {
        const Index3 low = (at.array() - 1).max(0),
                     high = (at + Index3::Ones()).cwiseMin(count_ - Index3::Ones());
        for (int z = low[2]; z <= high[2]; ++z) {
            for (int y = low[1]; y <= high[1]; ++y) {
                const std::uint8_t* row = before.row(y, z);
                if (std::any_of(row + low[0], row + high[0] + 1, [](auto is) { return is != 0; })) {
                    return true;
                }
            }
        }
        return false;
    };
    for (int z = 0; z < count_[2]; ++z) {
        for (int y = 0; y < count_[1]; ++y) {
            for (int x = 0; x < count_[0]; ++x) {
                if (others.row(y, z)[x] && near({x, y, z})) row(y, z)[x] = 1;
            }
        }
    }
}

}  // namespace palpate::filters
