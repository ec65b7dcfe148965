// Cuts boxes of bricks until no cut makes them less work to sweep.
#include "filters/strips.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace palpate::filters {
namespace {

constexpr int most_rows = 32, most_columns = 256;
/// A sweep smooths as many samples more along each axis, and each row takes as long as this many
/// samples more.
constexpr int around = 4, per_row = 16;

/// Of bricks, and at first of none.
struct BrickBox {
    Index3 begin = Index3::Constant(std::numeric_limits<int>::max());
    Index3 end = Index3::Constant(std::numeric_limits<int>::min());

    BrickBox united(const BrickBox& other) const {
        return {begin.cwiseMin(other.begin), end.cwiseMax(other.end)};
    }
};

struct Cut {
    const TerracedBricks& bricks;
    const MovedSamples& samples;
    const Strip& all;
    std::vector<Strip>& strips;

    /// A box that is the smallest one around its terraces.
    void cut(const BrickBox& box) {
        const double whole = work(box);
        if (whole == 0) return;
        double least = whole;
        BrickBox low, high;
        for (int axis = 0; axis < 3; ++axis) {
            const auto layer = [&](int at) {
                BrickBox some = box;
                some.begin[axis] = at;
                some.end[axis] = at + 1;
                return around_terraces(some);
            };
            std::vector<BrickBox> after{BrickBox()};
            for (int at = box.end[axis]; at-- > box.begin[axis] + 1;) {
                after.push_back(after.back().united(layer(at)));
            }
            BrickBox before;
            for (int at = box.begin[axis] + 1; at < box.end[axis]; ++at) {
                before = before.united(layer(at - 1));
                const BrickBox& rest = after[static_cast<std::size_t>(box.end[axis] - at)];
                const double parts = work(before) + work(rest);
                if (parts >= least) continue;
                least = parts;
                low = before;
                high = rest;
            }
        }
        if (least == whole) return strips.push_back(samples_of(box));
        cut(low);
        cut(high);
    }

    /// The smallest box around the terraces of one.
    BrickBox around_terraces(const BrickBox& box) const {
        BrickBox least;
        for (int z = box.begin[2]; z < box.end[2]; ++z) {
            for (int y = box.begin[1]; y < box.end[1]; ++y) {
                const std::uint8_t* const row = bricks.row(y, z);
                for (int x = box.begin[0]; x < box.end[0]; ++x) {
                    if (row[x]) least = least.united({{x, y, z}, {x + 1, y + 1, z + 1}});
                }
            }
        }
        return least;
    }

    Strip samples_of(const BrickBox& box) const {
        const auto first = [&](int axis, const Index3& brick) {
            return bricks.first_of(axis, samples, brick[axis]);
        };
        return {std::max(first(0, box.begin), all.begin_x), std::min(first(0, box.end), all.end_x),
                std::max(first(1, box.begin), all.begin_y), std::min(first(1, box.end), all.end_y),
                std::max(first(2, box.begin), all.begin_z), std::min(first(2, box.end), all.end_z)};
    }

    /// Of a sweep, as the number of samples that it smooths. 0 for none.
    double work(const BrickBox& box) const {
        if ((box.begin.array() >= box.end.array()).any()) return 0;
        const Strip strip = samples_of(box);
        const int x = strip.end_x - strip.begin_x, y = strip.end_y - strip.begin_y;
        const int z = strip.end_z - strip.begin_z;
        if (std::min({x, y, z}) <= 0) return 0;
        return double(x + around + per_row) * (y + around) * (z + around);
    }
};

}  // namespace

std::vector<Strip> strips_of(const TerracedBricks& bricks, const MovedSamples& samples, int begin_z,
                             int end_z) {
    std::vector<Strip> strips;
    const Index3& size = samples.size;
    for (int y = 0; y < size[1]; y += most_rows) {
        for (int x = 0; x < size[0]; x += most_columns) {
            const Strip all{x,       std::min(x + most_columns, size[0]),
                            y,       std::min(y + most_rows, size[1]),
                            begin_z, end_z};
            const auto brick = [&](int at_x, int at_y, int at_z) {
                return Index3(bricks.brick_of(0, samples, at_x), bricks.brick_of(1, samples, at_y),
                              bricks.brick_of(2, samples, at_z));
            };
            const Index3 last = brick(all.end_x - 1, all.end_y - 1, all.end_z - 1);
            Cut cut{bricks, samples, all, strips};
            cut.cut(cut.around_terraces(
                {brick(all.begin_x, all.begin_y, all.begin_z), last + Index3::Ones()}));
        }
    }
    return strips;
}

}  // namespace palpate::filters
