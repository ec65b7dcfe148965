// Projection on a convex cone of few half-spaces through the origin, in closed form.
#pragma once

#include <array>

#include "palpate/lattice.hpp"

namespace palpate {

/// {d : normal_i . d <= 0 for all i}. Normals need not have unit length, but must not be zero. The
/// compiler unrolls loops over four of them. Where it could not, for up to 48, updates in noise
/// took 3 % more instructions.
template <int Most>
struct HalfSpaces {
    std::array<Vec3, Most> normal;
    int count = 0;

    void add(const Vec3& n) { normal[count++] = n; }
};

struct ConeProjection {
    Vec3 point = Vec3::Zero();          ///< the point of the cone nearest to h
    std::array<int, 2> active{-1, -1};  ///< half-spaces on whose border it was put
};

/// Of one with four half-spaces, see ProxySettings.
inline constexpr int work_of_projection = 2;

/// The projection of h. In three dimensions it lies in the interior, on one border, on the line of
/// two, or at the apex: each candidate is tried, the longest feasible one is the projection (for a
/// projection p on a cone, |h|^2 = |p|^2 + |h - p|^2).
template <int Most>
ConeProjection project_on_cone(const Vec3& h, const HalfSpaces<Most>& cone);

/// The most tetrahedra meet at a sample: 48 constraint planes (method paper).
extern template ConeProjection project_on_cone(const Vec3&, const HalfSpaces<4>&);
extern template ConeProjection project_on_cone(const Vec3&, const HalfSpaces<48>&);

}  // namespace palpate
