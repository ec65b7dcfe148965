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

/// The surface at a point in contact, in folded millimetres, and where the target lies from there:
/// at aside * along - depth * normal.
struct Contact {
    Vec3 normal;   ///< unit, out of the solid
    Vec3 along;    ///< unit, in the tangent plane towards the target
    double depth;  ///< of the target below the tangent plane, > 0 when pressing
    double aside;  ///< the target's distance from the normal

    Vec3 across() const {
        const Vec3 &n = normal, &t = along;
        return {n[1] * t[2] - n[2] * t[1], n[2] * t[0] - n[0] * t[2], n[0] * t[1] - n[1] * t[0]};
    }
};

/// The surface's curvature in the tangent plane [1/mm], > 0 where it rises towards the free side:
/// a matrix for displacements along the contact's `along` and `across`, and its eigenvalues.
struct Curvature {
    double tt, ta, aa;
    double greatest, least;
    double per_apart;  ///< 1 / (greatest - least); 0 if they are the same
};

/// `each` is 1 / slope of the field, in the unit of the Hessian; `t` and `a` are folded `along` and
/// `across` in voxels.
Curvature curvature_of(const cubic::Symmetric& hessian, const Vec3& t, const Vec3& a, double each) {
    const Vec3 ht = hessian * t;
    const double tt = each * dot(ht, t), ta = each * dot(ht, a), aa = each * dot(hessian * a, a);
    const double mean = 0.5 * (tt + aa), half = 0.5 * (tt - aa);
    const double radius = std::sqrt(half * half + ta * ta);
    return {tt, ta, aa, mean + radius, mean - radius, radius > 1e-100 ? 0.5 / radius : 0};
}

/// Where the target's foot lies along the surface, by its curvature: in the tangent plane [mm].
struct Foot {
    double along, across;
    double rise;  ///< twice the height of the surface above the tangent plane there [mm]

    double squared() const { return along * along + across * across; }
};

/// From the displacements [mm] along the principal directions of the greatest and the least
/// curvature.
Foot foot_of(const Curvature& k, double at_greatest, double at_least, double longest) {
    // Of a function of a symmetric matrix only its values at the two eigenvalues matter.
    const double rate = (at_greatest - at_least) * k.per_apart;
    Foot foot{at_greatest + rate * (k.tt - k.greatest), rate * k.ta, 0};
    const double squared = foot.squared();
    if (squared > longest * longest) {
        const double share = longest / std::sqrt(squared);
        foot.along *= share;
        foot.across *= share;
    }
    foot.rise = (k.tt * foot.along + 2 * k.ta * foot.across) * foot.along +
                k.aa * foot.across * foot.across;
    return foot;
}

/// Where a slide goes, and where the fall after it is aimed. A curvature that brings the target's
/// depth near its centre (or past it) is cut: along each principal direction a slide is as long as
/// on a plane at most, an aim 2.5 times that.
struct Feet {
    Foot slide, aim;
};

Feet feet_of(const Contact& c, const Curvature& k, double longest_aim) {
    const double greatest = 1 + c.depth * k.greatest, least = 1 + c.depth * k.least;
    const double at_greatest = c.aside / std::max(greatest, 0.4);
    const double at_least = c.aside / std::max(least, 0.4);
    return {foot_of(k, greatest > 1 ? at_greatest : c.aside, least > 1 ? at_least : c.aside, far),
            foot_of(k, at_greatest, at_least, longest_aim)};
}

/// An update that is under way.
class CubicDescent {
  public:
    CubicDescent(CubicSite& site, Progress& progress, const ProxySettings& settings, Proxy& proxy)
        : site_(site),
          progress_(progress),
          settings_(settings),
          proxy_(proxy),
          hip_(progress.target),
          range_(site.range),
          shortest_(progress.geometry.spacing.minCoeff()),
          friction_pending_(has_friction(settings.friction) || has_friction(settings.behind)),
          frame_(look()) {}

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

    /// The target and lengths as the site's tetrahedron sees them. Mostly the next moves stay in
    /// it.
    struct Frame {
        int number;
        Vec3 target;      ///< from the cube's centre, folded [voxel]
        Vec3 mm, per_mm;  ///< of a voxel along each axis, and the inverse
    };
    Frame look() const {
        const Tetrahedron& t = site_.point.tetrahedron;
        return {site_.frame, fold(t, site_.from_sample(progress_.target)),
                fold_lengths(t, progress_.geometry.spacing),
                fold_lengths(t, site_.field.voxels_per_mm())};
    }
    const Frame& frame() {
        if (frame_.number != site_.frame) frame_ = look();
        return frame_;
    }
    void set_target(const Vec3& index) {
        progress_.target = index;
        frame_ = look();
    }

    // Vectors are folded, in millimetres. A walk changes the frame.
    Vec3 h_mm() {
        const Frame& f = frame();
        return (f.target - site_.point.folded).cwiseProduct(f.mm);
    }
    const Vec3& per_mm() { return frame().per_mm; }

    /// One round: a straight motion through free space, or a slide and a fall. `h` leads to the
    /// target.
    End move(const Vec3& h, int failures) {
        if (!site_.in_contact()) return fall_to_target();
        const Vec3& per = per_mm();
        const Vec3 g = site_.here().gradient.cwiseProduct(per);
        const double along = dot(g, h);
        if (along <= 0) return fall_to_target();
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
        // At rest above less than this: here both roots have at least eight digits.
        const double slope = std::sqrt(squared), aside_root = std::sqrt(aside);
        const double each = 1 / slope;
        Contact c;
        c.normal = g * -each;
        c.depth = along * each;
        c.aside = aside_root * each;
        c.along = (h + c.depth * c.normal) * (slope / aside_root);
        if (friction_pending_) {
            friction_pending_ = false;
            return apply_friction(c) ? End::target_changed : End::at_rest;
        }
        slide(h, c, each, failures);
        return End::moved;
    }

    End fall_to_target() {
        const Vec3 to_target = frame().target - site_.point.folded;
        const WalkEnd end = walk(site_, to_target, site_.level(), progress_);
        progress_.report(StepKind::free_move, site_);
        if (end != WalkEnd::target) return End::moved;
        if (progress_.target == hip_) return End::at_target;
        // Friction moved the target back to a point in free space, where there is no friction.
        set_target(hip_);
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
    void slide(const Vec3& h, const Contact& c, double each, int failures) {
        const Vec3 across = c.across();
        const Vec3& per = per_mm();
        const Curvature k = curvature_of(site_.here().hessian, c.along.cwiseProduct(per),
                                         across.cwiseProduct(per), each);
        const double shrink = 1.0 / (1 << (2 * failures));
        const auto [step, aim] = feet_of(c, k, shortest_);
        double lift = 0.55 * shrink * shrink * std::max(0.0, step.rise);
        if (failures > 0) lift += 0.05 * failures * shrink * std::sqrt(step.squared());
        const auto place = [&](const Foot& foot, double height) -> Vec3 {
            return (shrink * foot.along) * c.along + (shrink * foot.across) * across +
                   height * c.normal;
        };
        const Vec3 from_foot = h - place(aim, 0.5 * shrink * shrink * aim.rise);
        const int number = site_.frame;
        const Tetrahedron before = site_.point.tetrahedron;
        if (!go(place(step, lift), h, site_.slide_level(), progress_)) return;
        progress_.report(StepKind::slide, site_);
        if (site_.in_contact()) return;
        const Vec3 left = h_mm();
        // Aim past the foot, in case the surface lies lower.
        const Vec3 to_foot = left - (site_.frame == number ? from_foot
                                                           : fold(site_.point.tetrahedron,
                                                                  unfold(before, from_foot)));
        if (go(2 * to_foot, left, site_.level(), progress_)) {
            progress_.report(StepKind::slide, site_);
        }
    }

    /// Moves the target back against the direction in which the SCP would slide, so that the SCP
    /// ends up trailing the hand at the friction angle. False if the SCP sticks.
    bool apply_friction(const Contact& c) {
        const Friction& friction = site_.turned ? settings_.behind : settings_.friction;
        const double mu =
            proxy_.sliding ? friction.dynamic_coefficient : friction.static_coefficient;
        proxy_.sliding = c.aside > mu * c.depth;
        if (!proxy_.sliding) return false;
        const double back = std::min(c.aside, friction.dynamic_coefficient * c.depth);
        set_target(progress_.target -
                   unfold(site_.point.tetrahedron, (back * c.along).cwiseProduct(per_mm())));
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
        double least = std::sqrt(dot(h, h)) - 1e-3 * step * shortest_;
        progress_.budget -= directions;
        Progress unseen{progress_.geometry, {}, progress_.target, progress_.budget};
        for (int i = 0; i < 125; ++i) {
            const Vec3 axes(i % 5 - 2, i / 5 % 5 - 2, i / 25 - 2);
            if (dot(axes, h) <= 0) continue;
            if (std::abs(axes[0]) + std::abs(axes[1]) + std::abs(axes[2]) == 6) continue;
            const Vec3 v = axes * (shortest_ / std::sqrt(dot(axes, axes)));
            site_.return_to(start);
            if (!go(step * v, h, site_.slide_level(), unseen)) continue;
            const Vec3 left = h_mm();
            const double after = std::sqrt(dot(left, left));
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
    const ProxySettings& settings_;
    Proxy& proxy_;
    const Vec3 hip_;
    const double range_;     // scaled like the site's excess
    const double shortest_;  // spacing [mm]
    bool friction_pending_;
    Frame frame_;
};

}  // namespace

ProxyUpdate update_cubic(Proxy& proxy, const Field& field, const Vec3& hip,
                         const ProxySettings& settings, StepObserver observer) {
    const Vec3 target = index_from_physical(field.geometry(), hip);
    if (!accepts(proxy, field, target)) return refuse_update(proxy, field, hip);
    Update<CubicSite> update(proxy, field, target, settings, observer);
    if (update.recovering) return finish_update(proxy, update, hip, Rest::recovering);
    const Rest rest = CubicDescent(update.site, update.progress, settings, proxy).run();
    if (rest == Rest::at_target) proxy.sliding = false;
    return finish_update(proxy, update, hip, rest);
}

}  // namespace palpate
