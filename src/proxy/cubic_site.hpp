// The proxy's place while an update on the smooth field runs, and certified straight motion there.
// The Bernstein coefficients of the field along a segment bound it, so no crossing is missed
// (docs/smooth.md).
#pragma once

#include <array>
#include <limits>

#include "proxy/site.hpp"

namespace palpate {

/// A lattice point of the smooth field with the cubic of its tetrahedron. Its excess, sign * (f -
/// isovalue) times cubic::scale, is computed from differences to the isovalue, so it has all its
/// digits however far the data lie from zero.
struct CubicSite : BoundPoint {
    CubicSite(const Field& f, double level, double s, const LatticePoint& at);
    /// The proxy, at a point, with what its last update kept.
    CubicSite(const Proxy& proxy, const Field& f, const LatticePoint& at);

    double range;    // of the field, scaled like the excess
    int frame = 0;   // another number for each tetrahedron that it comes to
    KeptPiece kept;  // its `most` is that of the point's cube; its piece may be another's

    /// Of a step through a tetrahedron, at most: with its piece, and samples that are gathered.
    static int work_of_step(const Field& f) { return 2 + f.work_of_samples(); }
    /// What it has cost beside steps, since this was asked last.
    int take_work() { return std::exchange(pieces, 0) + take_gathering(); }
    int take_gathering() { return std::exchange(gathered.work, 0); }

    static CubicSite of(const Proxy& proxy, const Field& f, const LatticePoint& at) {
        return {proxy, f, at};
    }
    void keep(Proxy& proxy);

    static LatticePoint located(const Vec3& index) { return cubic::locate(index); }
    Vec3 index() const { return cubic::index_of(point); }
    /// As it is felt [data units].
    double density();
    /// The excess at the point.
    const cubic::Expansion& here() {
        if (!expanded) expand();
        return at_point;
    }
    double excess() { return here().value; }
    /// The excess up to which a point is free. It lies a hair above 0, so that a plateau at the
    /// isovalue is free; slides have a little more room than falls, so that a slide along the
    /// surface on which a fall ended is not blocked.
    double level() const { return 1e-11 * range; }
    double slide_level() const { return 1.2e-11 * range; }
    bool is_inside() { return reaches(2e-11 * range) && excess() > 2e-11 * range; }
    bool is_beyond_behind() { return is_layer() && excess() < -thickness - 2e-11 * range; }
    bool in_contact() { return reaches(0.95e-11 * range) && excess() >= 0.95e-11 * range; }
    /// False if nothing in the cube lies above the level.
    bool reaches(double at) const { return kept.most > at; }
    bool reaches_behind() const { return room < -level(); }
    void turn();
    void move_to(const LatticePoint& at);
    /// Back to where a copy of this site was made, without the work of move_to().
    void return_to(const CubicSite& before);
    /// A point in index space, seen from the cube's centre, index axes [voxel].
    Vec3 from_sample(const Vec3& index) const {
        const Index3& cell = point.tetrahedron.cell;
        return {index[0] - cell[0], index[1] - cell[1], index[2] - cell[2]};
    }
    /// The vector to such a point, folded [voxel].
    Vec3 folded_to(const Vec3& index) const {
        return fold(point.tetrahedron, from_sample(index)) - point.folded;
    }

    /// Goes to the end of a step (folded) inside the tetrahedron, on the walls of the mask.
    void jump(const Vec3& step, unsigned walls) {
        point.folded = snap(point.folded + step, walls);
        expanded = false;
    }
    /// The same, as far as the excess certainly stays below the level, and in a layer above the
    /// level behind. Returns which part of it. Where that ends at the level behind, the site turns.
    double advance(const Vec3& step, double level, unsigned walls);
    /// Same point, seen from across the wall that it is on.
    void cross(unsigned wall);

  private:
    template <class Visit>
    auto visit_cube(Visit&& visit) {
        return field.visit_around(point.tetrahedron.cell, visit, gathered);
    }
    /// Finds `most` and, in a layer, `room`.
    void look_at_cube();
    /// Piece and expansion at the point.
    void expand();
    void make_piece();

    cubic::Expansion at_point;
    // By how much the lowest sample of the point's cube lies above the level behind.
    double room = std::numeric_limits<double>::infinity();
    Field::Gathered gathered;  // at the cube
    int pieces = 0;            // made
    bool made = false;         // `kept.piece` is that of the point's tetrahedron
    bool expanded = false;     // `at_point` is that at the point
    bool kept_is_new = false;  // not what the proxy has
};

/// Goes straight along `displacement` (folded, voxel) to its end, or until the excess would rise
/// above `level`; a start above it may not rise either. The path never exceeds the level by more
/// than rounding.
WalkEnd walk(CubicSite& site, const Vec3& displacement, double level, Progress& progress);

inline WalkEnd walk_to(CubicSite& site, const Vec3& index, Progress& progress) {
    return walk(site, site.folded_to(index), site.level(), progress);
}

inline WalkEnd walk_out(CubicSite& turned, const Vec3& displacement, Progress& progress) {
    return walk(turned, fold(turned.point.tetrahedron, displacement), -turned.level(), progress);
}

/// The end of the longest part [0, t] of [0, 1] on which a cubic with these Bernstein coefficients
/// is certainly not above 0; the first is not above 0. It ends within `tolerance` of 0 or at 1.
double certified_part(const std::array<double, 4>& bernstein, double tolerance);

}  // namespace palpate
