// Chords and clearances of the points of a tool.
#include "tool_proxy/around.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace palpate::tool {
namespace {

constexpr int brick_size = 4;  // cubes along each axis

Index3 brick_of(const Index3& sample) {
    return {sample[0] >> 2, sample[1] >> 2, sample[2] >> 2};
}

std::size_t place_of(const Index3& at, std::size_t count) {
    const auto mix = [](int i, std::uint32_t by) { return static_cast<std::uint32_t>(i) * by; };
    return (mix(at[0], 1) + mix(at[1], 16) + mix(at[2], 256) + mix(at[0] >> 4, 7) +
            mix(at[1] >> 4, 113) + mix(at[2] >> 4, 1019)) &
           (count - 1);
}

/// The samples of a brick and one more on each side, along each axis.
constexpr std::ptrdiff_t block_size = brick_size + 2;
constexpr std::array<std::ptrdiff_t, 3> block_stride{1, block_size, block_size* block_size};
using Block = std::array<double, std::size_t{block_size * block_size * block_size}>;

/// Counts in `gathered` what its samples cost.
Block block_of(const Field& field, const Index3& brick, Field::Gathered& gathered) {
    Block block;
    for (int i = 0; i < 8; ++i) {
        // 27 samples each.
        const Index3 corner = 3 * Index3(i & 1, i >> 1 & 1, i >> 2);
        const Index3 at = brick * brick_size + corner;
        double* to =
            block.data() + corner[0] + block_stride[1] * corner[1] + block_stride[2] * corner[2];
        const auto copy = [&](const auto* centre, std::ptrdiff_t row, std::ptrdiff_t slice) {
            for (std::ptrdiff_t z = 0; z < 3; ++z) {
                for (std::ptrdiff_t y = 0; y < 3; ++y) {
                    const auto* from = centre + (z - 1) * slice + (y - 1) * row - 1;
                    double* line = to + block_stride[1] * y + block_stride[2] * z;
                    for (int x = 0; x < 3; ++x) line[x] = from[x];
                }
            }
        };
        gathered.done = false;
        field.visit_around(at, copy, gathered);
    }
    return block;
}

/// Each Bernstein coefficient of the field is a mean of samples, and each of its derivative along
/// an axis a mean of differences of neighbours along that axis.
Surroundings::Bounds bounds_of(const Block& block, double sign) {
    Surroundings::Bounds bounds;
    bounds.most = -std::numeric_limits<double>::infinity();
    for (const double sample : block) bounds.most = std::max(bounds.most, sign * sample);
    for (std::size_t a = 0; a < 3; ++a) {
        const std::ptrdiff_t along = block_stride[a];
        double greatest = 0;
        for (std::ptrdiff_t p = 0; p < block_size; ++p) {
            for (std::ptrdiff_t q = 0; q < block_size; ++q) {
                const double* line =
                    block.data() + p * block_stride[(a + 1) % 3] + q * block_stride[(a + 2) % 3];
                for (std::ptrdiff_t i = 1; i < block_size; ++i, line += along) {
                    greatest = std::max(greatest, std::abs(line[along] - line[0]));
                }
            }
        }
        bounds.slope[static_cast<Eigen::Index>(a)] = greatest;
    }
    return bounds;
}

}  // namespace

bool renew(Surroundings& known, const Field& field) {
    const Moment& now = field.moment();
    const bool same = known.samples == field.shared_samples() && known.moment.from == now.from &&
                      known.moment.to == now.to && known.moment.weight == now.weight &&
                      known.sign == field.sign() && known.background == field.background();
    if (same) return false;
    known.samples = field.shared_samples();
    known.moment = now;
    known.sign = field.sign();
    known.background = field.background();
    ++known.epoch;
    return true;
}

Around::Around(const Field& field, double isovalue, Surroundings& surroundings, int work, int looks)
    : field_(field),
      level_(field.within_reach(isovalue - field.offset())),
      known_(surroundings),
      work_(work + looks),
      looks_(looks),
      shortest_(field.geometry().spacing.minCoeff()),
      origin_(field.geometry().origin),
      to_index_(field.voxels_per_mm().asDiagonal() * field.geometry().direction.transpose()) {}

Around::Expansion Around::expand(const Vec3& physical) {
    CubicSite at = site(index(physical));
    const cubic::Expansion& here = at.here();
    work_ -= 2;
    gather(at.take_gathering());
    const Tetrahedron& t = at.point.tetrahedron;
    // Columns: how folded axes lie in physical space.
    Mat3 fold_to_physical;
    for (int i = 0; i < 3; ++i) {
        fold_to_physical.col(i) = t.sign[i] * to_index_.row(t.axis[i]).transpose();
    }
    const auto& h = here.hessian;
    Mat3 folded;
    folded << h.d[0], h.s[0], h.e[0], h.d[1], h.s[1], h.e[1], h.e[0], h.e[1], h.ee;
    Expansion result;
    result.excess = here.value / cubic::scale;
    result.gradient = fold_to_physical * here.gradient / cubic::scale;
    result.hessian = fold_to_physical * folded * fold_to_physical.transpose() / cubic::scale;
    return result;
}

double Around::excess(const Vec3& physical) {
    CubicSite at = site(index(physical));
    const double excess = at.excess() / cubic::scale;
    --work_;
    gather(at.take_gathering());
    return excess;
}

double Around::free_part(const Vec3& from, const Vec3& to, double level) {
    CubicSite at = site(index(from));
    return walk(at, to_index_ * (to - from), level);
}

/// On the smooth field, for a point of a tool: empty bricks are passed over.
struct Around::Course {
    Around& around;
    double level;

    bool spend() { return around.work_-- > 0; }
    static bool is_enough(double /*left*/) { return false; }
    double skip(const CubicSite& at, const Vec3& direction, double left) {
        return around.empty_part(at, direction, left);
    }
    std::optional<double> advance(CubicSite& at, const Exit& exit, const Vec3& direction) {
        if (!at.reaches(level)) {
            at.jump(exit.t * direction, exit.walls());
            return std::nullopt;
        }
        const double t = at.advance(exit.t * direction, level, exit.walls());
        if (t < 1) return t * exit.t;
        return std::nullopt;
    }
    void crossed(CubicSite& at, unsigned wall) {
        at.cross(wall);
        around.gather(at.take_gathering());
    }
};

/// Counts what the samples of a cube have cost beside.
void Around::gather(int work) {
    const int of_looks = std::min(work, looks_);
    looks_ -= of_looks;
    work_ -= work - of_looks;
}

/// Which part of a way is free.
double Around::walk(CubicSite& at, const Vec3& displacement, double level_in_ranges) {
    double level = level_in_ranges * at.range;
    // Rounding must not hold a start.
    if (at.reaches(level) && at.excess() > level - 1e-13 * at.range) {
        level = at.excess() + (at.excess() < verified * at.range ? 4e-14 * at.range : 0);
    }
    walked_ = Index3::Constant(std::numeric_limits<int>::min());
    const Vec3 direction = fold(at.point.tetrahedron, displacement);
    const double left = walk_straight(at, direction, Course{*this, level}).left;
    gather(at.take_gathering());
    return 1 - left;
}

/// Which part of a way, of which a part is left, lies outside the grid or in a brick where nothing
/// blocks; 0 where walking is as quick.
double Around::empty_part(const CubicSite& at, const Vec3& direction, double left) {
    const Tetrahedron& t = at.point.tetrahedron;
    if (field_.is_background_around(t.cell)) {
        return stretch_outside(at.index(), unfold(t, direction), left, -2, field_.geometry().size,
                               1);
    }
    const Index3 brick = brick_of(t.cell);
    if (brick == walked_) return 0;  // looked at already
    if (brick_at(brick).own.most > field_.sign() * level_) {
        walked_ = brick;
        return 0;
    }
    const Vec3 along = unfold(t, direction), from = at.index();
    double leave = left;
    for (int a = 0; a < 3; ++a) {
        if (along[a] == 0) continue;
        const double side = brick[a] * brick_size + (along[a] > 0 ? brick_size - 0.5 : -0.5);
        leave = std::min(leave, (side - from[a]) / along[a]);
    }
    // A hair less, so that rounding does not lead out of the brick.
    return leave < left ? leave * (1 - 1e-9) : left;
}

Surroundings::Brick& Around::brick_at(const Index3& at) {
    Surroundings::Brick& brick = known_.bricks[place_of(at, Surroundings::brick_count)];
    if (brick.epoch == known_.epoch && brick.at == at) return brick;
    brick.at = at;
    brick.epoch = known_.epoch;
    brick.knows_wide = false;
    Field::Gathered gathered;
    brick.own = bounds_of(block_of(field_, at, gathered), field_.sign());
    work_ -= 5;
    gather(gathered.work);
    brick.own.slope = brick.own.slope.cwiseProduct(field_.voxels_per_mm());
    return brick;
}

Surroundings::Bounds Around::wide_bounds(const Index3& at) {
    if (const Surroundings::Brick& brick = brick_at(at); brick.knows_wide) return brick.wide;
    Surroundings::Bounds wide = brick_at(at).own;
    for (int i = 0; i < 27; ++i) {
        const Index3 next = at + Index3(i % 3, i / 3 % 3, i / 9) - Index3::Ones();
        const Surroundings::Bounds& own = brick_at(next).own;
        wide = {std::max(wide.most, own.most), wide.slope.cwiseMax(own.slope)};
    }
    Surroundings::Brick& brick = brick_at(at);  // a neighbour may have taken its place
    brick.wide = wide;
    brick.knows_wide = true;
    return wide;
}

Around::Probe Around::probe(const Vec3& from, const Vec3& to) {
    --work_;
    const Vec3 at = index(from);
    const Vec3& spacing = field_.geometry().spacing;
    const Index3 sample(int(std::floor(at[0] + 0.5)), int(std::floor(at[1] + 0.5)),
                        int(std::floor(at[2] + 0.5)));
    const Index3 brick = brick_of(sample);
    // To the border of the bricks around the point's own.
    double border = std::numeric_limits<double>::infinity();
    for (int a = 0; a < 3; ++a) {
        const double low = brick[a] * brick_size - 0.5;
        const double inner = std::max(0.0, std::min(at[a] - low, low + brick_size - at[a]));
        border = std::min(border, (inner + brick_size) * spacing[a]);
    }
    const Surroundings::Bounds bounds = wide_bounds(brick);
    const Vec3 way = to - from;
    const double squared = dot(way, way);
    const bool is_empty = bounds.most <= field_.sign() * level_;
    if (is_empty && squared < border * border) return {1, border};
    CubicSite here = site(at);
    double clearance = border;
    if (!is_empty) {
        const double room = blocked * range() - here.excess() / cubic::scale;
        --work_;
        gather(here.take_gathering());
        const double steepest = std::sqrt(dot(bounds.slope, bounds.slope));
        clearance = room > 0 ? std::min(border, room / steepest * (1 - 1e-9)) : 0;
        if (squared < clearance * clearance) return {1, clearance};
    }
    return {walk(here, to_index_ * way, blocked), clearance};
}

}  // namespace palpate::tool
