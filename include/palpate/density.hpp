// Stage 7, density: the field at a point, whichever way it continues between its samples. What
// observes a field asks here; the proxy has its own, quicker ways.
#pragma once

#include "palpate/cubic.hpp"

namespace palpate {

/// A tetrahedron that contains the point (index space, every |coordinate| <= farthest_index), of
/// the lattice that this interpolation lies on.
LatticePoint locate(Interpolation interpolation, const Vec3& index);
/// The point in index space.
Vec3 index_of(Interpolation interpolation, const LatticePoint& point);

/// Density at a lattice point [data units].
double value_at(const Field& field, const LatticePoint& point);
/// Density at a physical point [mm]; the background outside the grid. The point must be finite.
double value_at(const Field& field, const Vec3& physical);
/// Gradient at a lattice point, in index axes [data units / voxel]. On a wall of a linear field it
/// is that of one of the tetrahedra that meet there.
Vec3 gradient_at(const Field& field, const LatticePoint& point);
/// Gradient at a physical point, in physical axes [data units / mm].
Vec3 gradient_at(const Field& field, const Vec3& physical);
/// Second derivatives at a physical point, in physical axes [data units / mm^2]; 0 for a linear
/// field. On a wall they are those of one of the tetrahedra that meet there.
Mat3 hessian_at(const Field& field, const Vec3& physical);

}  // namespace palpate
