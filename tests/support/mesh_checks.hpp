// Slow, obvious checks of triangle meshes: closed, oriented, and inside or outside by a ray.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include "palpate/surface.hpp"

namespace palpate::support {

/// Empty if every edge has exactly two triangles in opposite directions and no triangle names a
/// vertex twice; else what is wrong.
inline std::string flaw_in_closed_mesh(const SurfaceMesh& mesh) {
    std::vector<std::uint64_t> edges;
    edges.reserve(mesh.triangles.size() * 3);
    for (const auto& triangle : mesh.triangles) {
        for (int i = 0; i < 3; ++i) {
            const std::uint64_t a = triangle[i];
            const std::uint64_t b = triangle[(i + 1) % 3];
            if (a >= mesh.vertices.size()) return "a triangle names a vertex that is not there";
            if (a == b) return "a triangle names vertex " + std::to_string(a) + " twice";
            edges.push_back(a << 32 | b);
        }
    }
    std::sort(edges.begin(), edges.end());
    if (std::adjacent_find(edges.begin(), edges.end()) != edges.end()) {
        return "two triangles run along an edge in the same direction";
    }
    for (const std::uint64_t edge : edges) {
        if (!std::binary_search(edges.begin(), edges.end(), edge << 32 | edge >> 32)) {
            return "an edge has one triangle only";
        }
    }
    return {};
}

/// The mesh as a reader of a file without indices and with 32-bit floats gets it: vertices at the
/// same place are one.
inline SurfaceMesh welded_as_float(const SurfaceMesh& mesh) {
    SurfaceMesh welded;
    std::map<std::array<float, 3>, std::uint32_t> known;
    std::vector<std::uint32_t> id;
    for (const Vec3& v : mesh.vertices) {
        const std::array<float, 3> key{float(v[0]), float(v[1]), float(v[2])};
        const auto [it, is_new] = known.try_emplace(key, std::uint32_t(welded.vertices.size()));
        if (is_new) welded.vertices.push_back(Vec3(key[0], key[1], key[2]));
        id.push_back(it->second);
    }
    for (const auto& [a, b, c] : mesh.triangles) welded.triangles.push_back({id[a], id[b], id[c]});
    return welded;
}

/// How often the mesh winds around a point: 1 inside a body, 0 outside. Counts signed crossings of
/// a ray; the ray must not meet an edge, so choose points and ray at random.
inline int winding(const SurfaceMesh& mesh, const Vec3& point, const Vec3& ray) {
    int crossings = 0;
    for (const auto& [a, b, c] : mesh.triangles) {
        const Vec3 p = mesh.vertices[a] - point;
        const Vec3 q = mesh.vertices[b] - point;
        const Vec3 r = mesh.vertices[c] - point;
        const double pq = ray.dot(p.cross(q));
        const double qr = ray.dot(q.cross(r));
        const double rp = ray.dot(r.cross(p));
        const bool leaves = pq > 0 && qr > 0 && rp > 0;
        const bool enters = pq < 0 && qr < 0 && rp < 0;
        if (!leaves && !enters) continue;
        const bool ahead = (p.dot(q.cross(r)) > 0) == leaves;
        if (ahead) crossings += leaves ? 1 : -1;
    }
    return crossings;
}

}  // namespace palpate::support
