// Casts rays towards the centre of a body, and measures arc length.
#include "evaluation/ring.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <stdexcept>

#include "palpate/proxy.hpp"

namespace palpate::evaluation {

Ring::Ring(std::vector<Vec3> points) : points_(std::move(points)) {
    if (points_.size() < 3) throw std::invalid_argument("a ring needs three points");
    points_.push_back(points_.front());
    arc_.push_back(0);
    for (std::size_t i = 1; i < points_.size(); ++i) {
        arc_.push_back(arc_.back() + (points_[i] - points_[i - 1]).norm());
    }
}

Vec3 Ring::at(double arc) const {
    const double along = arc - length() * std::floor(arc / length());
    const auto next = std::upper_bound(arc_.begin() + 1, arc_.end() - 1, along);
    const auto i = static_cast<std::size_t>(next - arc_.begin());
    const double piece = arc_[i] - arc_[i - 1];
    const double share = piece > 0 ? (along - arc_[i - 1]) / piece : 0;
    return points_[i - 1] + share * (points_[i] - points_[i - 1]);
}

Ring ring_round(const Subject& subject, double depth) {
    constexpr std::size_t rays = 360;
    const Geometry& geometry = subject.field.geometry();
    const Vec3 centre = physical_centre(geometry);
    const double outside = geometry.size.cast<double>().cwiseProduct(geometry.spacing).norm();
    std::vector<Vec3> outward;
    std::vector<std::optional<double>> radius;
    for (std::size_t i = 0; i < rays; ++i) {
        const double angle = 2 * std::numbers::pi * static_cast<double>(i) / rays;
        outward.emplace_back(geometry.direction.col(0) * std::cos(angle) +
                             geometry.direction.col(1) * std::sin(angle));
        const RayHit hit =
            cast_ray(subject.field, subject.isovalue, centre + outside * outward.back(), centre);
        radius.push_back(hit.hit ? std::optional((hit.point - centre).norm()) : std::nullopt);
    }
    if (2 * std::count(radius.begin(), radius.end(), std::nullopt) > static_cast<long>(rays)) {
        throw std::invalid_argument(subject.name +
                                    ": rays to its centre hardly meet the surface, so a hand "
                                    "cannot go round it; choose another level or volume");
    }
    std::vector<Vec3> points;
    for (std::size_t i = 0; i < rays; ++i) {
        std::size_t near = i;
        while (!radius[near]) near = (near + rays - 1) % rays;
        points.emplace_back(centre + std::max(0.0, *radius[near] - depth) * outward[i]);
    }
    return Ring(std::move(points));
}

}  // namespace palpate::evaluation
