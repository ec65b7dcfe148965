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
/// Farther than any slide [mm].
constexpr double far = 1e30;
/// Tries before the proxy looks round in all directions.
constexpr int most_failures = 6;

/// The surface at a point in contact, in folded millimetres, and where the target lies from there.
struct Contact {
    Vec3 normal;      ///< unit, out of the solid
    Vec3 tangential;  ///< of the vector to the target
    double depth;     ///< of the target below the tangent plane, > 0 when pressing
    double tangential_length;
};

/// The surface's curvature, in coordinates of the tangent plane: along the target's direction in
/// it, and across.
struct Curvature {
    Vec3 along, across;           ///< unit
    double cosine, sine;          ///< of the first direction of principal curvature
    std::array<double, 2> value;  ///< [1/mm] > 0 where the surface rises towards the free side
};

/// `slope` is that of the field, in the unit of the Hessian.
Curvature curvature_of(const cubic::Symmetric& hessian, const Contact& c, const Vec3& per_mm,
                       double slope) {
    const Vec3 t = c.tangential * (1 / c.tangential_length);
    const Vec3& n = c.normal;
    const Vec3 a(n[1] * t[2] - n[2] * t[1], n[2] * t[0] - n[0] * t[2], n[0] * t[1] - n[1] * t[0]);
    const Vec3 scaled_t = t.cwiseProduct(per_mm), scaled_a = a.cwiseProduct(per_mm);
    const Vec3 ht = hessian * scaled_t;
    const double each = 1 / slope;
    const double ktt = each * dot(ht, scaled_t), kta = each * dot(ht, scaled_a),
                 kaa = each * dot(hessian * scaled_a, scaled_a);
    const double mean = 0.5 * (ktt + kaa), half = 0.5 * (ktt - kaa);
    const double radius = std::sqrt(half * half + kta * kta);
    // Of the two forms of the first eigenvector the one without cancellation.
    const double x = half >= 0 ? half + radius : kta;
    const double y = half >= 0 ? kta : radius - half;
    const double length = std::sqrt(x * x + y * y);
    const double share = length > 0 ? 1 / length : 0;
    return {t, a, length > 0 ? x * share : 1, y * share, {mean + radius, mean - radius}};
}

/// Where the target's foot lies along the surface, by its curvature: in the tangent plane [mm]. A
/// curvature that brings the target's depth near its centre (or past it) is cut: the displacement
/// is at most 1 / `least` times that on a plane.
struct Foot {
    Vec3 along;
    double rise;  ///< y' K y: twice the height of the surface above the tangent plane there [mm]
};
Foot foot_of(const Contact& c, const Curvature& k, double least, double longest) {
    double y0 = c.tangential_length * k.cosine / std::max(1 + c.depth * k.value[0], least);
    double y1 = -c.tangential_length * k.sine / std::max(1 + c.depth * k.value[1], least);
    const double squared = y0 * y0 + y1 * y1;
    if (squared > longest * longest) {
        const double share = longest / std::sqrt(squared);
        y0 *= share;
        y1 *= share;
    }
    return {(k.cosine * y0 - k.sine * y1) * k.along + (k.sine * y0 + k.cosine * y1) * k.across,
            k.value[0] * y0 * y0 + k.value[1] * y1 * y1};
}

/// An update that is under way.
class CubicDescent {
  public:
    CubicDescent(CubicSite& site, Progress& progress, const Friction& friction, Proxy& proxy)
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
        Vec3 h = h_mm();
        double before = dot(h, h);
        while (progress_.budget > 0) {
            const End end = move(h, failures);
            if (end == End::at_target) return Rest::at_target;
            if (end == End::at_rest) return Rest::on_surface;
            h = h_mm();
            const double after = dot(h, h);
            // Of the distance at least 1e-9 voxel, without its root.
            const bool closer =
                before - after >
                2e-9 * shortest_ *
                    std::max(std::abs(h[0]) + std::abs(h[1]) + std::abs(h[2]), 1e-9 * shortest_);
            before = after;
            if (closer || end == End::target_changed) {
                failures = 0;
                continue;
            }
            if (++failures <= most_failures) continue;
            if (!look_round()) return Rest::on_surface;
            failures = 0;
            h = h_mm();
            before = dot(h, h);
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

    /// One round: a straight motion through free space, or a slide and a fall. `h` leads to the
    /// target.
    End move(const Vec3& h, int failures) {
        const Vec3 per = per_mm();
        const Vec3 g = site_.here.gradient.cwiseProduct(per);
        const double along = dot(g, h);
        if (!site_.in_contact() || along <= 0) return fall_to_target();
        const double squared = dot(g, g);
        const double flat = least_slope * range_ / shortest_;
        const bool is_flat = !(squared > flat * flat);
        // The target's distance along the tangent plane, times the slope, squared.
        const double aside = dot(h, h) * squared - along * along;
        const double least = least_distance * shortest_;
        if (!(aside >
              std::max(resting_slope * resting_slope * along * along, least * least * squared))) {
            return is_flat && look_round() ? End::moved : End::at_rest;
        }
        const double slope = std::sqrt(squared);
        Contact c;
        c.normal = g * (-1 / slope);
        c.depth = along / slope;
        c.tangential = h + c.depth * c.normal;
        c.tangential_length = std::sqrt(dot(c.tangential, c.tangential));
        if (friction_pending_) {
            friction_pending_ = false;
            return apply_friction(c) ? End::target_changed : End::at_rest;
        }
        const cubic::Symmetric hessian = site_.piece.hessian_at(site_.point.folded);
        slide(h, c, curvature_of(hessian, c, per, slope), failures);
        return End::moved;
    }

    End fall_to_target() {
        const Vec3 to_target = site_.folded_to(progress_.target);
        const WalkEnd end = walk(site_, to_target, site_.level(), progress_);
        progress_.report(StepKind::free_move, site_);
        if (end != WalkEnd::target) return End::moved;
        if (progress_.target == hip_) return End::at_target;
        // Friction moved the target back to a point in free space, where there is no friction.
        progress_.target = hip_;
        friction_pending_ = true;
        return End::target_changed;
    }

    /// A displacement in mm, no farther than where the distance to the target, which `h` leads to,
    /// is least. False if it leads away.
    bool go(Vec3 v_mm, const Vec3& h, double level, Progress& progress) {
        const double towards = dot(v_mm, h);
        if (!(towards > 0)) return false;
        const double squared = dot(v_mm, v_mm);
        if (towards < squared) v_mm *= towards / squared;
        walk(site_, v_mm.cwiseProduct(per_mm()), level, progress);
        return true;
    }

    /// Along the tangent plane, lifted where the surface rises, and from there down to where the
    /// surface's curvature says that the target's foot is. After failures shorter and higher.
    void slide(const Vec3& h, const Contact& c, const Curvature& k, int failures) {
        const double shrink = std::ldexp(1.0, -2 * failures);
        const Foot step = foot_of(c, k, 1, far);
        const Foot aim = foot_of(c, k, 0.4, shortest_);
        const double lift = 0.55 * shrink * shrink * std::max(0.0, step.rise) +
                            0.05 * failures * shrink * std::sqrt(dot(step.along, step.along));
        // In index axes: the walk changes the frame.
        const Vec3 foot_mm = shrink * (aim.along + (0.5 * shrink * aim.rise) * c.normal);
        const Vec3 foot =
            site_.index() + unfold(site_.point.tetrahedron, foot_mm.cwiseProduct(per_mm()));
        if (!go(shrink * step.along + lift * c.normal, h, site_.slide_level(), progress_)) return;
        progress_.report(StepKind::slide, site_);
        if (site_.in_contact()) return;
        // Aim past the foot, in case the surface lies lower.
        const Vec3 aimed = site_.folded_to(foot).cwiseProduct(spacing());
        if (go(2 * aimed, h_mm(), site_.level(), progress_))
            progress_.report(StepKind::slide, site_);
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

    /// Where the normal does not show a way: of 52 directions the one in which a small step leads
    /// closest, and along it as far as a voxel. Takes as much of the budget as it has directions,
    /// for that is its work.
    bool look_round() {
        constexpr double step = 1e-3;  // [voxel]
        constexpr int directions = 52;
        if (progress_.budget <= directions) {
            progress_.budget = 0;
            return true;
        }
        const Vec3 h = h_mm();
        const CubicSite start = site_;
        Vec3 best = Vec3::Zero();
        double least = distance() - 1e-3 * step * shortest_;
        progress_.budget -= directions;
        Progress unseen{progress_.geometry, {}, progress_.target, progress_.budget};
        for (int i = 0; i < 125; ++i) {
            const Vec3 axes(i % 5 - 2, i / 5 % 5 - 2, i / 25 - 2);
            if (dot(axes, h) <= 0) continue;
            if (std::abs(axes[0]) + std::abs(axes[1]) + std::abs(axes[2]) == 6) continue;
            const Vec3 v = axes * (shortest_ / std::sqrt(dot(axes, axes)));
            site_.return_to(start);
            if (!go(step * v, h, site_.slide_level(), unseen)) continue;
            const double after = distance();
            if (after >= least) continue;
            least = after;
            best = v;
        }
        site_.return_to(start);
        if (best.isZero(0)) return false;
        go(best, h, site_.slide_level(), progress_);
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
    const Rest rest = CubicDescent(update.site, update.progress, settings.friction, proxy).run();
    if (rest == Rest::at_target) proxy.sliding = false;
    return finish_update(proxy, update, hip, rest);
}

}  // namespace palpate
