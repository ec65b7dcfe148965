// Stage 6, cubic: the smooth field. It uses the lattice's tetrahedra, moved so that a cube is
// centred at each sample. In each tetrahedron the field is a cubic polynomial, and its gradient is
// continuous everywhere (docs/smooth.md). Nothing is stored per tetrahedron.
//
// A tetrahedron's `cell` is here the sample in the middle of its cube, which owns the points within
// half a voxel of it along each axis. Walls, folded coordinates and reflections are the lattice's.
#pragma once

#include <array>
#include <cstddef>
#include <type_traits>

#include "palpate/lattice.hpp"

namespace palpate::cubic {

/// Two numbers that are computed together.
using Vec2 = Eigen::Vector2d;

/// A symmetric matrix or quadratic form in folded axes (d, s, e): the rows d and s of its columns
/// d, s and e. Row e has the same numbers, and `ee`.
struct Symmetric {
    Vec2 d = Vec2::Zero(), s = Vec2::Zero(), e = Vec2::Zero();
    double ee = 0;

    Vec3 operator*(const Vec3& v) const {
        const Vec2 rows = d * v[0] + s * v[1] + e * v[2];
        return {rows[0], rows[1], e[0] * v[0] + e[1] * v[1] + ee * v[2]};
    }
};

/// The factor of all values below. It makes all coefficients of integer samples integers.
inline constexpr double scale = 96;

/// Value [data units], gradient [data units / voxel] and Hessian [data units / voxel^2] of the
/// field at a point, times `scale`, in folded axes.
struct Expansion {
    double value = 0;
    Vec3 gradient = Vec3::Zero();
    Symmetric hessian;
};

/// The cubic of a tetrahedron: its derivatives at the cube's centre, times `scale`. For integer
/// samples all of them are exact. Value and gradient are the same for the whole cube.
struct Piece : Expansion {
    /// The third derivatives: the changes of the second derivatives along d and s. Those along e
    /// that are not among these are 0.
    Vec2 dd = Vec2::Zero(), ds = Vec2::Zero(), de = Vec2::Zero();
    Vec2 ss = Vec2::Zero(), se = Vec2::Zero(), ee = Vec2::Zero();

    /// The third derivatives applied to one vector.
    Symmetric third(const Vec3& v) const {
        return {dd * v[0] + ds * v[1] + de * v[2], ds * v[0] + ss * v[1] + se * v[2],
                de * v[0] + se * v[1] + ee * v[2], ee[0] * v[0] + ee[1] * v[1]};
    }
    /// The field at a folded point [voxel] of the tetrahedron.
    Expansion at(const Vec3& folded) const;
    /// The value alone.
    double operator()(const Vec3& folded) const;
    /// That of the field with its sign turned.
    Piece operator-() const;
};

/// The cubic of a tetrahedron from the neighbours of its sample. Each Bernstein coefficient of it
/// is a mean of these samples with weights >= 0, so the field never leaves their range.
Piece piece_of(const Tetrahedron& tetrahedron, const Neighbours& samples);
/// The same from samples that lie as Field::visit_around() shows them, less `isovalue`.
template <class T>
void make_piece(Piece& piece, const Tetrahedron& tetrahedron, const T* centre, std::ptrdiff_t row,
                std::ptrdiff_t slice, double isovalue);

/// A tetrahedron that contains the point (index space, every |coordinate| <= farthest_index).
LatticePoint locate(const Vec3& index);
/// The point in index space.
Vec3 index_of(const LatticePoint& point);

// Defined here, to be inlined.

namespace detail {

/// The samples around a tetrahedron's cube, in the axes of its frame, as rows along s. The first
/// letter names the plane (z, p and m for e = 0, 1 and -1), the second the place in d (m, 0 and p
/// for -1, 0 and 1).
template <class T>
struct Rows {
    // 16-bit samples times 96, and sums of some of them, fit into an int.
    static_assert(std::is_floating_point_v<T> || sizeof(T) <= 2);
    using Sum = std::conditional_t<std::is_floating_point_v<T>, double, int>;

    Rows(const T* centre, std::ptrdiff_t d, std::ptrdiff_t along_s, std::ptrdiff_t e)
        : zm(centre - d),
          z0(centre),
          zp(centre + d),
          pm(zm + e),
          p0(z0 + e),
          pp(zp + e),
          mm(zm - e),
          m0(z0 - e),
          mp(zp - e),
          s(along_s) {}

    const T *zm, *z0, *zp, *pm, *p0, *pp, *mm, *m0, *mp;
    std::ptrdiff_t s;
};

/// Terms that are odd along e come from differences of the planes e = 1 and e = -1. In their names
/// the place along d and s follows: dm0 is at d = -1, s = 0.
template <class T>
inline void set_odd(Piece& p, const Rows<T>& r) {
    using Sum = typename Rows<T>::Sum;
    const auto difference = [](const T* plus, const T* minus, std::ptrdiff_t at) {
        return Sum(plus[at]) - Sum(minus[at]);
    };
    const Sum dm0 = difference(r.pm, r.mm, 0);
    const Sum d0m = difference(r.p0, r.m0, -r.s), d00 = difference(r.p0, r.m0, 0),
              d0p = difference(r.p0, r.m0, r.s);
    const Sum dpm = difference(r.pp, r.mp, -r.s), dp0 = difference(r.pp, r.mp, 0),
              dpp = difference(r.pp, r.mp, r.s);
    p.gradient[2] = 36 * d00 + 3 * ((dm0 + dp0) + (d0m + d0p));
    p.hessian.e = {36 * dp0 - 24 * d00 - 12 * dm0, 36 * d0p - 24 * d00 - 12 * d0m};
    const Sum dde = 24 * (dm0 - d00) + 12 * ((dpm + dpp) - (d0m + d0p));
    const Sum dse = 12 * (d0m - dpm) + 24 * (d00 - dp0) + 36 * (dpp - d0p);
    const Sum sse = 12 * ((d0m + d0p) + (dpm + dpp)) - 24 * (d00 + dp0);
    p.de = {dde, dse};
    p.se = {dse, sse};
}

/// Terms that are even along e come from the plane e = 0 and the sums of the other two.
template <class T>
inline void set_even(Piece& p, const Rows<T>& r, double isovalue) {
    using Sum = typename Rows<T>::Sum;
    const auto sum = [](const T* plus, const T* minus, std::ptrdiff_t at) {
        return Sum(plus[at]) + Sum(minus[at]);
    };
    const Sum sm0 = sum(r.pm, r.mm, 0);
    const Sum s0m = sum(r.p0, r.m0, -r.s), s00 = sum(r.p0, r.m0, 0), s0p = sum(r.p0, r.m0, r.s);
    const Sum spm = sum(r.pp, r.mp, -r.s), sp0 = sum(r.pp, r.mp, 0), spp = sum(r.pp, r.mp, r.s);
    const Sum zmm = r.zm[-r.s], zm0 = r.zm[0], zmp = r.zm[r.s];
    const Sum z0m = r.z0[-r.s], z00 = r.z0[0], z0p = r.z0[r.s];
    const Sum zpm = r.zp[-r.s], zp0 = r.zp[0], zpp = r.zp[r.s];
    // Second differences along e.
    const Sum c0m = s0m - 2 * z0m, c00 = s00 - 2 * z00, c0p = s0p - 2 * z0p;
    const Sum cpm = spm - 2 * zpm, cp0 = sp0 - 2 * zp0, cpp = spp - 2 * zpp;
    p.hessian.ee = 48 * c00 + 24 * (c0p + cp0);
    p.ee = {24 * ((cp0 + cpp) - (c00 + c0p)), 24 * ((c0p + cpp) - (c00 + cp0))};
    const Sum sss = 12 * ((c0m + c0p) + (cpm + cpp)) - 24 * (c00 + cp0);
    const Sum ring_m = zmm + zmp + sm0;  // the four neighbours of the sample at d = -1
    const Sum ring_p = zpm + zpp + sp0;  // and of that at d = 1
    // From differences, which keep their digits however far the samples lie from zero.
    p.value = scale * (z00 - isovalue) + (8 * (((zm0 + zp0) + (z0m + z0p) + s00) - 6 * z00) +
                                          ((ring_m + ring_p + s0m + s0p) - 12 * z00));
    p.gradient[0] = 36 * (zp0 - zm0) + 3 * (ring_p - ring_m);
    p.gradient[1] = 36 * (z0p - z0m) + 3 * ((zmp + zpp + s0p) - (zmm + zpm + s0m));
    const Sum hdd = 96 * (zm0 - z00) + 24 * (ring_p - (z0m + z0p + s00));
    const Sum hds = 12 * (zmm - zmp) + 24 * (z0m - z0p) + 36 * (zpp - zpm);
    const Sum hss = 72 * z0m - 96 * z00 - 48 * zp0 + 24 * ((z0p + zpm + zpp) + (s0p - s00));
    p.hessian.d = {hdd, hds};
    p.hessian.s = {hds, hss};
    const Sum ddd = 96 * (z00 - zm0) + 24 * ((ring_m - ring_p) + ((spm + spp) - (s0m + s0p)));
    const Sum dds = 24 * ((zmp - zmm) + (z0m - z0p)) + 12 * ((s0m - s0p) + (spp - spm));
    const Sum dss = 48 * ((z00 - z0m) + (zpm - zp0)) + 24 * ((s00 - s0p) + (spp - sp0));
    p.dd = {ddd, dds};
    p.ds = {dds, dss};
    p.ss = {dss, sss};
}

}  // namespace detail

// docs/smooth.md says where the coefficients come from.
template <class T>
inline void make_piece(Piece& p, const Tetrahedron& t, const T* centre, std::ptrdiff_t row,
                       std::ptrdiff_t slice, double isovalue) {
    const std::array<std::ptrdiff_t, 3> stride{1, row, slice};
    const detail::Rows<T> rows(centre, t.sign[0] * stride[t.axis[0]], t.sign[1] * stride[t.axis[1]],
                               t.sign[2] * stride[t.axis[2]]);
    detail::set_odd(p, rows);
    detail::set_even(p, rows, isovalue);
}

inline Piece Piece::operator-() const {
    Piece p;
    p.value = -value;
    p.gradient = -gradient;
    p.hessian = {-hessian.d, -hessian.s, -hessian.e, -hessian.ee};
    p.dd = -dd, p.ds = -ds, p.de = -de, p.ss = -ss, p.se = -se, p.ee = -ee;
    return p;
}

inline Expansion Piece::at(const Vec3& u) const {
    const Vec3 hu = hessian * u;
    const Symmetric t = third(u);
    const Vec3 tu = t * u;
    return {value + dot(gradient + 0.5 * hu + (1.0 / 6) * tu, u),
            gradient + hu + 0.5 * tu,
            {hessian.d + t.d, hessian.s + t.s, hessian.e + t.e, hessian.ee + t.ee}};
}

inline double Piece::operator()(const Vec3& u) const {
    return value + dot(gradient + 0.5 * (hessian * u) + (1.0 / 6) * (third(u) * u), u);
}

}  // namespace palpate::cubic
