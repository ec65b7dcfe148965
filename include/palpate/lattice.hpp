// Stage 3, lattice: every cell cut into 24 tetrahedra with a linear field in each (Corenthy et al.
// 2012, section 3). Nothing is stored per tetrahedron: where one is, is a cell and a frame.
//
// A tetrahedron is: cell centre, centre of one face, the two ends of one edge of that face. Its
// walls are mirrors (planes x=k, y=k, z=k, x+-y=k, x+-z=k, y+-z=k in index space: the affine
// Coxeter group of type B3), so the neighbour across a wall is a reflection and needs no table.
//
// Folded coordinates: measured from the cell's centre in voxels, with the axes in the order and
// sign of the frame: (ud, us, ue), ud towards the face, us towards the edge, ue along the edge. In
// them every tetrahedron is the same one: 1/2 >= ud >= us >= |ue|.
#pragma once

#include <array>
#include <cstdint>

#include "palpate/field.hpp"

namespace palpate {

/// A cell and a signed order of the axes. Two frames that differ in the sign of the last axis only
/// are the same tetrahedron seen in a mirror.
struct Tetrahedron {
    Index3 cell = Index3::Zero();
    std::array<std::int8_t, 3> axis{0, 1, 2};  ///< towards the face, towards the edge, along it
    std::array<std::int8_t, 3> sign{1, 1, 1};
};

/// True if both name the same region of space.
bool same_tetrahedron(const Tetrahedron& a, const Tetrahedron& b);

/// The walls of a tetrahedron in folded coordinates.
enum Wall : unsigned {
    wall_face = 0,   ///< ud = 1/2: the next cell, same face and edge from the other side
    wall_edge = 1,   ///< us = ud:  the other face at the same edge
    wall_plus = 2,   ///< ue = us:  the next edge of the face at the + end
    wall_minus = 3,  ///< ue = -us: the next edge of the face at the - end
};
inline constexpr unsigned wall_count = 4;

/// A point together with a tetrahedron that contains it. Walls are met exactly, not within a
/// tolerance: a point is on a wall if its folded coordinates say so bit for bit.
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

/// Largest |index coordinate| that the lattice accepts; farther points are refused by its users.
inline constexpr double farthest_index = 1e9;

/// A tetrahedron that contains the point (index space, every |coordinate| <= farthest_index).
LatticePoint locate(const Vec3& index);
/// The point in index space.
Vec3 index_of(const LatticePoint& point);
/// to - from in voxels, without the loss of digits that large coordinates bring.
Vec3 difference(const LatticePoint& to, const LatticePoint& from);

/// A vector from index axes into the frame's order and signs, and back.
Vec3 fold(const Tetrahedron& tetrahedron, const Vec3& vector);
Vec3 unfold(const Tetrahedron& tetrahedron, const Vec3& folded);
/// Positive lengths per axis (spacing) in the frame's order.
Vec3 fold_lengths(const Tetrahedron& tetrahedron, const Vec3& lengths);

/// The linear field of a tetrahedron, from the samples of its cell.
LinearPiece piece_of(const Tetrahedron& tetrahedron, const CellSamples& samples);

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
/// Rate at which a folded direction uses up that slack (> 0: towards the wall).
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
/// Puts a point exactly on the walls of the mask and pulls it back inside the others where rounding
/// had left it outside by a hair.
Vec3 snap(const Vec3& folded, unsigned walls);
/// The tetrahedron across a wall. A point on that wall keeps its folded coordinates.
Tetrahedron across(const Tetrahedron& tetrahedron, unsigned wall);
/// A folded vector seen from across the wall.
Vec3 reflect(const Vec3& folded, unsigned wall);

/// All tetrahedra that contain a point: 1 inside, 2 on a wall, up to 48 at a sample.
struct Incident {
    std::array<Tetrahedron, 48> tetrahedra;
    int count = 0;
};
Incident incident_tetrahedra(const LatticePoint& point);

/// Density at a lattice point [data units].
double value_at(const Field& field, const LatticePoint& point);
/// Density at a physical point [mm]; the background outside the grid. The point must be finite.
double value_at(const Field& field, const Vec3& physical);
/// Gradient at a physical point, in physical axes [data units / mm]. On a wall that of one of the
/// tetrahedra that meet there.
Vec3 gradient_at(const Field& field, const Vec3& physical);

}  // namespace palpate
