// The partition of a cell into 24 tetrahedra, with the triangles of the isosurface in each of them,
// made at compile time.
//
// A cell has 15 nodes (0-7 its corners, 8-13 the centres of its faces, 14 its own) and 50 edges
// between them. 29 edges are the cell's own; the other 21 lie on its three lower faces, and the
// neighbouring cells there have handled them.
#pragma once

#include "palpate/surface.hpp"

namespace palpate::marching {

inline constexpr int node_count = 15;
inline constexpr int edge_count = 50;
inline constexpr int own_count = 29;
inline constexpr int tetrahedron_count = 24;
inline constexpr int centre_node = 14;
constexpr int face_node(int axis, int side) {
    return 8 + 2 * axis + side;
}

using Node = std::uint8_t;
using Edge = std::uint8_t;

/// Corner q (0-3) of a face; the same q lies opposite on both sides of the cell.
constexpr int corner_of_face(int axis, int side, int q) {
    const int low = (1 << axis) - 1;
    return (q & low) | side << axis | (q & ~low) << 1;
}

/// The triangles of the isosurface in one tetrahedron.
struct Cut {
    std::uint8_t triangles = 0;  // 0, 1 or 2
    std::array<Edge, 6> edges{};
};

/// The partition of a cell.
struct Partition {
    std::array<std::array<Node, 2>, edge_count> edges{};
    std::array<std::array<std::array<Edge, 8>, 2>, 3> of_face{};  // [axis][side], matching order
    std::array<Edge, own_count> own{};  // edges on none of the lower faces
    std::array<std::array<Node, 4>, tetrahedron_count> tetrahedra{};  // all of one handedness
    std::array<std::array<Cut, 16>, tetrahedron_count> cuts{};
    std::array<std::array<Edge, node_count>, node_count> between{};
};

constexpr void add_edges(Partition& p) {
    int count = 0;
    const auto edge = [&](int a, int b) {
        if (p.between[a][b] == edge_count) {
            p.edges[count] = {static_cast<Node>(a), static_cast<Node>(b)};
            p.between[a][b] = p.between[b][a] = static_cast<Edge>(count++);
        }
        return p.between[a][b];
    };
    for (auto& row : p.between) row.fill(edge_count);
    for (int side = 0; side < 2; ++side) {  // lower faces first: their 21 edges get the low numbers
        for (int axis = 0; axis < 3; ++axis) {
            auto& face = p.of_face[axis][side];
            const auto corner = [&](int q) { return corner_of_face(axis, side, q); };
            face[0] = edge(corner(0), corner(1));
            face[1] = edge(corner(2), corner(3));
            face[2] = edge(corner(0), corner(2));
            face[3] = edge(corner(1), corner(3));
            for (int q = 0; q < 4; ++q) face[4 + q] = edge(corner(q), face_node(axis, side));
        }
    }
    for (int node = 0; node < centre_node; ++node) edge(node, centre_node);
    for (int i = 0; i < own_count; ++i) p.own[i] = static_cast<Edge>(edge_count - own_count + i);
}

constexpr void add_tetrahedra(Partition& p) {
    int count = 0;
    for (int d = 0; d < 3; ++d) {
        for (int s = 0; s < 3; ++s) {
            if (s == d) continue;
            const int e = 3 - d - s;
            for (int sides = 0; sides < 4; ++sides) {
                const int minus = (sides & 1) << d | (sides >> 1) << s;
                const int plus = minus | 1 << e;
                const int face = face_node(d, sides & 1);
                // det(face, minus, plus) from the centre is 2 sign_d sign_s det(d, s, e).
                const bool right_handed =
                    ((s - d + 3) % 3 == 1) == (((sides & 1) != 0) == ((sides >> 1) != 0));
                p.tetrahedra[count++] = {static_cast<Node>(centre_node), static_cast<Node>(face),
                                         static_cast<Node>(right_handed ? minus : plus),
                                         static_cast<Node>(right_handed ? plus : minus)};
            }
        }
    }
}

/// The cut of a tetrahedron of the cell, as triangles. All tetrahedra are right-handed.
constexpr Cut cut_at(const Partition& p, const std::array<Node, 4>& node, unsigned solid) {
    const TetrahedronCut cut = cut_of(solid);
    if (cut.count == 0) return {};
    std::array<Edge, 4> edges{};
    for (int i = 0; i < cut.count; ++i) {
        edges[i] = p.between[node[cut.edges[i].solid]][node[cut.edges[i].free]];
    }
    const auto [a, b, c, d] = edges;
    if (cut.count == 3) return {1, {a, b, c}};
    return {2, {a, b, c, a, c, d}};
}

constexpr Partition cut_cell() {
    Partition p;
    add_edges(p);
    add_tetrahedra(p);
    for (int t = 0; t < tetrahedron_count; ++t) {
        for (unsigned solid = 0; solid < 16; ++solid) {
            p.cuts[t][solid] = cut_at(p, p.tetrahedra[t], solid);
        }
    }
    return p;
}

inline constexpr Partition partition = cut_cell();

/// Position of a node in its cell, in half voxels.
inline Vec3 node_position(int node) {
    if (node == centre_node) return {1, 1, 1};
    if (node < 8) return Vec3(node & 1, node >> 1 & 1, node >> 2 & 1) * 2;
    Vec3 at(1, 1, 1);
    at[(node - 8) / 2] = 2 * (node & 1);
    return at;
}

}  // namespace palpate::marching
