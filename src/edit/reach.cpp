// Weights of brushes at the samples of a grid.
#include "edit/reach.hpp"

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

double weight_at(double distance, double radius, double edge) {
    return std::clamp(0.5 + (radius - distance) / edge, 0.0, 1.0);
}

/// The samples between two corners in index space, kept within what an index can hold; the caller
/// clips to the grid.
SampleBox samples_within(const Vec3& low, const Vec3& high) {
    const Vec3 most = Vec3::Constant(1 << 21);
    return {low.cwiseMax(-most).cwiseMin(most).array().ceil().cast<int>(),
            high.cwiseMin(most).cwiseMax(-most).array().floor().cast<int>()};
}

/// Farthest point that a brush with this body changes, from the reference point [mm].
double arm_of(const edit::Sweep& sweep, const Geometry& geometry) {
    const Vec3 far = sweep.body->low().cwiseAbs().cwiseMax(sweep.body->high().cwiseAbs());
    return far.norm() + reach_of(sweep.brush, geometry);
}

}  // namespace

double edge_of(const Brush& brush, const Vec3& spacing) {
    return 2 * std::max(spacing.maxCoeff(), (1 - brush.hardness) * brush.radius);
}

double reach_of(const Brush& brush, const Geometry& geometry) {
    const double half = 0.5 * edge_of(brush, geometry.spacing);
    return std::max(brush.radius + half, half - brush.radius);
}

ToolBody body_for(const Brush& brush, const Geometry& geometry, std::shared_ptr<const Tool> tool) {
    // Far from the skin distances are smooth: a wide brush needs no finer ones.
    const double reach = reach_of(brush, geometry);
    return {std::move(tool), std::max(0.5 * geometry.spacing.minCoeff(), reach / 8), reach};
}

StrokeReach::StrokeReach(const edit::Stroke& stroke, const Geometry& geometry)
    : spacing_(geometry.spacing),
      from_(index_from_physical(geometry, stroke.from).cwiseProduct(spacing_)),
      along_(index_from_physical(geometry, stroke.to).cwiseProduct(spacing_) - from_),
      length_squared_(along_.squaredNorm()),
      radius_(stroke.brush.radius),
      edge_(edge_of(stroke.brush, spacing_)) {}

double StrokeReach::weight(const Index3& at) const {
    const Vec3 p = spacing_.cwiseProduct(at.cast<double>()) - from_;
    const double t =
        length_squared_ > 0 ? std::clamp(p.dot(along_) / length_squared_, 0.0, 1.0) : 0;
    return weight_at((p - t * along_).norm(), radius_, edge_);
}

SampleBox StrokeReach::box() const {
    const Vec3 reach = Vec3::Constant(radius_ + 0.5 * edge_);
    return samples_within((from_.cwiseMin(from_ + along_) - reach).cwiseQuotient(spacing_),
                          (from_.cwiseMax(from_ + along_) + reach).cwiseQuotient(spacing_));
}

double poses_of(const edit::Sweep& sweep, const Geometry& geometry) {
    const Vec3 turn = rotation_between(sweep.from.orientation, sweep.to.orientation);
    const double way =
        (sweep.to.position - sweep.from.position).norm() + turn.norm() * arm_of(sweep, geometry);
    return 1 + std::ceil(way / (0.25 * geometry.spacing.minCoeff()));
}

SweepReach::SweepReach(const edit::Sweep& sweep, const Geometry& geometry)
    : body_(*sweep.body),
      radius_(sweep.brush.radius),
      edge_(edge_of(sweep.brush, geometry.spacing)) {
    const int count = static_cast<int>(poses_of(sweep, geometry));
    // Interpolated distances change by at most the root of 3 a millimetre.
    between_ = 1.75 * 0.25 * geometry.spacing.minCoeff();
    const Vec3 turn = rotation_between(sweep.from.orientation, sweep.to.orientation);
    const Mat3 grid = geometry.direction * geometry.spacing.asDiagonal();
    const Vec3 reach = Vec3::Constant(reach_of(sweep.brush, geometry));
    const Vec3 middle = 0.5 * (body_.low() + body_.high());
    const Vec3 half = 0.5 * (body_.high() - body_.low()) + reach;
    for (int i = 0; i < count; ++i) {
        const double t = count > 1 ? double(i) / (count - 1) : 0;
        const Vec3 position = sweep.from.position + t * (sweep.to.position - sweep.from.position);
        const Mat3 to_tool =
            turned(sweep.from.orientation, t * turn).toRotationMatrix().transpose();
        poses_.push_back({to_tool * grid, to_tool * (geometry.origin - position)});
        const Mat3 to_index = geometry.spacing.cwiseInverse().asDiagonal() *
                              geometry.direction.transpose() * to_tool.transpose();
        const Vec3 at = index_from_physical(geometry, position) + to_index * middle;
        const Vec3 around = to_index.cwiseAbs() * half;
        box_ = united(box_, samples_within(at - around, at + around));
    }
}

double SweepReach::weight(const Index3& at) const {
    const Vec3 index = at.cast<double>();
    const double full = radius_ - 0.5 * edge_;
    const double none = radius_ + 0.5 * edge_;
    double nearest = none;
    for (std::size_t i = 0; i < poses_.size();) {
        const double d = body_.distance(poses_[i].rotation * index + poses_[i].translation);
        nearest = std::min(nearest, d);
        if (nearest <= full) return 1;
        // Nearer than that at none of the poses that are passed over.
        const double skip = (d - nearest) / between_;
        i += skip < double(poses_.size()) ? std::max<std::size_t>(1, static_cast<std::size_t>(skip))
                                          : poses_.size();
    }
    return nearest < none ? weight_at(nearest, radius_, edge_) : 0;
}

SampleBox SweepReach::box() const {
    return box_;
}

}  // namespace palpate
