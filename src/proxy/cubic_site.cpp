// Certified straight motion on the smooth field.
#include "proxy/cubic_site.hpp"

#include <algorithm>
#include <cmath>

#include "proxy/straight.hpp"

namespace palpate {
namespace {

using Bernstein = std::array<double, 4>;

/// The root of a cubic whose coefficients rise from at most 0 to above 0, from the side below 0.
double rising_root(const Bernstein& b, double tolerance) {
    const double a1 = 3 * (b[1] - b[0]);
    const double a2 = 3 * ((b[2] - b[1]) - (b[1] - b[0]));
    const double a3 = (b[3] - b[0]) - 3 * (b[2] - b[1]);
    double low = 0, high = 1;
    double t = -b[0] / (b[3] - b[0]);
    constexpr int enough = 80;  // bisection alone needs 54
    for (int i = 0; i < enough; ++i) {
        const double p = b[0] + t * (a1 + t * (a2 + t * a3));
        (p <= 0 ? low : high) = t;
        if (p <= 0 && p >= -tolerance) break;
        const double slope = a1 + t * (2 * a2 + t * (3 * a3));
        const double next = t - (p + 0.5 * tolerance) / slope;
        t = next > low && next < high ? next : 0.5 * (low + high);
        if (!(t > low && t < high)) break;
    }
    return low;
}

}  // namespace

double certified_part(const Bernstein& bernstein, double tolerance) {
    constexpr int deepest = 48;
    struct Part {
        Bernstein b;
        double begin, size;
        int depth;
    };
    std::array<Part, deepest + 1> waiting;  // right halves, the nearest last
    int count = 0;
    waiting[count++] = {bernstein, 0, 1, 0};
    while (count > 0) {
        const Part part = waiting[--count];
        const Bernstein& b = part.b;
        if (b[1] <= 0 && b[2] <= 0 && b[3] <= 0) continue;
        if (b[0] > 0 || part.depth == deepest) return part.begin;
        if (b[0] <= b[1] && b[1] <= b[2] && b[2] <= b[3]) {
            return part.begin + part.size * rising_root(b, tolerance);
        }
        const double b01 = 0.5 * (b[0] + b[1]), b12 = 0.5 * (b[1] + b[2]),
                     b23 = 0.5 * (b[2] + b[3]);
        const double b012 = 0.5 * (b01 + b12), b123 = 0.5 * (b12 + b23);
        const double middle = 0.5 * (b012 + b123);
        const double half = 0.5 * part.size;
        waiting[count++] = {{middle, b123, b23, b[3]}, part.begin + half, half, part.depth + 1};
        waiting[count++] = {{b[0], b01, b012, middle}, part.begin, half, part.depth + 1};
    }
    return 1;
}

CubicSite::CubicSite(const Field& f, double level, double s, const LatticePoint& at)
    : field(f), isovalue(level), sign(s), point(at), range(cubic::scale * f.range()) {
    // A level far beyond the data separates them as one just beyond them does.
    const double low = std::min(f.samples().minimum(), f.background()) - f.offset();
    const double high = std::max(f.samples().maximum(), f.background()) - f.offset();
    isovalue = std::clamp(level, low - f.range(), high + f.range());
    expand();
}

double CubicSite::density() const {
    return field.with_offset(isovalue + sign * here.value / cubic::scale);
}

Vec3 CubicSite::folded_to(const Vec3& index) const {
    const Tetrahedron& t = point.tetrahedron;
    const Vec3 from_sample(index[0] - t.cell[0], index[1] - t.cell[1], index[2] - t.cell[2]);
    return fold(t, from_sample) - point.folded;
}

void CubicSite::move_to(const LatticePoint& at) {
    point = at;
    most = std::numeric_limits<double>::infinity();
    expand();
}

void CubicSite::return_to(const CubicSite& before) {
    point = before.point;
    most = before.most;
    piece = before.piece;
    here = before.here;
}

void CubicSite::enter_cube() {
    const auto greatest = [&](const auto* centre, std::ptrdiff_t row, std::ptrdiff_t slice) {
        const auto best = [&](auto better) {
            auto found = *centre;
            for (const std::ptrdiff_t z : {-slice, std::ptrdiff_t{0}, slice}) {
                for (const std::ptrdiff_t y : {z - row, z, z + row}) {
                    for (int x = -1; x <= 1; ++x) found = better(found, centre[y + x]);
                }
            }
            return found;
        };
        return sign > 0 ? best([](auto a, auto b) { return std::max(a, b); }) - isovalue
                        : isovalue - best([](auto a, auto b) { return std::min(a, b); });
    };
    most = cubic::scale * field.visit_around(point.tetrahedron.cell, greatest);
}

void CubicSite::expand() {
    const Tetrahedron& t = point.tetrahedron;
    const auto make = [&](const auto* centre, std::ptrdiff_t row, std::ptrdiff_t slice) {
        return cubic::piece_of(t, centre, row, slice, isovalue);
    };
    piece = field.visit_around(t.cell, make);
    if (sign < 0) piece = -piece;
    here = piece.at(point.folded);
}

double CubicSite::advance(const Vec3& step, double level, unsigned walls) {
    // Along the step the Hessian changes by the third derivatives, which are the same everywhere.
    const cubic::Symmetric third = piece.third(step);
    const Vec3 bend = third * step;
    const Vec3 turn = piece.hessian * step + third * point.folded;
    const double c1 = dot(here.gradient, step), c2 = 0.5 * dot(turn, step),
                 c3 = (1.0 / 6) * dot(bend, step);
    const double c0 = here.value - level;
    const double third_c1 = (1.0 / 3) * c1, third_c2 = (1.0 / 3) * c2;
    const Bernstein b{c0, c0 + third_c1, c0 + 2 * third_c1 + third_c2, c0 + (c1 + c2 + c3)};
    const bool free = b[1] <= 0 && b[2] <= 0 && b[3] <= 0;
    const double t = free ? 1 : certified_part(b, 1e-13 * range);
    here.value += t * (c1 + t * (c2 + t * c3));
    here.gradient += t * (turn + (0.5 * t) * bend);
    point.folded = t < 1 ? snap(point.folded + t * step, 0) : snap(point.folded + step, walls);
    return t;
}

WalkEnd walk(CubicSite& site, const Vec3& displacement, double level, Progress& progress) {
    // Rounding must not hold a start, nor add up to more than what counts as inside.
    const double hair = site.here.value < 1.5e-11 * site.range ? 4e-14 * site.range : 0;
    level = std::max(level, site.here.value + hair);
    Vec3 direction = displacement;
    double left = 1;
    bool expanded = true;  // the piece is that of the tetrahedron, expanded at the point
    while (progress.budget-- > 0) {
        if (site.field.is_background_around(site.point.tetrahedron.cell)) {
            const Vec3 along = unfold(site.point.tetrahedron, direction);
            const Index3& size = site.field.geometry().size;
            const double t = stretch_outside(site.index(), along, left, -2, size, 1);
            if (t > 0) {
                site.move_to(cubic::locate(site.index() + t * along));
                expanded = true;
                direction = fold(site.point.tetrahedron, along);
                left -= t;
                ++progress.tetrahedra;
                if (left <= 0) return WalkEnd::target;
                continue;
            }
        }
        const Exit exit = first_exit(site.point.folded, direction, left, 0);
        const Vec3 step = exit.t * direction;
        const bool at_wall = exit.wall != no_wall;
        const unsigned walls = at_wall ? 1U << exit.wall : 0;
        if (site.most > level) {
            if (!expanded) site.expand();
            const double t = site.advance(step, level, walls);
            progress.tetrahedra += t * exit.t > 0;
            if (t < 1) return WalkEnd::surface;
            expanded = true;
        } else {
            site.point.folded = snap(site.point.folded + step, walls);
            progress.tetrahedra += exit.t > 0;
            expanded = false;
        }
        if (!at_wall) {
            if (!expanded) site.expand();
            return WalkEnd::target;
        }
        progress.report(StepKind::cross, site);
        site.point.tetrahedron = across(site.point.tetrahedron, exit.wall);
        if (exit.wall == wall_face) site.enter_cube();
        expanded = false;
        direction = reflect(direction, exit.wall);
        left -= exit.t;
    }
    if (!expanded) site.expand();
    return WalkEnd::out_of_budget;
}

}  // namespace palpate
