// The nearest point of few half-spaces: a dual method, for which the unconstrained minimum is the
// start and each step adds the half-space that is missed most.
#include "tool_proxy/nearest.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace palpate::tool {
namespace {

constexpr int most_active = 6;
/// Work of a step that adds or drops a half-space, and of finding eigenvectors.
constexpr int work_of_step = 2, work_of_eigen = 16;

/// The half-spaces on whose border the point is held, with their multipliers.
struct Active {
    std::array<int, most_active> at;
    std::array<double, most_active> multiplier;
    int count = 0;

    void drop(int which) {
        for (int i = which + 1; i < count; ++i) {
            at[i - 1] = at[i];
            multiplier[i - 1] = multiplier[i];
        }
        --count;
    }
};

/// The multiples of the active rows whose sum is nearest to `row`; what is left of it goes to
/// `rest`. By Gram and Schmidt, twice, so that nearly dependent rows do no harm.
std::array<double, most_active> share_of(const Active& active, const HalfSpace6* half_spaces,
                                         const Six& row, Six& rest) {
    std::array<Six, most_active> unit;
    std::array<std::array<double, most_active>, most_active> r{};
    for (int i = 0; i < active.count; ++i) {
        Six v = half_spaces[active.at[i]].row;
        for (int pass = 0; pass < 2; ++pass) {
            for (int j = 0; j < i; ++j) {
                const double part = dot(unit[j], v);
                r[j][i] += part;
                v -= part * unit[j];
            }
        }
        const double length = std::sqrt(dot(v, v));
        r[i][i] = length;
        unit[i] = v / length;
    }
    std::array<double, most_active> share{};
    rest = row;
    for (int pass = 0; pass < 2; ++pass) {
        for (int i = 0; i < active.count; ++i) {
            const double part = dot(unit[i], rest);
            share[i] += part;
            rest -= part * unit[i];
        }
    }
    for (int i = active.count - 1; i >= 0; --i) {
        for (int j = i + 1; j < active.count; ++j) share[i] -= r[i][j] * share[j];
        share[i] /= r[i][i];
    }
    return share;
}

/// Adds the half-space `p` to those active, dropping others on the way. False: none is left.
bool add(int p, const HalfSpace6* half_spaces, Six& x, Active& active, int& work) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    const Six& row = half_spaces[p].row;
    double own = 0;
    while (true) {
        work += work_of_step;
        Six rest;
        const auto share = share_of(active, half_spaces, row, rest);
        const double squared = dot(rest, rest);
        const bool depends = active.count == most_active || squared <= 1e-18 * dot(row, row);
        const double full = depends ? infinity : (half_spaces[p].bound - dot(row, x)) / squared;
        double part = infinity;
        int blocking = -1;
        for (int i = 0; i < active.count; ++i) {
            if (!(share[i] > 0) || active.multiplier[i] / share[i] >= part) continue;
            part = active.multiplier[i] / share[i];
            blocking = i;
        }
        const double t = std::min(full, part);
        if (t == infinity) return false;
        if (!depends) x += t * rest;
        for (int i = 0; i < active.count; ++i) active.multiplier[i] -= t * share[i];
        own += t;
        if (full <= part) {
            active.at[active.count] = p;
            active.multiplier[active.count++] = own;
            return true;
        }
        active.drop(blocking);
    }
}

struct Eigen6 {
    Mat6 vectors;  ///< one a column
    Six values;
};

/// Eigenvalues and vectors of a symmetric matrix by Jacobi's rotations (Golub and Van Loan, 8.5).
/// Of our own: Eigen's solver brings a writable global into the core, and takes a variable time.
Eigen6 eigen_of(Mat6 m) {
    Eigen6 result{Mat6::Identity(), Six::Zero()};
    Mat6& v = result.vectors;
    constexpr int sweeps = 12;  // quadratic convergence: six to eight suffice
    for (int sweep = 0; sweep < sweeps; ++sweep) {
        double beside = 0;
        for (int p = 0; p < 6; ++p) {
            for (int q = p + 1; q < 6; ++q) beside += m(p, q) * m(p, q);
        }
        if (beside <= 1e-30 * m.diagonal().squaredNorm()) break;
        for (int p = 0; p < 6; ++p) {
            for (int q = p + 1; q < 6; ++q) {
                if (m(p, q) == 0) continue;
                const double theta = (m(q, q) - m(p, p)) / (2 * m(p, q));
                const double t =
                    std::copysign(1 / (std::abs(theta) + std::sqrt(theta * theta + 1)), theta);
                const double c = 1 / std::sqrt(t * t + 1);
                const double s = t * c;
                const auto rotate = [c, s](double& x, double& y) {
                    const double old = x;
                    x = c * old - s * y;
                    y = s * old + c * y;
                };
                for (int i = 0; i < 6; ++i) rotate(m(i, p), m(i, q));
                for (int i = 0; i < 6; ++i) rotate(m(p, i), m(q, i));
                for (int i = 0; i < 6; ++i) rotate(v(i, p), v(i, q));
            }
        }
    }
    result.values = m.diagonal();
    return result;
}

}  // namespace

Nearest nearest(const Six& to, const HalfSpace6* half_spaces, int count, double tolerance) {
    Nearest result;
    result.point = to;
    Active active;
    constexpr int enough = 4 * most_half_spaces;
    for (int round = 0; round < enough; ++round) {
        ++result.work;
        double worst = -tolerance;
        int missed = -1;
        for (int i = 0; i < count; ++i) {
            const double room = dot(half_spaces[i].row, result.point) - half_spaces[i].bound;
            if (room >= worst) continue;
            worst = room;
            missed = i;
        }
        if (missed < 0) {
            for (int i = 0; i < active.count; ++i) {
                result.multiplier[active.at[i]] = std::max(0.0, active.multiplier[i]);
            }
            result.found = true;
            return result;
        }
        for (int i = 0; i < active.count; ++i) {
            if (active.at[i] == missed) return result;  // rounding: no better point can be found
        }
        if (!add(missed, half_spaces, result.point, active, result.work)) {
            return result;
        }
    }
    return result;
}

Nearest nearest(const Six& pull, const Mat6& m, double least, const HalfSpace6* half_spaces,
                int count, double tolerance) {
    // M = Q diag(e) Q': y = sqrt(e) Q'x has a unit matrix.
    const Eigen6 eigen = eigen_of(m);
    std::array<Six, 6> axis;  // an eigenvector over the root of its eigenvalue
    for (int i = 0; i < 6; ++i) {
        axis[i] = eigen.vectors.col(i) / std::sqrt(std::max(least, eigen.values[i]));
    }
    const auto scaled = [&axis](const Six& row) {
        Six result;
        for (int i = 0; i < 6; ++i) result[i] = dot(axis[i], row);
        return result;
    };
    std::array<HalfSpace6, most_half_spaces> turned;
    for (int i = 0; i < count; ++i) turned[i] = {scaled(half_spaces[i].row), half_spaces[i].bound};
    Nearest result = nearest(scaled(pull), turned.data(), count, tolerance);
    Six point = Six::Zero();
    for (int i = 0; i < 6; ++i) point += result.point[i] * axis[i];
    result.point = point;
    result.work += work_of_eigen;
    return result;
}

}  // namespace palpate::tool
