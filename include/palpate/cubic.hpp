// Stage 7, cubic: the smooth field. On the lattice's tetrahedra, moved so that a cube lies round
// each sample, the field is a cubic in each tetrahedron, with a continuous gradient everywhere
// (docs/smooth.md). Its samples are the same; nothing is stored per tetrahedron.
//
// A tetrahedron's `cell` is here the sample in the middle of its cube, which owns the points within
// half a voxel of it along each axis. Walls, folded coordinates and reflections are the lattice's.
#pragma once

#include "palpate/lattice.hpp"

namespace palpate::cubic {

/// A symmetric matrix or quadratic form in folded axes (d, s, e).
struct Symmetric {
    double dd = 0, ds = 0, de = 0, ss = 0, se = 0, ee = 0;

    Vec3 operator*(const Vec3& v) const {
        return {dd * v[0] + ds * v[1] + de * v[2], ds * v[0] + ss * v[1] + se * v[2],
                de * v[0] + se * v[1] + ee * v[2]};
    }
};

/// What the values below are multiplied by, so that all coefficients of integer samples are
/// integers.
inline constexpr double scale = 96;

/// Value and derivatives of the field at a point, times `scale` [data units], per voxel of the
/// folded axes.
struct Taylor {
    double value = 0;
    Vec3 gradient = Vec3::Zero();
    Symmetric hessian;
};

/// The cubic of a tetrahedron: its derivatives at the cube's centre, times `scale`. For integer
/// samples all of them are exact. Value and gradient are the same for the whole cube; the third
/// derivative along e is 0.
struct Piece : Taylor {
    double ddd = 0, dds = 0, dde = 0, dss = 0, dse = 0, dee = 0, sss = 0, sse = 0, see = 0;

    /// The third derivatives applied to one vector.
    Symmetric third(const Vec3& v) const {
        return {ddd * v[0] + dds * v[1] + dde * v[2], dds * v[0] + dss * v[1] + dse * v[2],
                dde * v[0] + dse * v[1] + dee * v[2], dss * v[0] + sss * v[1] + sse * v[2],
                dse * v[0] + sse * v[1] + see * v[2], dee * v[0] + see * v[1]};
    }
    /// The expansion at a folded point [voxel] of the tetrahedron.
    Taylor at(const Vec3& folded) const;
    /// The value alone.
    double operator()(const Vec3& folded) const;
};

/// The cubic of a tetrahedron from the neighbours of its sample. Each Bernstein coefficient of it
/// is a mean of these samples with weights >= 0, so the field never leaves their range.
Piece piece_of(const Tetrahedron& tetrahedron, const Neighbours& samples);

/// A tetrahedron that contains the point (index space, every |coordinate| <= farthest_index).
LatticePoint locate(const Vec3& index);
/// The point in index space.
Vec3 index_of(const LatticePoint& point);

// Defined here, to be inlined.

inline Taylor Piece::at(const Vec3& u) const {
    const Symmetric t = third(u);
    const Symmetric h{hessian.dd + t.dd, hessian.ds + t.ds, hessian.de + t.de,
                      hessian.ss + t.ss, hessian.se + t.se, hessian.ee + t.ee};
    const Vec3 hu = hessian * u;
    const Vec3 tu = t * u;
    return {value + dot(gradient + 0.5 * hu + (1.0 / 6) * tu, u), gradient + hu + 0.5 * tu, h};
}

inline double Piece::operator()(const Vec3& u) const {
    return value + dot(gradient + 0.5 * (hessian * u) + (1.0 / 6) * (third(u) * u), u);
}

}  // namespace palpate::cubic
