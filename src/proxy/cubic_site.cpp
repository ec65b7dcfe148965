// Certified straight motion on the smooth field.
#include "proxy/cubic_site.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "proxy/kept_samples.hpp"

namespace palpate {
namespace {

using Bernstein = std::array<double, 4>;

bool rises(const Bernstein& b) {
    return b[0] <= b[1] && b[1] <= b[2] && b[2] <= b[3];
}

/// The root of a cubic whose coefficients rise from at most 0 to above 0, from the side below 0.
double rising_root(const Bernstein& b, double tolerance) {
    const double a1 = 3 * (b[1] - b[0]);
    const double a2 = 3 * ((b[2] - b[1]) - (b[1] - b[0]));
    const double a3 = (b[3] - b[0]) - 3 * (b[2] - b[1]);
    double low = 0, high = 1;
    // The root of the parabola at the start is near. If it has none, takes that of the chord.
    const double square = a1 * a1 - 4 * a2 * b[0];
    double t =
        square > 0 ? std::min(1.0, -2 * b[0] / (a1 + std::sqrt(square))) : -b[0] / (b[3] - b[0]);
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
        if (rises(b)) {
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
    : BoundPoint{f, f.within_reach(level), s, at}, range(cubic::scale * f.range()) {}

CubicSite::CubicSite(const Proxy& proxy, const Field& f, const LatticePoint& at)
    : BoundPoint{f, f.within_reach(proxy.isovalue - f.offset()), f.sign(), at},
      range(cubic::scale * f.range()),
      kept(proxy.kept) {
    bound_by(proxy, cubic::scale);
    made = kept.isovalue == isovalue && kept.sign == sign &&
           same_frame(kept.tetrahedron, at.tetrahedron) &&
           visit_cube([&](const auto* centre, auto row, auto slice) {
               return Kept::are(proxy.kept_samples, centre, row, slice);
           });
    if (!made || is_layer() || kept.most == std::numeric_limits<double>::infinity()) look_at_cube();
}

void CubicSite::turn() {
    exchange_levels();
    made = false;
    expanded = false;
    look_at_cube();
}

double CubicSite::density() {
    if (!expanded && !made) make_piece();
    const double here = expanded ? at_point.value : kept.piece(point.folded);
    return field.with_offset(isovalue + sign * here / cubic::scale);
}

void CubicSite::keep(Proxy& proxy) {
    if (!made || !kept_is_new) return;
    proxy.kept = kept;
    visit_cube([&](const auto* centre, auto row, auto slice) {
        Kept::keep(proxy.kept_samples, centre, row, slice);
    });
}

void CubicSite::move_to(const LatticePoint& at) {
    point = at;
    ++frame;
    gathered.done = false;
    made = made && same_frame(kept.tetrahedron, at.tetrahedron);
    kept.most = std::numeric_limits<double>::infinity();
    if (is_layer()) room = -kept.most;
    expanded = false;
}

void CubicSite::return_to(const CubicSite& before) {
    point = before.point;
    ++frame;
    gathered.done = false;
    if (turned != before.turned) exchange_levels();
    kept = before.kept;
    room = before.room;
    at_point = before.at_point;
    made = before.made;
    expanded = before.expanded;
}

void CubicSite::cross(unsigned wall) {
    point.tetrahedron = across(point.tetrahedron, wall);
    ++frame;
    made = false;
    expanded = false;
    if (wall != wall_face) return;
    gathered.done = false;
    look_at_cube();
}

void CubicSite::look_at_cube() {
    const auto greatest = [&](double s, const auto* centre, std::ptrdiff_t row,
                              std::ptrdiff_t slice) {
        const auto best = [&](auto better) {
            auto found = *centre;
            for_each_row(centre, row, slice, [&](const auto* first) {
                for (int x = 0; x < 3; ++x) found = better(found, first[x]);
            });
            return found;
        };
        return s > 0 ? best([](auto a, auto b) { return std::max(a, b); }) - isovalue
                     : isovalue - best([](auto a, auto b) { return std::min(a, b); });
    };
    const auto most = [&](double s) {
        return cubic::scale * visit_cube([&](const auto* centre, auto row, auto slice) {
                   return greatest(s, centre, row, slice);
               });
    };
    kept.most = most(sign);
    if (is_layer()) room = thickness - most(-sign);
    kept_is_new = true;
}

void CubicSite::expand() {
    if (!made) make_piece();
    at_point = kept.piece.at(point.folded);
    expanded = true;
}

void CubicSite::make_piece() {
    const Tetrahedron& t = point.tetrahedron;
    const auto make = [&](const auto* centre, std::ptrdiff_t row, std::ptrdiff_t slice) {
        cubic::make_piece(kept.piece, t, centre, row, slice, isovalue);
    };
    if (field.is_background_around(t.cell)) {  // of which no sample needs to be gathered
        kept.piece = {};
        kept.piece.value = cubic::scale * (field.background() - field.offset() - isovalue);
    } else {
        visit_cube(make);
    }
    if (sign < 0) kept.piece = -kept.piece;
    kept.isovalue = isovalue;
    kept.sign = sign;
    kept.tetrahedron = t;
    ++pieces;
    made = true;
    kept_is_new = true;
}

double CubicSite::advance(const Vec3& step, double level, unsigned walls) {
    cubic::Expansion& from = at_point;
    if (!expanded) expand();
    // Along the step the Hessian changes by the third derivatives, which are the same everywhere.
    const cubic::Symmetric third = kept.piece.third(step);
    const Vec3 bend = third * step;
    const Vec3 turn = from.hessian * step;
    const double c1 = dot(from.gradient, step), c2 = 0.5 * dot(turn, step),
                 c3 = (1.0 / 6) * dot(bend, step);
    const double c0 = from.value - level;
    const double third_c1 = (1.0 / 3) * c1, third_c2 = (1.0 / 3) * c2;
    const Bernstein b{c0, c0 + third_c1, c0 + 2 * third_c1 + third_c2, c0 + (c1 + c2 + c3)};
    const bool free = b[1] <= 0 && b[2] <= 0 && b[3] <= 0;
    double t = free ? 1 : certified_part(b, 1e-13 * range);
    bool at_behind = false;
    if (reaches_behind()) {
        const double to_behind = -level - thickness - this->level();
        const double part =
            certified_part({to_behind - b[0], to_behind - b[1], to_behind - b[2], to_behind - b[3]},
                           1e-13 * range);
        at_behind = part < t;
        t = std::min(t, part);
    }
    if (t == 1) jump(step, walls);
    if (t == 1 && walls != 0) return t;  // the next tetrahedron has another piece
    if (t < 1) point.folded = snap(point.folded + t * step, 0);
    from.value += t * (c1 + t * (c2 + t * c3));
    from.gradient += t * (turn + (0.5 * t) * bend);
    from.hessian.d += t * third.d;
    from.hessian.s += t * third.s;
    from.hessian.e += t * third.e;
    from.hessian.ee += t * third.ee;
    expanded = true;
    if (at_behind) this->turn();
    return t;
}

/// On the smooth field, for a point.
struct CubicCourse : PointCourse {
    double level;
    bool outside;  // the point's cube is background, and so are those round it

    double skip(const CubicSite& site, const Vec3& direction, double left) {
        outside = outside && is_outside(site);
        if (!outside) return 0;
        const double t = stretch_outside(site.index(), unfold(site.point.tetrahedron, direction),
                                         left, -2, site.field.geometry().size, 1);
        progress.tetrahedra += t > 0;
        return t;
    }
    std::optional<double> advance(CubicSite& site, const Exit& exit, const Vec3& direction) {
        const Vec3 step = exit.t * direction;
        double t = 1;
        if (site.reaches(level) || site.reaches_behind()) {
            t = site.advance(step, level, exit.walls());
        } else {
            site.jump(step, exit.walls());
        }
        progress.tetrahedra += t * exit.t > 0;
        progress.charge(site.take_work());
        if (t < 1) return t * exit.t;
        return std::nullopt;
    }
    void crossed(CubicSite& site, unsigned wall) {
        progress.report(StepKind::cross, site);
        site.cross(wall);
        if (wall == wall_face) outside = is_outside(site);
    }
    static bool is_outside(const CubicSite& site) {
        return site.field.is_background_around(site.point.tetrahedron.cell);
    }
};

WalkEnd walk(CubicSite& site, const Vec3& displacement, double level, Progress& progress) {
    if (site.reaches(level)) {
        // Rounding must not hold a start, nor add up to more than what counts as inside.
        const double hair = site.excess() < 1.5e-11 * site.range ? 4e-14 * site.range : 0;
        level = std::max(level, site.excess() + hair);
    }
    // If samples reach the level, there is more than background.
    const bool outside = !site.reaches(level) && CubicCourse::is_outside(site);
    return walk_straight(site, displacement, CubicCourse{{progress}, level, outside}).end;
}

}  // namespace palpate
