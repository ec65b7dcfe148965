// The nearest point of a convex set of few half-spaces in six dimensions.
#pragma once

#include <Eigen/Core>
#include <array>

#include "palpate/lattice.hpp"

namespace palpate::tool {

/// Translation [mm], then rotation [rad] times the radius of gyration.
using Six = Eigen::Matrix<double, 6, 1>;
using Mat6 = Eigen::Matrix<double, 6, 6>;

using palpate::dot;

inline double dot(const Six& a, const Six& b) {
    return ((a[0] * b[0] + a[1] * b[1]) + (a[2] * b[2] + a[3] * b[3])) +
           (a[4] * b[4] + a[5] * b[5]);
}

/// row . x >= bound.
struct HalfSpace6 {
    Six row;
    double bound;
};

inline constexpr int most_half_spaces = 32;

struct Nearest {
    bool found = false;  ///< false: no point is in all half-spaces
    Six point = Six::Zero();
    std::array<double, most_half_spaces> multiplier{};  ///< >= 0, of each half-space
    int work = 0;                                       ///< in units of ToolSettings::work_budget
};

/// The point of the half-spaces nearest to `to` (Goldfarb and Idnani 1983, the dual method for a
/// unit matrix). A half-space counts as satisfied up to `tolerance`.
Nearest nearest(const Six& to, const HalfSpace6* half_spaces, int count, double tolerance);

/// The minimum of x'Mx / 2 - pull . x on the half-spaces; M symmetric. Eigenvalues of M below
/// `least` count as `least`.
Nearest nearest(const Six& pull, const Mat6& m, double least, const HalfSpace6* half_spaces,
                int count, double tolerance);

}  // namespace palpate::tool
