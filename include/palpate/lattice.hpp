// Stage 5, lattice: every cell is cut into 24 tetrahedra with a linear field in each (Corenthy et
// al. 2012, section 3). Nothing is stored per tetrahedron; a cell and a frame identify it.
//
// The corners of a tetrahedron are the cell's centre, the centre of one face, and the two ends of
// one edge of that face. Its walls are mirrors (planes x=k, y=k, z=k, x+-y=k, x+-z=k, y+-z=k in
// index space: the affine Coxeter group of type B3), so the neighbour across a wall is a reflection
// and needs no table.
//
// Folded coordinates (ud, us, ue) are measured from the cell's centre in voxels, with the axes in
// the order and sign of the frame: ud towards the face, us towards the edge, ue along the edge. In
// these coordinates all tetrahedra are the same: 1/2 >= ud >= us >= |ue|.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>

#include "palpate/field.hpp"

namespace palpate {

/// A cell and a frame, which is a signed order of the axes. Two frames that differ only in the sign
/// of the last axis name the same tetrahedron, mirrored.
struct Tetrahedron {
    Index3 cell = Index3::Zero();
    std::array<std::int8_t, 3> axis{0, 1, 2};  ///< towards the face, towards the edge, along it
    std::array<std::int8_t, 3> sign{1, 1, 1};
};

/// True if both name the same region of space.
bool same_tetrahedron(const Tetrahedron& a, const Tetrahedron& b);
/// True if both are the same cell and the same frame, also along the edge.
bool same_frame(const Tetrahedron& a, const Tetrahedron& b);

/// The walls of a tetrahedron in folded coordinates.
enum Wall : unsigned {
    wall_face = 0,   ///< ud = 1/2: the next cell, same face and edge from the other side
    wall_edge = 1,   ///< us = ud:  the other face at the same edge
    wall_plus = 2,   ///< ue = us:  the next edge of the face at the + end
    wall_minus = 3,  ///< ue = -us: the next edge of the face at the - end
};
inline constexpr unsigned wall_count = 4;

/// A point and a tetrahedron that contains it. There is no tolerance: a point is on a wall if its
/// folded coordinates meet the wall's equation bit for bit.
struct LatticePoint {
    Tetrahedron tetrahedron;
    Vec3 folded = Vec3::Zero();  ///< (ud, us, ue) [voxel], 1/2 >= ud >= us >= |ue|
};

/// A linear field in a tetrahedron, in folded coordinates: value(u) = centre + gradient . u
/// (Eq. 2 and 3 of the paper without its matrix).
struct LinearPiece {
    double centre = 0;             ///< density at the cell's centre
    Vec3 gradient = Vec3::Zero();  ///< d density / d (ud, us, ue) [data units / voxel]

    double operator()(const Vec3& folded) const {
        return centre +
               (gradient[0] * folded[0] + gradient[1] * folded[1] + gradient[2] * folded[2]);
    }
};

/// Corners of every tetrahedron in folded coordinates: the cell's centre, the face's centre, and
/// the edge's end at the minus and at the plus side.
inline constexpr std::array<std::array<double, 3>, 4> folded_corners{
    {{0, 0, 0}, {0.5, 0, 0}, {0.5, 0.5, -0.5}, {0.5, 0.5, 0.5}}};

/// Largest |index coordinate| that the lattice accepts; farther points are refused by its users.
inline constexpr double farthest_index = 1e9;

/// A tetrahedron that contains the point (index space, every |coordinate| <= farthest_index).
LatticePoint locate(const Vec3& index);
/// The point in index space.
Vec3 index_of(const LatticePoint& point);

/// A vector from index axes into the frame's order and signs, and back.
Vec3 fold(const Tetrahedron& tetrahedron, const Vec3& vector);
Vec3 unfold(const Tetrahedron& tetrahedron, const Vec3& folded);
/// Positive lengths per axis (spacing) in the frame's order.
Vec3 fold_lengths(const Tetrahedron& tetrahedron, const Vec3& lengths);

/// The linear field of a tetrahedron, from the samples of its cell.
LinearPiece piece_of(const Tetrahedron& tetrahedron, const CellSamples& samples);

/// The scalar product, with its sums in this order everywhere.
inline double dot(const Vec3& a, const Vec3& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
/// True if `wall` is in a mask of walls (bit w stands for wall w).
constexpr bool has(unsigned walls, unsigned wall) {
    return walls >> wall & 1;
}
/// Slack of each wall: >= 0 inside, exactly 0 on the wall [voxel, not normalised].
inline double slack(const Vec3& folded, unsigned wall) {
    switch (wall) {
        case wall_face:
            return 0.5 - folded[0];
        case wall_edge:
            return folded[0] - folded[1];
        case wall_plus:
            return folded[1] - folded[2];
        default:
            return folded[1] + folded[2];
    }
}
/// Rate at which a folded direction reduces that slack (> 0: towards the wall).
inline double approach(const Vec3& folded_direction, unsigned wall) {
    switch (wall) {
        case wall_face:
            return folded_direction[0];
        case wall_edge:
            return folded_direction[1] - folded_direction[0];
        case wall_plus:
            return folded_direction[2] - folded_direction[1];
        default:
            return -folded_direction[1] - folded_direction[2];
    }
}
/// Outward normal of a wall in folded index coordinates.
Vec3 wall_normal(unsigned wall);

/// Bit w is set if the point is on wall w.
unsigned walls_at(const Vec3& folded);
/// Puts a point exactly on the walls of the mask, and back inside the other walls where rounding
/// has left it slightly outside.
Vec3 snap(const Vec3& folded, unsigned walls);
/// The tetrahedron across a wall. A point on that wall keeps its folded coordinates.
Tetrahedron across(const Tetrahedron& tetrahedron, unsigned wall);
/// A folded vector in the folded coordinates of the tetrahedron across the wall.
Vec3 reflect(const Vec3& folded, unsigned wall);

/// All tetrahedra that contain a point: 1 inside, 2 on a wall, up to 48 at a sample.
struct Incident {
    std::array<Tetrahedron, 48> tetrahedra;
    int count = 0;
};
Incident incident_tetrahedra(const LatticePoint& point);

// The same on the lattice of an interpolation. For `cubic`, its cubes are centred at the samples
// (cubic.hpp).

/// A tetrahedron that contains the point, as above.
LatticePoint locate(Interpolation interpolation, const Vec3& index);
/// The point in index space.
Vec3 index_of(Interpolation interpolation, const LatticePoint& point);
/// Density at a lattice point [data units].
double value_at(const Field& field, const LatticePoint& point);
/// Gradient at a lattice point, in index axes [data units / voxel]. On a wall of a linear field it
/// is that of one of the tetrahedra that meet there.
Vec3 gradient_at(const Field& field, const LatticePoint& point);

// Defined here, to be inlined: the servo thread spends most of its time in them.

inline bool same_tetrahedron(const Tetrahedron& a, const Tetrahedron& b) {
    return a.cell == b.cell && a.axis == b.axis && a.sign[0] == b.sign[0] && a.sign[1] == b.sign[1];
}

inline bool same_frame(const Tetrahedron& a, const Tetrahedron& b) {
    // Arrays of three bytes are compared by a function call.
    const auto same = [](const auto& x, const auto& y) {
        return x[0] == y[0] && x[1] == y[1] && x[2] == y[2];
    };
    return same(a.cell, b.cell) && same(a.axis, b.axis) && same(a.sign, b.sign);
}

inline Vec3 fold(const Tetrahedron& t, const Vec3& v) {
    return {t.sign[0] * v[t.axis[0]], t.sign[1] * v[t.axis[1]], t.sign[2] * v[t.axis[2]]};
}

inline Vec3 unfold(const Tetrahedron& t, const Vec3& folded) {
    Vec3 v;
    for (int i = 0; i < 3; ++i) v[t.axis[i]] = t.sign[i] * folded[i];
    return v;
}

inline Vec3 fold_lengths(const Tetrahedron& t, const Vec3& lengths) {
    return {lengths[t.axis[0]], lengths[t.axis[1]], lengths[t.axis[2]]};
}

inline LinearPiece piece_of(const Tetrahedron& t, const CellSamples& f) {
    const auto bit = [&](int i) { return (t.sign[i] > 0 ? 1U : 0U) << t.axis[i]; };
    const unsigned step_s = 1U << t.axis[1];
    const unsigned step_e = 1U << t.axis[2];
    const unsigned plus = bit(0) | bit(1) | bit(2);  // the edge's end towards +e
    const unsigned minus = plus ^ step_e;
    const double edge_sum = f[plus] + f[minus];
    const double face = (edge_sum + (f[plus ^ step_s] + f[minus ^ step_s])) * 0.25;
    const double centre =
        (((f[0] + f[1]) + (f[2] + f[3])) + ((f[4] + f[5]) + (f[6] + f[7]))) * 0.125;
    return {centre, {2 * (face - centre), 2 * (0.5 * edge_sum - face), f[plus] - f[minus]}};
}

inline unsigned walls_at(const Vec3& u) {
    // No folded point is beyond a wall, so >= says the same as ==, in half the instructions.
    return unsigned(u[0] >= 0.5) | unsigned(u[1] >= u[0]) << wall_edge |
           unsigned(u[2] >= u[1]) << wall_plus | unsigned(-u[2] >= u[1]) << wall_minus;
}

inline Vec3 snap(const Vec3& folded, unsigned walls) {
    auto [d, s, e] = std::array{folded[0], folded[1], folded[2]};
    d = has(walls, wall_face) ? 0.5 : std::clamp(d, 0.0, 0.5);
    s = std::clamp(s, 0.0, d);
    if (has(walls, wall_plus) && has(walls, wall_minus)) {
        if (has(walls, wall_edge)) d = 0;
        return {d, 0, 0};
    }
    if (has(walls, wall_edge)) s = d;
    e = std::clamp(e, -s, s);
    if (has(walls, wall_plus)) e = s;
    if (has(walls, wall_minus)) e = -s;
    return {d, s, e};
}

inline Tetrahedron across(const Tetrahedron& t, unsigned wall) {
    Tetrahedron next = t;
    switch (wall) {
        case wall_face:
            next.cell[t.axis[0]] += t.sign[0];
            next.sign[0] = static_cast<std::int8_t>(-t.sign[0]);
            break;
        case wall_edge:
            std::swap(next.axis[0], next.axis[1]);
            std::swap(next.sign[0], next.sign[1]);
            break;
        case wall_plus:
            std::swap(next.axis[1], next.axis[2]);
            std::swap(next.sign[1], next.sign[2]);
            break;
        default:
            std::swap(next.axis[1], next.axis[2]);
            next.sign[1] = static_cast<std::int8_t>(-t.sign[2]);
            next.sign[2] = static_cast<std::int8_t>(-t.sign[1]);
            break;
    }
    return next;
}

inline Vec3 reflect(const Vec3& v, unsigned wall) {
    switch (wall) {
        case wall_face:
            return {-v[0], v[1], v[2]};
        case wall_edge:
            return {v[1], v[0], v[2]};
        case wall_plus:
            return {v[0], v[2], v[1]};
        default:
            return {v[0], -v[2], -v[1]};
    }
}

inline Vec3 wall_normal(unsigned wall) {
    switch (wall) {
        case wall_face:
            return {1, 0, 0};
        case wall_edge:
            return {-1, 1, 0};
        case wall_plus:
            return {0, -1, 1};
        default:
            return {0, -1, -1};
    }
}

}  // namespace palpate
