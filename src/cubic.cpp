// Cubic: the smooth field's coefficients from the samples, and the field at a point. docs/smooth.md
// says where they come from.
#include "palpate/cubic.hpp"

namespace palpate::cubic {

Piece piece_of(const Tetrahedron& t, const Neighbours& samples) {
    constexpr std::array<int, 3> stride{1, 3, 9};
    const int d = t.sign[0] * stride[t.axis[0]];
    const int s = t.sign[1] * stride[t.axis[1]];
    const int e = t.sign[2] * stride[t.axis[2]];
    // The samples in the plane e = 0, and the sums and differences of those at e = 1 and e = -1.
    // m is for minus: zmp is the sample at d = -1, s = 1.
    const double* const f = samples.data() + 13;
    const auto sum = [&](int at) { return f[at + e] + f[at - e]; };
    const auto difference = [&](int at) { return f[at + e] - f[at - e]; };
    const double zmm = f[-d - s], zm0 = f[-d], zmp = f[-d + s];
    const double z0m = f[-s], z00 = f[0], z0p = f[s];
    const double zpm = f[d - s], zp0 = f[d], zpp = f[d + s];
    const double sm0 = sum(-d), s0m = sum(-s), s00 = sum(0), s0p = sum(s);
    const double spm = sum(d - s), sp0 = sum(d), spp = sum(d + s);
    const double dm0 = difference(-d), d0m = difference(-s), d00 = difference(0);
    const double d0p = difference(s), dpm = difference(d - s), dp0 = difference(d);
    const double dpp = difference(d + s);
    // Second differences along e.
    const double c0m = s0m - 2 * z0m, c00 = s00 - 2 * z00, c0p = s0p - 2 * z0p;
    const double cpm = spm - 2 * zpm, cp0 = sp0 - 2 * zp0, cpp = spp - 2 * zpp;

    const double ring_m = zmm + zmp + sm0;  // the four neighbours of the sample at d = -1
    const double ring_p = zpm + zpp + sp0;  // and of that at d = 1
    Piece p;
    p.value = 36 * z00 + 8 * ((zm0 + zp0) + (z0m + z0p) + s00) + (ring_m + ring_p + s0m + s0p);
    p.gradient = {36 * (zp0 - zm0) + 3 * (ring_p - ring_m),
                  36 * (z0p - z0m) + 3 * ((zmp + zpp + s0p) - (zmm + zpm + s0m)),
                  36 * d00 + 3 * ((dm0 + dp0) + (d0m + d0p))};
    p.hessian = {96 * (zm0 - z00) + 24 * (ring_p - (z0m + z0p + s00)),
                 12 * (zmm - zmp) + 24 * (z0m - z0p) + 36 * (zpp - zpm),
                 36 * dp0 - 24 * d00 - 12 * dm0,
                 72 * z0m - 96 * z00 - 48 * zp0 + 24 * ((z0p + zpm + zpp) + (s0p - s00)),
                 36 * d0p - 24 * d00 - 12 * d0m,
                 48 * c00 + 24 * (c0p + cp0)};
    p.ddd = 96 * (z00 - zm0) + 24 * ((ring_m - ring_p) + ((spm + spp) - (s0m + s0p)));
    p.dds = 24 * ((zmp - zmm) + (z0m - z0p)) + 12 * ((s0m - s0p) + (spp - spm));
    p.dde = 24 * (dm0 - d00) + 12 * ((dpm + dpp) - (d0m + d0p));
    p.dss = 48 * ((z00 - z0m) + (zpm - zp0)) + 24 * ((s00 - s0p) + (spp - sp0));
    p.dse = 12 * (d0m - dpm) + 24 * (d00 - dp0) + 36 * (dpp - d0p);
    p.dee = 24 * ((cp0 + cpp) - (c00 + c0p));
    p.sss = 12 * ((c0m + c0p) + (cpm + cpp)) - 24 * (c00 + cp0);
    p.sse = 12 * ((d0m + d0p) + (dpm + dpp)) - 24 * (d00 + dp0);
    p.see = 24 * ((c0p + cpp) - (c00 + cp0));
    return p;
}

LatticePoint locate(const Vec3& index) {
    return palpate::locate(index + Vec3::Constant(0.5));
}

Vec3 index_of(const LatticePoint& point) {
    return point.tetrahedron.cell.cast<double>() + unfold(point.tetrahedron, point.folded);
}

}  // namespace palpate::cubic
