// Tracks measured by arc length, and journeys along them with smooth starts and stops.
#include "scenes/track.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace palpate::scenes {
namespace {

std::vector<Vec3> averaged(const std::vector<Vec3>& points, std::ptrdiff_t reach, bool closed) {
    const auto count = static_cast<std::ptrdiff_t>(points.size());
    const std::ptrdiff_t period = count - 1;  // of a closed track, whose last point is its first
    if (period < 1) return points;
    const auto point = [&](std::ptrdiff_t i) -> const Vec3& {
        return points[static_cast<std::size_t>(closed ? (i % period + period) % period : i)];
    };
    std::vector<Vec3> result(points.size());
    for (std::ptrdiff_t i = 0; i < count; ++i) {
        const std::ptrdiff_t r = closed ? reach : std::min({reach, i, count - 1 - i});
        Vec3 sum = Vec3::Zero();
        for (std::ptrdiff_t j = i - r; j <= i + r; ++j) sum += point(j);
        result[static_cast<std::size_t>(i)] = sum / static_cast<double>(2 * r + 1);
    }
    if (closed) result.back() = result.front();
    return result;
}

}  // namespace

Track::Track(std::vector<Vec3> points) : points_(std::move(points)), arc_(points_.size(), 0.0) {
    for (std::size_t i = 1; i < points_.size(); ++i) {
        arc_[i] = arc_[i - 1] + (points_[i] - points_[i - 1]).norm();
    }
}

Vec3 Track::at(double arc) const {
    const auto next = std::upper_bound(arc_.begin(), arc_.end(), arc);
    if (next == arc_.begin()) return points_.front();
    if (next == arc_.end()) return points_.back();
    const auto i = static_cast<std::size_t>(next - arc_.begin());
    const double share = (arc - arc_[i - 1]) / (arc_[i] - arc_[i - 1]);
    return points_[i - 1] + share * (points_[i] - points_[i - 1]);
}

Track rounded(const Track& track, double radius, bool closed) {
    constexpr int steps_per_radius = 8;
    constexpr double most_points = 200000;
    const double steps =
        std::min(std::ceil(track.length() / (radius / steps_per_radius)), most_points);
    if (!(steps >= 1)) return track;
    std::vector<Vec3> points;
    points.reserve(static_cast<std::size_t>(steps) + 1);
    for (int i = 0; i <= static_cast<int>(steps); ++i) {
        points.push_back(track.at(track.length() * (i / steps)));
    }
    // A closed track shorter than the window would be averaged away to a point.
    const auto reach = std::min<std::ptrdiff_t>(steps_per_radius, std::ssize(points) / 8);
    return Track(averaged(averaged(points, reach, closed), reach, closed));
}

Journey::Journey(double length_mm, double speed_mm_s)
    : length_(length_mm), peak_(speed_mm_s), ramp_(ramp_s) {
    const double to_full_speed_and_back = speed_mm_s * ramp_s;
    if (length_ < to_full_speed_and_back) {
        const double slower = std::sqrt(length_ / to_full_speed_and_back);
        peak_ *= slower;
        ramp_ *= slower;
    }
    duration_ = length_ > 0 ? length_ / peak_ + ramp_ : 0;
}

double Journey::without_end(double t) const {
    if (t <= 0 || length_ <= 0) return 0;
    if (t >= ramp_) return peak_ * (t - 0.5 * ramp_);
    // The integral of the smoothstep 3u^2 - 2u^3.
    const double u = t / ramp_;
    return peak_ * ramp_ * u * u * u * (1 - 0.5 * u);
}

double Journey::travelled(double t) const {
    if (t >= duration_) return length_;
    return t < 0.5 * duration_ ? without_end(t) : length_ - without_end(duration_ - t);
}

double Journey::there_and_back(double t) const {
    if (!(duration_ > 0)) return 0;
    const double within = t - 2 * duration_ * std::floor(t / (2 * duration_));
    return within < duration_ ? travelled(within) : length_ - travelled(within - duration_);
}

}  // namespace palpate::scenes
