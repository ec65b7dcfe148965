// The next move of method exact: closed forms inside a tetrahedron and on one wall, the general
// projection on edges, at vertices and wherever rounding could decide.
#include "proxy/move.hpp"

#include <bit>
#include <utility>

#include "proxy/cone.hpp"

namespace palpate {
namespace {

/// The move of an SCP in contact inside a tetrahedron: one plane at most.
Move move_inside(const Site& site, const Vec3& h) {
    const Tetrahedron& t = site.point.tetrahedron;
    const Vec3 g = site.sign * site.piece.gradient;
    const double into = dot(g, h);
    if (into <= 0) return {.tetrahedron = t, .step = h, .straight = true};
    const Vec3 mm = fold_lengths(t, site.field.geometry().spacing);
    const Vec3 per_mm = fold_lengths(t, site.field.voxels_per_mm());
    // The normal in mm is g per_mm, and going back to voxels multiplies by per_mm again.
    const Vec3 n = g.cwiseProduct(per_mm).cwiseProduct(per_mm);
    const Vec3 step = h - n * (into / dot(g, n));
    const Vec3 step_mm = step.cwiseProduct(mm);
    return {.tetrahedron = t, .step = step, .gain = dot(step_mm, step_mm)};
}

/// The best move inside one of several incident tetrahedra: h (in its frame) projected on the cone
/// of the walls that the SCP is on and, in contact, the isosurface with gradient g of the excess.
Move move_in(const Tetrahedron& t, const Vec3& g, unsigned on, bool contact, const Vec3& h,
             const Field& field) {
    const bool constrained = contact && (g[0] != 0 || g[1] != 0 || g[2] != 0);
    bool inside = !constrained || dot(g, h) <= 0;
    // Wall by wall the sign of `approach` is exact, so every direction has a tetrahedron that takes
    // it: no gap opens between neighbours.
    for (unsigned w = 0; w < wall_count; ++w) {
        if (has(on, w)) inside &= approach(h, w) <= 0;
    }
    const Vec3 mm = fold_lengths(t, field.geometry().spacing);
    const Vec3 per_mm = fold_lengths(t, field.voxels_per_mm());
    const Vec3 h_mm = h.cwiseProduct(mm);
    if (inside) return {t, h, 0, dot(h_mm, h_mm), true};
    WalledCone cone(on, per_mm);
    if (constrained) cone.half_spaces.add(g.cwiseProduct(per_mm));
    const ConeProjection projection = project_on_cone(h_mm, cone.half_spaces);
    return {t, projection.point.cwiseProduct(per_mm), cone.walls_of(projection),
            dot(projection.point, projection.point)};
}

/// h projected on the isosurface's plane alone, in one of the two tetrahedra at a wall.
struct PlaneMove {
    enum class End { target, inside, beyond, close };  // beyond or close: to the wall
    End end = End::close;
    Vec3 step = Vec3::Zero();  ///< folded [voxel]
    double gain = 0;           ///< |step|^2 [mm^2]
};
using End = PlaneMove::End;

/// Closer to the wall than this part of |h|, rounding could decide between the two sides.
constexpr double close_to_wall = 1e-3;

PlaneMove move_on_plane(const Tetrahedron& t, const Vec3& g, unsigned wall, const Vec3& h,
                        const Field& field) {
    const Vec3 h_mm = h.cwiseProduct(fold_lengths(t, field.geometry().spacing));
    if (approach(h, wall) <= 0 && dot(g, h) <= 0) return {End::target, h, dot(h_mm, h_mm)};
    const Vec3 per_mm = fold_lengths(t, field.voxels_per_mm());
    const Vec3 n = g.cwiseProduct(per_mm);
    const double pull = dot(n, h_mm);
    const Vec3 p = pull > 0 ? Vec3(h_mm - n * (pull / dot(n, n))) : h_mm;
    PlaneMove move{End::close, p.cwiseProduct(per_mm), dot(p, p)};
    const double past = approach(move.step, wall);
    if (past * past > close_to_wall * close_to_wall * dot(h, h)) {
        move.end = past < 0 ? End::inside : End::beyond;
    }
    return move;
}

/// The best move of an SCP in contact on one wall. A projection that ends on the wall lies in the
/// cone of the other side, too, so it is never better than one that ends inside that side: mostly
/// the isosurface's two planes tell which side is better.
Move move_at_wall(const Site& site, unsigned on, const Vec3& h) {
    const auto wall = static_cast<unsigned>(std::countr_zero(on));
    const Tetrahedron& t = site.point.tetrahedron;
    const PlaneMove own = move_on_plane(t, site.sign * site.piece.gradient, wall, h, site.field);
    if (own.end == End::target) return {t, h, 0, own.gain, true};
    const Tetrahedron next = across(t, wall);
    const PlaneMove other =
        move_on_plane(next, site.excess_gradient_in(next), wall, reflect(h, wall), site.field);
    if (other.end == End::target) return {next, other.step, 0, other.gain, true};
    const bool stays = own.end == End::inside && other.end != End::close;
    const bool crosses = other.end == End::inside && own.end != End::close;
    if (crosses && !(stays && own.gain >= other.gain)) return {next, other.step, 0, other.gain};
    if (stays) return {t, own.step, 0, own.gain};
    return best_of_all(site, on, true, h);
}

}  // namespace

Move best_of_all(const Site& site, unsigned on, bool contact, const Vec3& h) {
    const Tetrahedron& own = site.point.tetrahedron;
    Move best = move_in(own, site.sign * site.piece.gradient, on, contact, h, site.field);
    if (best.straight) return best;
    const Vec3 h_index = unfold(own, h);
    bool first = true;
    int work = work_of_projection;
    for_each_incident(site.point, [&](const Tetrahedron& t) {
        if (std::exchange(first, false)) return false;  // its own is done
        const Move move =
            move_in(t, site.excess_gradient_in(t), on, contact, fold(t, h_index), site.field);
        work += work_of_projection;
        if (move.straight || move.gain > best.gain) best = move;
        return best.straight;
    });
    best.work = work;
    return best;
}

Move best_constrained_move(const Site& site, unsigned on, bool contact, const Vec3& h) {
    if (on == 0) return move_inside(site, h);
    const bool one_wall = (on & (on - 1)) == 0;
    return contact && one_wall ? move_at_wall(site, on, h) : best_of_all(site, on, contact, h);
}

}  // namespace palpate
