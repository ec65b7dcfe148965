// Lattice: 24 tetrahedra a cell, walked by reflections. See docs/lattice.md.
#include "palpate/lattice.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace palpate {
namespace {

constexpr bool has(unsigned mask, unsigned wall) {
    return mask >> wall & 1;
}

}  // namespace

bool same_tetrahedron(const Tetrahedron& a, const Tetrahedron& b) {
    return a.cell == b.cell && a.axis == b.axis && a.sign[0] == b.sign[0] && a.sign[1] == b.sign[1];
}

LatticePoint locate(const Vec3& index) {
    LatticePoint point;
    auto& [cell, axis, sign] = point.tetrahedron;
    Vec3 size;
    for (int a = 0; a < 3; ++a) {
        const double low = std::floor(index[a]);
        cell[a] = static_cast<int>(low);
        const double offset = index[a] - low - 0.5;
        sign[a] = std::signbit(offset) ? -1 : 1;
        size[a] = std::abs(offset);
    }
    const auto order = [&](int i, int j) {
        if (size[axis[i]] < size[axis[j]]) std::swap(axis[i], axis[j]);
    };
    order(0, 1);
    order(1, 2);
    order(0, 1);
    const auto unordered = sign;
    for (int i = 0; i < 3; ++i) {
        sign[i] = unordered[axis[i]];
        point.folded[i] = size[axis[i]];
    }
    return point;
}

Vec3 index_of(const LatticePoint& point) {
    const auto& [cell, axis, sign] = point.tetrahedron;
    Vec3 index;
    for (int i = 0; i < 3; ++i) {
        index[axis[i]] = cell[axis[i]] + (0.5 + sign[i] * point.folded[i]);
    }
    return index;
}

Vec3 difference(const LatticePoint& to, const LatticePoint& from) {
    return (to.tetrahedron.cell - from.tetrahedron.cell).cast<double>() +
           (unfold(to.tetrahedron, to.folded) - unfold(from.tetrahedron, from.folded));
}

Vec3 fold(const Tetrahedron& t, const Vec3& v) {
    return {t.sign[0] * v[t.axis[0]], t.sign[1] * v[t.axis[1]], t.sign[2] * v[t.axis[2]]};
}

Vec3 unfold(const Tetrahedron& t, const Vec3& folded) {
    Vec3 v;
    for (int i = 0; i < 3; ++i) v[t.axis[i]] = t.sign[i] * folded[i];
    return v;
}

Vec3 fold_lengths(const Tetrahedron& t, const Vec3& lengths) {
    return {lengths[t.axis[0]], lengths[t.axis[1]], lengths[t.axis[2]]};
}

LinearPiece piece_of(const Tetrahedron& t, const CellSamples& f) {
    const auto bit = [&](int i) { return (t.sign[i] > 0 ? 1U : 0U) << t.axis[i]; };
    const unsigned step_s = 1U << t.axis[1];
    const unsigned step_e = 1U << t.axis[2];
    const unsigned plus = bit(0) | bit(1) | bit(2);  // the edge's end towards +e
    const unsigned minus = plus ^ step_e;
    const double edge_sum = f[plus] + f[minus];
    const double face = (edge_sum + (f[plus ^ step_s] + f[minus ^ step_s])) * 0.25;
    const double centre =
        (((f[0] + f[1]) + (f[2] + f[3])) + ((f[4] + f[5]) + (f[6] + f[7]))) * 0.125;
    return {centre, {2 * (face - centre), 2 * (0.5 * edge_sum - face), f[plus] - f[minus]}};
}

Vec3 wall_normal(unsigned wall) {
    switch (wall) {
        case wall_face:
            return {1, 0, 0};
        case wall_edge:
            return {-1, 1, 0};
        case wall_plus:
            return {0, -1, 1};
        default:
            return {0, -1, -1};
    }
}

unsigned walls_at(const Vec3& u) {
    return unsigned(u[0] == 0.5) | unsigned(u[0] == u[1]) << wall_edge |
           unsigned(u[1] == u[2]) << wall_plus | unsigned(u[1] == -u[2]) << wall_minus;
}

Vec3 snap(const Vec3& folded, unsigned walls) {
    auto [d, s, e] = std::array{folded[0], folded[1], folded[2]};
    d = has(walls, wall_face) ? 0.5 : std::clamp(d, 0.0, 0.5);
    s = std::clamp(s, 0.0, d);
    if (has(walls, wall_plus) && has(walls, wall_minus)) {
        if (has(walls, wall_edge)) d = 0;
        return {d, 0, 0};
    }
    if (has(walls, wall_edge)) s = d;
    e = std::clamp(e, -s, s);
    if (has(walls, wall_plus)) e = s;
    if (has(walls, wall_minus)) e = -s;
    return {d, s, e};
}

Tetrahedron across(const Tetrahedron& t, unsigned wall) {
    Tetrahedron next = t;
    switch (wall) {
        case wall_face:
            next.cell[t.axis[0]] += t.sign[0];
            next.sign[0] = static_cast<std::int8_t>(-t.sign[0]);
            break;
        case wall_edge:
            std::swap(next.axis[0], next.axis[1]);
            std::swap(next.sign[0], next.sign[1]);
            break;
        case wall_plus:
            std::swap(next.axis[1], next.axis[2]);
            std::swap(next.sign[1], next.sign[2]);
            break;
        default:
            std::swap(next.axis[1], next.axis[2]);
            next.sign[1] = static_cast<std::int8_t>(-t.sign[2]);
            next.sign[2] = static_cast<std::int8_t>(-t.sign[1]);
            break;
    }
    return next;
}

Vec3 reflect(const Vec3& v, unsigned wall) {
    switch (wall) {
        case wall_face:
            return {-v[0], v[1], v[2]};
        case wall_edge:
            return {v[1], v[0], v[2]};
        case wall_plus:
            return {v[0], v[2], v[1]};
        default:
            return {v[0], -v[2], -v[1]};
    }
}

Incident incident_tetrahedra(const LatticePoint& point) {
    Incident found;
    found.tetrahedra[found.count++] = point.tetrahedron;
    const unsigned walls = walls_at(point.folded);
    if (walls == 0) return found;
    // The mirrors through the point generate the group that permutes its tetrahedra, and leave its
    // folded coordinates alone, so the same walls serve in every one of them.
    for (int i = 0; i < found.count; ++i) {
        for (unsigned wall = 0; wall < wall_count; ++wall) {
            if (!has(walls, wall)) continue;
            const Tetrahedron next = across(found.tetrahedra[i], wall);
            const auto end = found.tetrahedra.begin() + found.count;
            const bool known = std::any_of(found.tetrahedra.begin(), end, [&](const auto& t) {
                return same_tetrahedron(t, next);
            });
            if (!known) found.tetrahedra[found.count++] = next;
        }
    }
    return found;
}

double value_at(const Field& field, const LatticePoint& point) {
    const auto& tetrahedron = point.tetrahedron;
    return piece_of(tetrahedron, field.cell(tetrahedron.cell))(point.folded);
}

double value_at(const Field& field, const Vec3& physical) {
    const Vec3 index = index_from_physical(field.geometry(), physical);
    if (!(index.cwiseAbs().maxCoeff() <= farthest_index)) return field.background();
    return value_at(field, locate(index));
}

Vec3 gradient_at(const Field& field, const Vec3& physical) {
    const Vec3 index = index_from_physical(field.geometry(), physical);
    if (!(index.cwiseAbs().maxCoeff() <= farthest_index)) return Vec3::Zero();
    const auto tetrahedron = locate(index).tetrahedron;
    const LinearPiece piece = piece_of(tetrahedron, field.cell(tetrahedron.cell));
    const Vec3 per_mm = unfold(tetrahedron, piece.gradient).cwiseQuotient(field.geometry().spacing);
    return physical_from_grid_axes(field.geometry(), per_mm);
}

}  // namespace palpate
