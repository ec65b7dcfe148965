// Which bricks have terraces.
#include "filters/terraced_bricks.hpp"

#include <algorithm>
#include <cmath>

#include "filters/sweep.hpp"

namespace palpate::filters {
namespace {

/// What is in a brick: weights of its samples, which are their slopes. Whole numbers, so that parts
/// of a volume have the same.
struct BrickSums {
    std::int32_t all = 0, stepped = 0;
};

/// Adds up a row of bricks.
template <class T>
struct WeighRow {
    const MovedSamples& samples;
    const LevelScale& scale;
    const TerracedBricks& bricks;
    const Strip& strip;
    BrickSums* sums;

    PALPATE_INLINE void operator()(const SweptRow& row) const {
        const T* own = own_row<T>(samples, row.y, row.z);
        const float* const above = row.mean + row.mean_row;
        const float* const below = row.mean - row.mean_row;
        for (int brick = 0; brick < bricks.count()[0]; ++brick) {
            const int from = std::max(bricks.first_of(0, brick), 0);
            const int to = std::min(bricks.first_of(0, brick + 1), strip.end_x);
            std::int32_t all = 0, stepped = 0;
            for (int i = from; i < to; ++i) {
                const float x = row.mean[i + 1] - row.mean[i - 1], y = above[i] - below[i];
                const float z = row.after[i] - row.before[i];
                const float slope = 0.5F * std::sqrt(x * x + y * y + z * z);
                const float twice = binomial(row.before[i], row.here[i], row.after[i]);
                const float off = in_levels(own[i], scale) - (2 * row.mean[i] - twice);
                const auto weight = static_cast<std::int32_t>(16 * std::min(slope, 4096.0F));
                all += weight;
                stepped += std::abs(off) <= 0.5F ? weight : 0;
            }
            sums[brick].all += all;
            sums[brick].stepped += stepped;
        }
    }
};

template <class T>
void weigh_strip(const WeighRow<T>& weigh) {
    sweep<T>(weigh.samples, weigh.scale, weigh.strip, weigh);
}
#ifdef PALPATE_FOR_AVX2
template <class T>
PALPATE_FOR_AVX2 void weigh_strip_avx2(const WeighRow<T>& weigh) {
    sweep<T>(weigh.samples, weigh.scale, weigh.strip, weigh);
}
#endif

template <class T>
void weigh(const WeighRow<T>& row) {
#ifdef PALPATE_FOR_AVX2
    if (__builtin_cpu_supports("avx2")) return weigh_strip_avx2(row);
#endif
    weigh_strip(row);
}

}  // namespace

TerracedBricks terraced_bricks(const MovedSamples& samples, const LevelScale& scale, bool mask,
                               const Index3& low, const Parallel& parallel) {
    MovedSamples own = samples;
    own.moved = nullptr;
    TerracedBricks bricks(samples.size, low), flat = bricks;
    const Index3 count = bricks.count();
    const Chain rows = chain_of(0, 1, samples.size[1]), slices = chain_of(0, 1, samples.size[2]);
    parallel(count[1] * count[2], [&](int i) {
        const int y = i % count[1], z = i / count[1];
        const auto begin = [&](int axis, int brick) {
            return std::clamp(bricks.first_of(axis, brick), 0, samples.size[axis]);
        };
        const Strip strip{rows,        slices,          0,           samples.size[0],
                          begin(1, y), begin(1, y + 1), begin(2, z), begin(2, z + 1)};
        std::vector<BrickSums> sums(static_cast<std::size_t>(count[0]));
        if (own.floats) {
            weigh(WeighRow<float>{own, scale, bricks, strip, sums.data()});
        } else {
            weigh(WeighRow<std::uint16_t>{own, scale, bricks, strip, sums.data()});
        }
        for (int x = 0; x < count[0]; ++x) {
            const BrickSums& sum = sums[static_cast<std::size_t>(x)];
            flat.row(y, z)[x] = sum.all == 0;
            bricks.row(y, z)[x] = sum.all > 0 && (mask || 2 * sum.stepped >= sum.all);
        }
    });
    bricks.grow_into(flat);
    return bricks;
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
