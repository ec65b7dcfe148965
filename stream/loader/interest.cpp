// Which bricks the hands need: by their distance from the way of each hand.
#include "stream/loader/interest.hpp"

#include <algorithm>
#include <cmath>

#include "stream/box_bytes.hpp"

namespace palpate::stream {
namespace {

/// A hand is followed this far ahead [s], and no farther than this [bricks].
constexpr double look_ahead = 0.5;
constexpr double farthest = 16;
/// Time over which a hand's velocity is smoothed [s].
constexpr double smoothing = 0.05;
/// Bricks ahead of a moving hand count as this much farther than those it is in.
constexpr double ahead_factor = 0.5;
/// Bricks between proxy and hand count as farther by this factor: where the proxy waits, all bricks
/// around it are needed first.
constexpr double pull_factor = 0.2;
/// A proxy that is farther from its hand than this has been left behind: it waits for samples, or
/// a surface holds it [bricks].
constexpr double left_behind = 1;
/// A hand that goes farther than this while a brick comes [bricks] has left what it is in before
/// that can come: then what it reaches comes first, and what it is in counts as this much farther
/// [bricks].
constexpr double fast = 1, late_penalty = 1;
/// Samples around a ball that an update may read, more than reach.cpp's [voxel].
constexpr double margin = 5;

struct Segment {
    Vec3 from, to;  // [bricks]
};

Vec3 shortened(const Vec3& way) {
    const double length = way.norm();
    return length > farthest ? Vec3(way * (farthest / length)) : way;
}

double distance(const Segment& s, const Vec3& p) {
    const Vec3 along = s.to - s.from;
    const double squared = along.squaredNorm();
    const double t = squared > 0 ? std::clamp((p - s.from).dot(along) / squared, 0.0, 1.0) : 0;
    return (p - s.from - t * along).norm();
}

struct Scored {
    double score;
    Index3 brick;
};

/// Adds the bricks within `radius` [bricks] of the way of one hand.
void score(const Geometry& geometry, const Index3& count, const Interest& hand, double radius,
           double seconds, std::vector<Scored>& scored) {
    const auto in_bricks = [&](const Vec3& physical) {
        return Vec3(index_from_physical(geometry, physical) / ResidentBricks::edge);
    };
    const Vec3 proxy = in_bricks(hand.proxy);
    const Segment pull{proxy, proxy + shortened(in_bricks(hand.hand) - proxy)};
    const Vec3 velocity = hand.velocity.allFinite() ? hand.velocity : Vec3::Zero();
    const Vec3 soon = in_bricks(hand.proxy + look_ahead * velocity) - proxy;
    const double behind = (pull.to - pull.from).norm();
    const bool is_left = behind > left_behind;
    const bool is_fast = !is_left && soon.norm() * seconds > fast * look_ahead;
    // The predicted way. It begins at the hand if the proxy was left behind, and ahead of a fast
    // hand, with the bricks that can come in time.
    Vec3 begin = proxy;
    if (is_left) begin = pull.to;
    if (is_fast) begin = pull.to + 0.5 * shortened(soon);
    const Segment path{begin, begin + shortened(soon)};
    const Vec3 low = proxy.cwiseMin(pull.to).cwiseMin(path.to) - Vec3::Constant(radius);
    const Vec3 high = proxy.cwiseMax(pull.to).cwiseMax(path.to) + Vec3::Constant(radius);
    const Vec3 last = (count - Index3::Ones()).cast<double>();
    const Index3 first = low.cwiseMax(Vec3::Zero()).cwiseMin(last).cast<int>();
    const Index3 end = high.cwiseMax(Vec3::Zero()).cwiseMin(last).cast<int>();
    for_each_index({first, end}, [&](const Index3& brick) {
        const Vec3 centre = brick.cast<double>() + Vec3::Constant(0.5);
        const double to_proxy = (centre - proxy).norm();
        const double to_pull = distance(pull, centre);
        const double to_path = distance(path, centre);
        if (std::min(to_pull, to_path) > radius + 1) return;
        double near = to_pull + pull_factor * to_proxy;
        double ahead = to_path;
        if (is_fast) {
            near += late_penalty;
        } else if (is_left) {
            ahead += ahead_factor + pull_factor * behind;
        } else {
            ahead += ahead_factor * std::min(1.0, to_proxy);
        }
        scored.push_back({std::min(near, ahead), brick});
    });
}

}  // namespace

void HandMotion::see(double now, const Vec3& place) {
    if (const double passed = time ? now - *time : 0; passed > 0) {
        velocity += std::min(1.0, passed / smoothing) * ((place - at) / passed - velocity);
    }
    time = now;
    at = place;
}

std::vector<Index3> wanted_bricks(const Geometry& geometry, const Index3& count,
                                  std::span<const Interest> hands, std::size_t most,
                                  double seconds) {
    if (hands.empty()) return {};
    const double each = static_cast<double>(most) / static_cast<double>(hands.size());
    const double radius = std::clamp(0.5 * (std::cbrt(each) - 1), 1.0, 6.0);
    std::vector<Scored> scored;
    for (const Interest& hand : hands) {
        if (!hand.proxy.allFinite() || !hand.hand.allFinite()) continue;
        score(geometry, count, hand, radius, seconds, scored);
    }
    // Ties by place, so that the order does not depend on the library.
    std::ranges::sort(scored, [](const Scored& a, const Scored& b) {
        if (a.score != b.score) return a.score < b.score;
        return ByPlace{}(a.brick, b.brick);
    });
    std::vector<Index3> wanted;
    for (const Scored& s : scored) {
        if (wanted.size() >= most) break;
        wanted.push_back(s.brick);
    }
    return wanted;
}

std::vector<Index3> bricks_round(const Geometry& geometry, const Vec3& centre, double radius) {
    const Vec3 at = index_from_physical(geometry, centre);
    const Vec3 last = (geometry.size - Index3::Ones()).cast<double>();
    const Vec3 reach = (geometry.spacing.cwiseInverse() * radius).array() + margin;
    const Vec3 low = at - reach, high = at + reach;
    if (!((low.array() <= last.array()).all() && (high.array() >= 0).all())) return {};
    const auto brick_at = [&](const Vec3& index) {
        const Vec3 inside = index.cwiseMax(Vec3::Zero()).cwiseMin(last);
        return ResidentBricks::brick_of(inside.array().floor().cast<int>());
    };
    const Index3 first = brick_at(low), end = brick_at(high);
    std::vector<Index3> bricks;
    for_each_index({first, end}, [&](const Index3& brick) { bricks.push_back(brick); });
    return bricks;
}

LevelChoice levels_for(double speed, double seconds, int coarsest) {
    constexpr int coarser_first = 2;
    const double passed = speed * seconds;
    const int finest =
        passed > 1 ? static_cast<int>(std::min(std::ceil(std::log2(passed)), 30.0)) : 0;
    return {std::min(finest + coarser_first, coarsest), std::min(finest, coarsest)};
}

}  // namespace palpate::stream
