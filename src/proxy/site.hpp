// Where the proxy is while an update runs: a lattice point with its tetrahedron's field at hand,
// and the straight walk from tetrahedron to tetrahedron that every method uses.
#pragma once

#include "palpate/proxy.hpp"

namespace palpate {

/// A lattice point, the samples of its cell and the excess field of its tetrahedron:
/// excess(u) = sign * (f(u) - isovalue), > 0 in the solid.
struct Site {
    Site(const Field& field, double isovalue, double sign, const LatticePoint& at);

    const Field& field;
    double isovalue;
    double sign;
    LatticePoint point;
    CellSamples samples;
    LinearPiece excess;

    double excess_here() const { return excess(point.folded); }
    /// Continues from another point.
    void move_to(const LatticePoint& at);
    /// Same point, another of its incident tetrahedra.
    void enter(const Tetrahedron& tetrahedron);
    /// Same point, seen from across the wall that it is on.
    void cross(unsigned wall);
    /// The excess field of an incident tetrahedron.
    LinearPiece excess_in(const Tetrahedron& tetrahedron) const;

  private:
    LinearPiece excess_from(const Tetrahedron& tetrahedron, const CellSamples& cell) const;
};

/// Where an update goes and what it may still spend.
struct Course {
    const Geometry& geometry;
    StepObserver observer;
    Vec3 target;         ///< index space
    int budget;          ///< straight pieces left
    int tetrahedra = 0;  ///< pieces with a length

    /// The way from the site to the target, index axes [voxel].
    Vec3 to_target(const Site& site) const;
    void report(StepKind kind, const Site& site) const {
        if (observer.on_step) report_to_observer(kind, site, target);
    }
    void report(StepKind kind, const Site& site, const Vec3& goal) const {
        if (observer.on_step) report_to_observer(kind, site, goal);
    }

  private:
    void report_to_observer(StepKind kind, const Site& site, const Vec3& goal_index) const;
};

enum class WalkEnd { target, surface, out_of_budget };

/// Walks straight along `displacement` (index axes, voxel) through as many tetrahedra as needed,
/// until its end or until the excess field would rise above zero.
WalkEnd walk(Site& site, const Vec3& displacement, Course& course);

/// Moves inside the site's tetrahedron along `step` (folded, voxel), at most to its end or to a
/// wall that the point is not on yet. `walls` are held exactly. True if the end was reached.
bool slide(Site& site, const Vec3& step, unsigned walls, Course& course);

}  // namespace palpate
