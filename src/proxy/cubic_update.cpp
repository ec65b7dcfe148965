// The proxy on the smooth field: where the surface has one plane at each of its points, the proxy
// slides along it, curvature included, and falls back onto it (docs/smooth.md).
#include <algorithm>
#include <cmath>

#include "proxy/update.hpp"

namespace palpate {
namespace {

/// Tangential distance to the target, relative to its depth, below which the proxy rests.
constexpr double resting_slope = 1e-4;
/// The same limit in voxels of the smallest spacing.
constexpr double least_distance = 1e-7;
/// Below this slope [range / voxel] the normal gives no direction.
constexpr double least_slope = 1e-5;
/// Bend across the way to the target, relative to the way, above which the target's foot lies in
/// another direction.
constexpr double least_twist = 0.1;
/// Gain, relative to the squared distance to the target, below which a round counts as a failure.
/// If the proxy does not rest, a slide can gain ten times that.
constexpr double least_progress = 1e-9;
/// Attempts before the proxy tries all directions.
constexpr int most_failures = 6;

/// Whether the `i`-th of 125 places around a point is a direction of its own: places with three
/// even axes are twice another one.
constexpr bool is_direction(int i) {
    return i % 5 % 2 == 1 || i / 5 % 5 % 2 == 1 || i / 25 % 2 == 1;
}
constexpr int count_of_directions() {
    int count = 0;
    for (int i = 0; i < 125; ++i) count += is_direction(i);
    return count;
}

/// The tangent plane of the surface through a point, and where the target lies from it. Folded
/// vectors in millimetres; heights are times the slope, so that none of this needs a root.
struct Contact {
    Vec3 slope;          ///< gradient of the excess, into the solid [1/mm]
    double per_squared;  ///< 1 / slope^2
    double depth;        ///< of the target below the plane, over the slope; > 0 when pressing
    Vec3 aside;          ///< from the point to the target, in the plane
    double aside_squared;

    /// `h` leads to the target, `into` is slope . h.
    Contact(const Vec3& slope, const Vec3& h, double into)
        : slope(slope),
          per_squared(1 / dot(slope, slope)),
          depth(into * per_squared),
          aside(h - depth * slope),
          aside_squared(dot(aside, aside)) {}

    /// A step in the plane, and a height above it.
    Vec3 raised(const Vec3& in_plane, double height) const {
        return in_plane - (height * per_squared) * slope;
    }
};

/// The same, with the bend of the surface on the way aside.
struct BentContact : Contact {
    Vec3 turn;    ///< of the slope along `aside`
    double bend;  ///< turn . aside; > 0 where the surface rises towards the free side

    BentContact(const Contact& contact, const cubic::Symmetric& hessian, const Vec3& per_mm)
        : Contact(contact),
          turn((hessian * aside.cwiseProduct(per_mm)).cwiseProduct(per_mm)),
          bend(dot(turn, aside)) {}

    /// The part of `aside` at whose end the target's foot lies, if the surface bends everywhere as
    /// it does along it; where the target comes near the centre of curvature, 1 / `least` at most.
    double to_foot(double least) const {
        if (!(aside_squared > 0)) return 0;
        return aside_squared / std::max(aside_squared + depth * bend, least * aside_squared);
    }
    bool is_twisted() const {
        const double into = dot(turn, slope);
        const double in_plane = dot(turn, turn) - into * into * per_squared;
        return depth * depth * (in_plane * aside_squared - bend * bend) >
               least_twist * least_twist * aside_squared * aside_squared;
    }
};

/// A step in the tangent plane to where the target's foot lies along the surface, but no longer
/// than on a plane.
struct Slide {
    Vec3 step;
    double rise;  ///< twice the height of the surface above its end, times the slope
};

Slide slide_aside(const BentContact& c) {
    const double part = c.to_foot(1);
    return {part * c.aside, part * part * c.bend};
}

/// By the curvatures in both principal directions.
Slide slide_by_both(const BentContact& c, const cubic::Symmetric& hessian, const Vec3& per_mm) {
    const double length = std::sqrt(c.aside_squared);
    const Vec3 n = c.slope * std::sqrt(c.per_squared), t = c.aside / length;
    const Vec3 across(n[1] * t[2] - n[2] * t[1], n[2] * t[0] - n[0] * t[2],
                      n[0] * t[1] - n[1] * t[0]);
    const Vec3 a = across.cwiseProduct(per_mm);
    // The bend as a matrix for steps along t and across, and its eigenvalues.
    const double tt = c.bend / c.aside_squared, ta = dot(c.turn, across) / length,
                 aa = dot(hessian * a, a);
    const double mean = 0.5 * (tt + aa), half = 0.5 * (tt - aa);
    const double radius = std::sqrt(half * half + ta * ta);
    const double greatest = mean + radius, least = mean - radius;
    const double at_greatest = length / std::max(1 + c.depth * greatest, 1.0);
    const double at_least = length / std::max(1 + c.depth * least, 1.0);
    // A function of a symmetric matrix depends on its values at the two eigenvalues only.
    const double rate = radius > 0 ? 0.5 * (at_greatest - at_least) / radius : 0;
    const double forth = at_greatest + rate * (tt - greatest), sideways = rate * ta;
    return {forth * t + sideways * across,
            (tt * forth + 2 * ta * sideways) * forth + aa * sideways * sideways};
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
            if (end == End::landed) {
                before = after;
                continue;
            }
            const bool closer = after < (1 - least_progress) * before;
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
    /// A landing need not gain anything; whether its slide did is known afterwards.
    enum class End { moved, landed, at_target, at_rest, target_changed };

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
    /// Scale of the tetrahedron for which h_mm() was called last.
    const Vec3& per_mm() const { return frame_.per_mm; }

    /// One round: a straight motion through free space, or a slide and a fall. `h` leads to the
    /// target.
    End move(const Vec3& h, int failures) {
        if (!site_.in_contact()) {
            const End end = fall_to_target();
            return end == End::moved ? End::landed : end;
        }
        const Vec3 slope = site_.here().gradient.cwiseProduct(per_mm());
        const double into = dot(slope, h);
        if (into <= 0) return fall_to_target();
        const Contact c(slope, h, into);
        if (is_resting(c, into)) {
            return is_flat(slope) && look_round() ? End::moved : End::at_rest;
        }
        if (friction_pending_) {
            friction_pending_ = false;
            return apply_friction(c) ? End::target_changed : End::at_rest;
        }
        progress_.charge(1);
        slide(h, BentContact(c, site_.here().hessian, per_mm()), failures);
        return End::moved;
    }

    bool is_resting(const Contact& c, double into) const {
        const double least = least_distance * shortest_;
        return !(c.aside_squared >
                 std::max(resting_slope * resting_slope * c.depth * into, least * least));
    }

    /// Whether the gradient is too small to give a direction.
    bool is_flat(const Vec3& slope) const {
        const double flat = least_slope * range_ / shortest_;
        return !(dot(slope, slope) > flat * flat);
    }

    End fall_to_target() {
        const Vec3 to_target = frame().target - site_.point.folded;
        const WalkEnd end = walk(site_, to_target, site_.level(), progress_);
        progress_.report(StepKind::free_move, site_);
        if (end != WalkEnd::target) return End::moved;
        if (progress_.target == hip_) {
            proxy_.sliding = false;
            return End::at_target;
        }
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
        walk(site_, v_mm.cwiseProduct(frame().per_mm), level, progress);
        return true;
    }

    /// Along the tangent plane, lifted where the surface rises, and from there down to the target's
    /// foot. After failures shorter and higher.
    void slide(const Vec3& h, const BentContact& c, int failures) {
        const bool by_both = failures > 0 || c.is_twisted();
        Slide s = by_both ? slide_by_both(c, site_.here().hessian, per_mm()) : slide_aside(c);
        double lift = 0.55 * std::max(0.0, s.rise);
        double shrink = 1;
        if (failures > 0) {
            shrink /= 1 << (2 * failures);
            s.step *= shrink;
            lift = shrink * shrink * lift +
                   0.05 * failures * std::sqrt(dot(s.step, s.step) / c.per_squared);
        }
        if (!go(c.raised(s.step, lift), h, site_.slide_level(), progress_)) return;
        progress_.report(StepKind::slide, site_);
        while (!site_.in_contact() && fall_to_foot(shrink)) {
        }
    }

    /// From above the surface down to the target's foot on it, or to a part of the way there: where
    /// a slide crosses walls, only the curvature at its end says where that is. A crest may hide
    /// the foot. Then the motion passes over the crest, and the result is true.
    bool fall_to_foot(double shrink) {
        progress_.charge(1);
        const Vec3 h = h_mm();
        const cubic::Expansion& here = site_.here();
        const Vec3 slope = here.gradient.cwiseProduct(per_mm());
        const double into = dot(slope, h);
        Vec3 to_foot = h;
        bool passes = false;
        if (into > 0 && !is_flat(slope)) {
            const BentContact c(Contact(slope, h, into), here.hessian, per_mm());
            double part = shrink * c.to_foot(0.4);
            if (part * part * c.aside_squared > shortest_ * shortest_) {
                part = shortest_ / std::sqrt(c.aside_squared);
            }
            double down = here.value + 0.5 * part * part * c.bend;
            passes = part * part * c.bend < 2 * here.value && !is_resting(c, into);
            if (passes) {
                // Along the tangent to the crest (2 times the height), but a little above it.
                part = std::sqrt(2 * here.value / c.bend);
                down = 1.6 * here.value;
            }
            to_foot = c.raised(part * c.aside, down);
        }
        // Aim past the foot, in case the surface lies lower.
        if (!go(2 * to_foot, h, site_.level(), progress_)) return false;
        progress_.report(StepKind::slide, site_);
        return passes && progress_.budget > 0;
    }

    /// Moves the target back against the direction in which the SCP would slide, so that the SCP
    /// ends up trailing the hand at the friction angle. False if the SCP sticks.
    bool apply_friction(const Contact& c) {
        const Friction& friction = site_.turned ? settings_.behind : settings_.friction;
        const auto share = held_share(friction, proxy_, std::sqrt(c.aside_squared),
                                      c.depth / std::sqrt(c.per_squared));
        if (!share) return false;
        set_target(progress_.target -
                   unfold(site_.point.tetrahedron, (*share * c.aside).cwiseProduct(per_mm())));
        return true;
    }

    /// If the normal gives no direction: tries 49 directions with a small step, and follows the
    /// best one for up to a voxel. One update tries all of them or none.
    bool look_round() {
        constexpr double step = 1e-3;  // [voxel]
        constexpr int directions = 49;
        static_assert(count_of_directions() == 2 * directions, "half of them lead closer");
        progress_.budget -= directions;
        const Vec3 h = h_mm();
        const CubicSite start = site_;
        Vec3 best = Vec3::Zero();
        double least = std::sqrt(dot(h, h)) - 1e-3 * step * shortest_;
        Progress unseen{progress_.geometry, {}, progress_.target, progress_.budget};
        for (int i = 0; i < 125; ++i) {
            const Vec3 axes(i % 5 - 2, i / 5 % 5 - 2, i / 25 - 2);
            if (!is_direction(i) || dot(axes, h) <= 0) continue;
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
        progress_.budget = unseen.budget;
        if (unseen.budget <= 0) return true;
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
    return update_by<CubicSite>(proxy, field, hip, settings, observer,
                                [&](CubicSite& site, Progress& progress) {
                                    return CubicDescent(site, progress, settings, proxy).run();
                                });
}

}  // namespace palpate
