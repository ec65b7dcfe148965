// The proxy on the smooth field: where the surface has one plane at each of its points, the proxy
// slides along it, curvature included, and falls back onto it (docs/smooth.md).
#include <algorithm>
#include <cmath>

#include "proxy/update.hpp"

namespace palpate {
namespace {

/// Tangential distance to the target, relative to its depth, below which the proxy rests.
constexpr double resting_slope = 1e-4;
/// The same in voxels of the smallest spacing.
constexpr double least_distance = 1e-7;
/// Below this slope [range / voxel] the normal says nothing.
constexpr double least_slope = 1e-5;
/// Tries before the proxy looks round in all directions.
constexpr int most_failures = 6;

/// The surface at a point in contact, in folded millimetres, and where the target lies from there.
struct Contact {
    Vec3 normal;      ///< unit, out of the solid
    Vec3 tangential;  ///< of the vector to the target
    double depth;     ///< of the target below the tangent plane, > 0 when pressing
    double tangential_length;
    /// Directions of principal curvature and the curvatures [1/mm]; > 0 where the surface rises
    /// from its tangent plane towards the free side.
    std::array<Vec3, 2> direction;
    std::array<double, 2> curvature;
};

Contact contact_at(const CubicSite& site, const Vec3& h_mm, const Vec3& per_mm, double slope) {
    Contact c;
    c.normal = site.here.gradient.cwiseProduct(per_mm) * (-1 / slope);
    const double along = dot(h_mm, c.normal);
    c.depth = -along;
    c.tangential = h_mm - along * c.normal;
    c.tangential_length = std::sqrt(dot(c.tangential, c.tangential));
    // A basis of the tangent plane.
    const Vec3& n = c.normal;
    const double x = std::abs(n[0]), y = std::abs(n[1]), z = std::abs(n[2]);
    Vec3 a = x <= y && x <= z ? Vec3(0, -n[2], n[1])
             : y <= z         ? Vec3(n[2], 0, -n[0])
                              : Vec3(-n[1], n[0], 0);
    a *= 1 / std::sqrt(dot(a, a));
    const Vec3 b(n[1] * a[2] - n[2] * a[1], n[2] * a[0] - n[0] * a[2], n[0] * a[1] - n[1] * a[0]);
    const auto second = [&](const Vec3& v, const Vec3& w) {
        return dot(site.here.hessian * v.cwiseProduct(per_mm), w.cwiseProduct(per_mm)) / slope;
    };
    // The symmetric matrix of the curvatures, and its eigenvectors.
    const double kaa = second(a, a), kab = second(a, b), kbb = second(b, b);
    const double mean = 0.5 * (kaa + kbb), half = 0.5 * (kaa - kbb);
    const double radius = std::sqrt(half * half + kab * kab);
    c.curvature = {mean + radius, mean - radius};
    // Of the two forms of the first eigenvector the one without cancellation.
    double ca = half >= 0 ? half + radius : kab;
    double cb = half >= 0 ? kab : radius - half;
    const double length = std::sqrt(ca * ca + cb * cb);
    if (length > 0) {
        ca /= length;
        cb /= length;
    } else {
        ca = 1;
        cb = 0;
    }
    c.direction = {ca * a + cb * b, ca * b - cb * a};
    return c;
}

/// Where the target's foot lies along the surface, by its curvature: displacement in the tangent
/// plane [mm]. A curvature that brings the target's depth near its centre (or past it) is cut: the
/// displacement is at most 1 / `least` times that on a plane.
struct Foot {
    Vec3 along;
    double rise;  ///< y' K y: twice the height of the surface above the tangent plane there [mm]
};
Foot foot_of(const Contact& c, double least, double longest) {
    std::array<double, 2> y;
    for (int i = 0; i < 2; ++i) {
        y[i] = dot(c.tangential, c.direction[i]) / std::max(1 + c.depth * c.curvature[i], least);
    }
    double rise = c.curvature[0] * y[0] * y[0] + c.curvature[1] * y[1] * y[1];
    const double length = std::sqrt(y[0] * y[0] + y[1] * y[1]);
    double share = 1;
    if (rise != 0 && length > longest) share = longest / length;
    return {share * (y[0] * c.direction[0] + y[1] * c.direction[1]), share * share * rise};
}

/// An update that is under way.
class Descent {
  public:
    Descent(CubicSite& site, Progress& progress, const Friction& friction, Proxy& proxy)
        : site_(site),
          progress_(progress),
          friction_(friction),
          proxy_(proxy),
          hip_(progress.target),
          range_(site.range),
          shortest_(progress.geometry.spacing.minCoeff()),
          friction_pending_(friction.static_coefficient > 0 || friction.dynamic_coefficient > 0) {}

    Rest run() {
        int failures = 0;
        while (progress_.budget > 0) {
            const double before = distance();
            const End end = move(failures);
            if (end == End::at_target) return Rest::at_target;
            if (end == End::at_rest) return Rest::on_surface;
            const double after = distance();
            if (before - after > 1e-9 * shortest_ || end == End::target_changed) {
                failures = 0;
                continue;
            }
            if (++failures <= most_failures) continue;
            if (!look_round()) return Rest::on_surface;
            failures = 0;
        }
        return Rest::out_of_budget;
    }

  private:
    enum class End { moved, at_target, at_rest, target_changed };

    Vec3 h_mm() const { return site_.folded_to(progress_.target).cwiseProduct(spacing()); }
    Vec3 spacing() const {
        return fold_lengths(site_.point.tetrahedron, progress_.geometry.spacing);
    }
    Vec3 per_mm() const {
        return fold_lengths(site_.point.tetrahedron, site_.field.voxels_per_mm());
    }
    double distance() const {
        const Vec3 h = h_mm();
        return std::sqrt(dot(h, h));
    }

    /// One round: a straight motion through free space, or a slide and a fall.
    End move(int failures) {
        const Vec3 h = h_mm();
        const Vec3 per = per_mm();
        const Vec3 g = site_.here.gradient.cwiseProduct(per);
        if (!site_.in_contact() || dot(g, h) <= 0) {
            return fall_to_target(failures);
        }
        const double slope = std::sqrt(dot(g, g));
        if (!(slope * shortest_ > least_slope * range_)) {
            return look_round() ? End::moved : End::at_rest;
        }
        const Contact c = contact_at(site_, h, per, slope);
        if (!(c.tangential_length >
              std::max(resting_slope * c.depth, least_distance * shortest_))) {
            return End::at_rest;
        }
        if (friction_pending_) {
            friction_pending_ = false;
            return apply_friction(c) ? End::target_changed : End::at_rest;
        }
        slide(c, failures);
        return End::moved;
    }

    End fall_to_target(int failures) {
        const Vec3 to_target = site_.folded_to(progress_.target);
        const WalkEnd end = walk(site_, to_target, site_.level(), progress_);
        progress_.report(StepKind::free_move, site_);
        (void)failures;
        if (end != WalkEnd::target) return End::moved;
        if (progress_.target == hip_) return End::at_target;
        // Friction moved the target back to a point in free space, where there is no friction.
        progress_.target = hip_;
        friction_pending_ = true;
        return End::target_changed;
    }

    /// A displacement in mm, no farther than where the distance to the target is least.
    bool go(Vec3 v_mm, double level, WalkEnd& end) {
        const double towards = dot(v_mm, h_mm());
        if (!(towards > 0)) return false;
        const double least = towards / dot(v_mm, v_mm);
        if (least < 1) v_mm *= least;
        end = walk(site_, v_mm.cwiseProduct(per_mm()), level, progress_);
        return true;
    }

    /// Along the tangent plane, lifted where the surface rises, and from there down to where the
    /// surface's curvature says that the target's foot is.
    void slide(const Contact& c, int failures) {
        const double shrink = std::pow(0.25, failures);
        const Foot step = foot_of(c, 1, 1e30);
        const Foot aim = foot_of(c, 0.4, shortest_);
        const Vec3 v = shrink * step.along;
        const double lift = 0.55 * std::max(0.0, shrink * shrink * step.rise) +
                            (failures > 0 ? 0.05 * failures * std::sqrt(dot(v, v)) : 0);
        // In index axes: the walk changes the frame.
        const Tetrahedron frame = site_.point.tetrahedron;
        const Vec3 from = site_.index();
        const Vec3 foot_mm = shrink * aim.along + 0.5 * shrink * shrink * aim.rise * c.normal;
        const Vec3 foot = from + unfold(frame, foot_mm.cwiseProduct(per_mm()));
        WalkEnd end = WalkEnd::target;
        if (!go(v + lift * c.normal, site_.slide_level(), end)) return;
        progress_.report(StepKind::slide, site_);
        if (site_.in_contact()) return;
        // Aim, past the foot in case the surface lies lower.
        const Vec3 aimed = site_.folded_to(foot).cwiseProduct(spacing());
        if (go(2 * aimed, site_.level(), end)) {
            progress_.report(StepKind::slide, site_);
        }
    }

    /// Moves the target back against the direction in which the SCP would slide, so that the SCP
    /// ends up trailing the hand at the friction angle. False if the SCP sticks.
    bool apply_friction(const Contact& c) {
        const double mu =
            proxy_.sliding ? friction_.dynamic_coefficient : friction_.static_coefficient;
        proxy_.sliding = c.tangential_length > mu * c.depth;
        if (!proxy_.sliding) return false;
        const double back =
            std::min(1.0, friction_.dynamic_coefficient * c.depth / c.tangential_length);
        progress_.target -=
            unfold(site_.point.tetrahedron, (back * c.tangential).cwiseProduct(per_mm()));
        return true;
    }

    /// Where the normal does not show a way: a small step in each of 52 directions that lead
    /// closer.
    bool look_round() {
        constexpr double step = 1e-3;  // [voxel]
        const double before = distance();
        const Vec3 h = h_mm();
        const LatticePoint start = site_.point;
        Vec3 best = Vec3::Zero();
        double least = before - 1e-3 * step * shortest_;
        Progress silent{progress_.geometry, {}, progress_.target, progress_.budget};
        for (int i = 0; i < 125; ++i) {
            const Vec3 axes(i % 5 - 2, i / 5 % 5 - 2, i / 25 - 2);
            if (dot(axes, h) <= 0) continue;
            const Vec3 v = axes * (step * shortest_ / std::sqrt(dot(axes, axes)));
            if (std::abs(axes[0]) + std::abs(axes[1]) + std::abs(axes[2]) == 6) continue;
            site_.move_to(start);
            WalkEnd end;
            if (!go(v, site_.slide_level(), end)) continue;
            const double after = distance();
            if (after >= least) continue;
            least = after;
            best = v;
        }
        progress_.budget = silent.budget - 1;
        site_.move_to(start);
        if (best.isZero(0)) return false;
        WalkEnd end;
        go(best, site_.slide_level(), end);
        progress_.report(StepKind::slide, site_);
        return true;
    }

    CubicSite& site_;
    Progress& progress_;
    const Friction& friction_;
    Proxy& proxy_;
    const Vec3 hip_;
    const double range_;     // scaled like the site's excess
    const double shortest_;  // spacing [mm]
    bool friction_pending_;
};

}  // namespace

ProxyUpdate update_cubic(Proxy& proxy, const Field& field, const Vec3& hip,
                         const ProxySettings& settings, StepObserver observer) {
    const Vec3 target = index_from_physical(field.geometry(), hip);
    if (!accepts(proxy, field, target)) return refuse_update(proxy, field, hip);
    Update<CubicSite> update(proxy, field, target, settings, observer);
    if (update.recovering) return finish_update(proxy, update, hip, Rest::recovering);
    const Rest rest = Descent(update.site, update.progress, settings.friction, proxy).run();
    if (rest == Rest::at_target) proxy.sliding = false;
    return finish_update(proxy, update, hip, rest);
}

}  // namespace palpate
