// Casts rays into the picture.
#include "apps/viewer/model/probe_route.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>

#include "palpate/proxy.hpp"

namespace palpate::viewer {
namespace {

/// Rays on a square of so many are tried, the whole grid wide.
constexpr int rays = 15;

/// Moved along `towards` to this distance.
Vec3 at_depth(const Vec3& point, const Vec3& towards, double depth) {
    return point + (depth - point.dot(towards)) * towards;
}

/// In front of the grid, with a little room.
double front_of(const DepthExtent& extent) {
    return extent.front + 0.02 * (extent.front - extent.back);
}

/// The part of the line through `at`, between these depths, that the cuts leave. Or nothing.
std::optional<DepthExtent> part_seen(DepthExtent line, const Vec3& at, const Vec3& towards,
                                     std::span<const CutPlane> cuts) {
    for (const CutPlane& cut : cuts) {
        const double slope = cut.normal.dot(towards);
        const double room = cut.normal.dot(cut.point - at_depth(at, towards, 0));
        if (slope > 0) line.front = std::min(line.front, room / slope);
        if (slope < 0) line.back = std::max(line.back, room / slope);
        if (slope == 0 && room < 0) return std::nullopt;
    }
    if (!(line.front > line.back)) return std::nullopt;
    return line;
}

}  // namespace

DepthExtent extent_along(const Geometry& geometry, const Vec3& towards) {
    DepthExtent extent{std::numeric_limits<double>::max(), std::numeric_limits<double>::lowest()};
    for (int corner = 0; corner < 8; ++corner) {
        const Index3 side(corner & 1, corner >> 1 & 1, corner >> 2 & 1);
        const Index3 index = side.cwiseProduct(geometry.size - Index3::Ones());
        const double depth = physical_from_index(geometry, index.cast<double>()).dot(towards);
        extent.back = std::min(extent.back, depth);
        extent.front = std::max(extent.front, depth);
    }
    const double room = 2 * geometry.spacing.maxCoeff();
    extent.back -= room;
    extent.front += room;
    return extent;
}

std::optional<Vec3> surface_under(const Field& field, double isovalue, const Vec3& at,
                                  const Vec3& towards, std::span<const CutPlane> cuts) {
    const DepthExtent extent = extent_along(field.geometry(), towards);
    const auto seen = part_seen({extent.back, front_of(extent)}, at, towards, cuts);
    if (!seen) return std::nullopt;
    const Vec3 from = at_depth(at, towards, seen->front);
    const RayHit hit = cast_ray(field, isovalue, from, at_depth(at, towards, seen->back));
    return hit.hit && hit.point != from ? std::optional(hit.point) : std::nullopt;
}

std::optional<Vec3> tool_on_surface(const Field& field, double isovalue, const Vec3& at,
                                    const Vec3& towards, std::span<const Vec3> points,
                                    std::span<const CutPlane> cuts) {
    std::optional<Vec3> rest = surface_under(field, isovalue, at, towards, cuts);
    if (!rest) return rest;
    for (const Vec3& point : points) {
        const auto met = surface_under(field, isovalue, at + point, towards, cuts);
        if (!met) continue;
        const double depth = (*met - point).dot(towards);
        if (depth > rest->dot(towards)) rest = at_depth(*rest, towards, depth);
    }
    return rest;
}

std::optional<Vec3> surface_in_view(const Field& field, double isovalue, const Vec3& towards,
                                    const Vec3& up) {
    const Geometry& g = field.geometry();
    const Vec3 right = up.cross(towards).normalized(), above = towards.cross(right);
    const DepthExtent wide = extent_along(g, right), high = extent_along(g, above);
    std::vector<Vec3> offsets;
    for (int i = 0; i < rays * rays; ++i) {
        const double x = double(i % rays) / (rays - 1) - 0.5,
                     y = double(i / rays) / (rays - 1) - 0.5;
        offsets.emplace_back(x * (wide.front - wide.back) * right +
                             y * (high.front - high.back) * above);
    }
    std::ranges::stable_sort(offsets, {}, [](const Vec3& offset) { return offset.norm(); });
    for (const Vec3& offset : offsets) {
        if (auto hit = surface_under(field, isovalue, physical_centre(g) + offset, towards)) {
            return hit;
        }
    }
    return std::nullopt;
}

std::optional<Approach> approach_to(const Field& field, double isovalue, const Vec3& to,
                                    const Vec3& towards_viewer, std::span<const Vec3> points) {
    const Geometry& geometry = field.geometry();
    const double inwards = field.solid() == Solid::above ? 1 : -1;
    const bool inside = inwards * (value_at(field, to) - isovalue) > 0;
    const Vec3 outwards = -inwards * gradient_at(field, to);
    std::vector<Vec3> sides{towards_viewer};
    if (outwards.norm() > 0) sides.push_back(outwards.normalized());
    for (int axis = 0; axis < 3; ++axis) {
        for (const double sign : {1.0, -1.0}) sides.push_back(sign * geometry.direction.col(axis));
    }
    const double voxel = geometry.spacing.maxCoeff();
    std::optional<Approach> best;
    double least = std::numeric_limits<double>::max();
    for (const Vec3& side : sides) {
        const auto surface = surface_under(field, isovalue, to, side);
        if (!surface && inside) continue;
        const double solid = surface ? (*surface - to).dot(side) : 0;
        const double counted = std::max(0.0, solid - voxel);
        if (counted > least - 0.1 * voxel) continue;  // the first of those that are alike
        least = counted;
        best = Approach{side};
    }
    if (!best) return best;
    best->surface = tool_on_surface(field, isovalue, to, best->towards, points);
    if (best->surface && (*best->surface - to).dot(best->towards) <= 0) best->surface.reset();
    return best;
}

std::vector<Vec3> route_in_front(const Geometry& geometry, const Vec3& from, const Vec3& to,
                                 const Vec3& leaving, const Vec3& towards) {
    const auto out = [&](const Vec3& point, const Vec3& side) {
        const double front = front_of(extent_along(geometry, side));
        return at_depth(point, side, std::max(front, point.dot(side)));
    };
    std::vector<Vec3> stops{out(from, leaving)};
    if (leaving.dot(towards) < 0) {  // to the other side: past a third one
        const Vec3 across = towards - towards.dot(leaving) * leaving;
        stops.push_back(out(stops.back(),
                            across.norm() > 1e-6 ? across.normalized() : leaving.unitOrthogonal()));
    }
    const Vec3 before = out(stops.back(), towards);
    if (before != stops.back()) stops.push_back(before);
    stops.push_back(at_depth(to, towards, before.dot(towards)));
    stops.push_back(to);
    return stops;
}

}  // namespace palpate::viewer
