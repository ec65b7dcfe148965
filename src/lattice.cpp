// Lattice: 24 tetrahedra per cell, walked by reflections. See docs/lattice.md.
#include "palpate/lattice.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace palpate {

LatticePoint locate(const Vec3& index) {
    LatticePoint point;
    auto& cell = point.tetrahedron.cell;
    auto& axis = point.tetrahedron.axis;
    auto& sign = point.tetrahedron.sign;
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

Incident incident_tetrahedra(const LatticePoint& point) {
    Incident found;
    found.tetrahedra[found.count++] = point.tetrahedron;
    const unsigned walls = walls_at(point.folded);
    if (walls == 0) return found;
    // The mirrors through the point generate the group that permutes its tetrahedra. They leave its
    // folded coordinates as they are, so the point is on the same walls in each of them.
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

}  // namespace palpate
