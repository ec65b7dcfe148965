// The proxy's place while an update runs (a lattice point with its tetrahedron's linear field),
// and the straight walk from tetrahedron to tetrahedron that every method uses.
#pragma once

#include <algorithm>
#include <bit>
#include <limits>
#include <utility>

#include "palpate/proxy.hpp"
#include "proxy/cone.hpp"
#include "proxy/straight.hpp"

namespace palpate {

/// What sites of both fields have: a lattice point, and the levels that bound it, less the field's
/// offset. The excess, sign * (f - isovalue), is > 0 in the solid. Of a layer (Proxy::behind) it
/// stays above -thickness; a site that is turned looks at it from the other side.
struct BoundPoint {
    const Field& field;
    double isovalue;
    double sign;
    LatticePoint point;
    double behind = 0;
    double thickness = std::numeric_limits<double>::infinity();  // in the excess's units
    bool turned = false;

    BoundPoint(const Field& f, double level, double s, const LatticePoint& at)
        : field(f), isovalue(level), sign(s), point(at) {}

    bool is_layer() const { return thickness < std::numeric_limits<double>::infinity(); }
    /// Keeps the point on the solid side of a proxy's second level, towards which it may be turned.
    void bound_by(const Proxy& proxy, double scale) {
        if (!proxy.behind) return;
        isovalue = field.within_reach(isovalue);
        behind = field.within_reach(*proxy.behind - field.offset());
        thickness = scale * std::max(0.0, sign * (isovalue - behind));
        if (proxy.turned) exchange_levels();
    }
    void exchange_levels() {
        std::swap(isovalue, behind);
        sign = -sign;
        turned = !turned;
    }
};

/// One with the samples of its cell and the linear field of its tetrahedron, both less the field's
/// offset.
struct Site : BoundPoint {
    Site(const Field& f, double level, double s, const LatticePoint& at)
        : BoundPoint{f, level, s, at},
          samples(f.cell(at.tetrahedron.cell)),
          piece(piece_of(at.tetrahedron, samples)) {}

    CellSamples samples;
    LinearPiece piece;

    /// Of a step through a tetrahedron, at most.
    static int work_of_step(const Field&) { return 1; }
    static int take_work() { return 0; }
    /// The proxy, at a point, and what an update keeps of it for the next one: nothing.
    static Site of(const Proxy& proxy, const Field& f, const LatticePoint& at) {
        Site site{f, proxy.isovalue - f.offset(), f.sign(), at};
        site.bound_by(proxy, 1);
        return site;
    }
    void turn() { exchange_levels(); }
    void keep(Proxy&) const {}

    static LatticePoint located(const Vec3& index) { return locate(index); }
    Vec3 index() const { return index_of(point); }
    /// As it is felt, offset included [data units].
    double density() const { return field.with_offset(piece(point.folded)); }
    double excess() const { return sign * (piece(point.folded) - isovalue); }
    /// The excess up to which a point is free.
    double level() const { return 0; }
    bool is_inside() const { return excess() > field.tolerance(); }
    bool is_beyond_behind() const { return excess() < -thickness - field.tolerance(); }
    bool in_contact() const { return excess() >= -field.tolerance(); }
    /// The vector to a point in index space, folded [voxel].
    Vec3 folded_to(const Vec3& to) const {
        const Tetrahedron& t = point.tetrahedron;
        const Vec3 from_centre((to[0] - t.cell[0]) - 0.5, (to[1] - t.cell[1]) - 0.5,
                               (to[2] - t.cell[2]) - 0.5);
        return fold(t, from_centre) - point.folded;
    }
    /// Rate of the excess along a folded direction.
    double slope(const Vec3& folded) const { return sign * dot(piece.gradient, folded); }
    /// Gradient of the excess [data units / voxel], folded, in an incident tetrahedron.
    Vec3 excess_gradient_in(const Tetrahedron& t) const {
        if (t.cell == point.tetrahedron.cell) return sign * piece_of(t, samples).gradient;
        return sign * piece_of(t, field.cell(t.cell)).gradient;
    }
    /// Moves to another point.
    void move_to(const LatticePoint& at) {
        point = at;
        samples = field.cell(at.tetrahedron.cell);
        piece = piece_of(at.tetrahedron, samples);
    }
    /// Same point, another of its incident tetrahedra.
    void enter(const Tetrahedron& t) {
        if (t.cell != point.tetrahedron.cell) samples = field.cell(t.cell);
        point.tetrahedron = t;
        piece = piece_of(t, samples);
    }
    /// Same point, seen from across the wall that it is on.
    void cross(unsigned wall) {
        point.tetrahedron = across(point.tetrahedron, wall);
        if (wall == wall_face) samples = field.cell(point.tetrahedron.cell);
        piece = piece_of(point.tetrahedron, samples);
    }
};

/// What an update heads for, what it may still spend, and what it has done.
struct Progress {
    const Geometry& geometry;
    StepObserver observer;
    Vec3 target;         ///< index space
    int budget;          ///< work left, see ProxySettings
    int tetrahedra = 0;  ///< pieces of non-zero length so far
    /// A walk may end at the first wall at which less than this part of its displacement is left
    /// (none if below 0). Up to there it is the same to the bit.
    double least_left = -1;

    /// Spends on what a motion needs beside its pieces. The first piece of the motion is left, so
    /// that every update gets on.
    void charge(int work) {
        if (budget > 1) budget = std::max(1, budget - work);
    }
    /// The vector from the site to the target, index axes [voxel].
    Vec3 to_target(const Site& site) const {
        return unfold(site.point.tetrahedron, folded_to_target(site));
    }
    /// The same in the site's frame.
    Vec3 folded_to_target(const Site& site) const { return site.folded_to(target); }
    template <class AnySite>
    void report(StepKind kind, const AnySite& site) const {
        report(kind, site, target);
    }
    template <class AnySite>
    void report(StepKind kind, const AnySite& site, const Vec3& goal) const {
        if (!observer.on_step) return;
        report_to_observer(kind, site.index(), site.point.tetrahedron, goal);
    }

  private:
    void report_to_observer(StepKind kind, const Vec3& index, const Tetrahedron& tetrahedron,
                            const Vec3& goal_index) const;
};

/// The cone of the walls that a point is on, in folded millimetres; more half-spaces may be added.
struct WalledCone {
    WalledCone(unsigned on, const Vec3& voxels_per_mm) {
        for (unsigned w = 0; w < wall_count; ++w) {
            if (!has(on, w)) continue;
            wall_of[half_spaces.count] = w;
            half_spaces.add(wall_normal(w).cwiseProduct(voxels_per_mm));
        }
        walls = half_spaces.count;
    }
    /// Mask of the walls that a projection was put on.
    unsigned walls_of(const ConeProjection& projection) const {
        unsigned mask = 0;
        for (const int a : projection.active) {
            if (a >= 0 && a < walls) mask |= 1U << wall_of[a];
        }
        return mask;
    }

    HalfSpaces<4> half_spaces;
    std::array<unsigned, 4> wall_of;
    int walls = 0;
};

/// Visits the tetrahedra that contain a point, its own first, until `visit` returns true.
template <class Visit>
void for_each_incident(const LatticePoint& point, Visit&& visit) {
    const unsigned on = walls_at(point.folded);
    if (visit(point.tetrahedron) || on == 0) return;
    const auto first = static_cast<unsigned>(std::countr_zero(on));
    const unsigned but_first = on & (on - 1);
    if ((but_first & (but_first - 1)) != 0) {
        const Incident incident = incident_tetrahedra(point);
        for (int i = 1; i < incident.count; ++i) {
            if (visit(incident.tetrahedra[i])) return;
        }
        return;
    }
    // Round an edge its two mirrors take turns; a single wall has one other side.
    const auto second = static_cast<unsigned>(std::bit_width(on) - 1);
    Tetrahedron t = across(point.tetrahedron, first);
    for (unsigned next = second; !same_tetrahedron(t, point.tetrahedron);
         next = next == first ? second : first) {
        if (visit(t)) return;
        t = across(t, next);
    }
}

/// What walks of a point have in common on both fields.
struct PointCourse {
    Progress& progress;

    bool spend() { return progress.budget-- > 0; }
    bool is_enough(double left) const { return left < progress.least_left; }
};

/// Walks straight along `displacement` (folded, voxel) through as many tetrahedra as needed,
/// until its end or until the excess field would rise above zero.
WalkEnd walk(Site& site, const Vec3& displacement, Progress& progress);

/// Moves inside the site's tetrahedron along `step` (folded, voxel), at most to its end or to a
/// wall other than those that the point is `on`. `walls` are held exactly. True if the end was
/// reached.
bool slide(Site& site, const Vec3& step, unsigned on, unsigned walls, Progress& progress);

/// The same to a point in index space, from the free side.
inline WalkEnd walk_to(Site& site, const Vec3& index, Progress& progress) {
    return walk(site, site.folded_to(index), progress);
}

/// Walks a turned site along `displacement` (index axes, voxel) until it leaves what is its free
/// side and the other's solid.
inline WalkEnd walk_out(Site& turned, const Vec3& displacement, Progress& progress) {
    return walk(turned, fold(turned.point.tetrahedron, displacement), progress);
}

}  // namespace palpate
