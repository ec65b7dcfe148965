// All vertices first; then the triangles that could still be nearer.
#include "evaluation/fidelity/nearest_point.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace palpate::evaluation {
namespace {

Vec3 nearest_on_edge(const Vec3& a, const Vec3& b, const Vec3& from) {
    const Vec3 along = b - a;
    const double squared = along.squaredNorm();
    const double part = squared > 0 ? std::clamp(along.dot(from - a) / squared, 0.0, 1.0) : 0;
    return a + part * along;
}

}  // namespace

Vec3 nearest_in_triangle(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& from) {
    const Vec3 normal = (b - a).cross(c - a);
    const auto is_left_of = [&](const Vec3& p, const Vec3& q) {
        return (q - p).cross(from - p).dot(normal) >= 0;
    };
    if (normal.squaredNorm() > 0 && is_left_of(a, b) && is_left_of(b, c) && is_left_of(c, a)) {
        return from - normal * (normal.dot(from - a) / normal.squaredNorm());
    }
    Vec3 best = nearest_on_edge(a, b, from);
    for (const Vec3& other : {nearest_on_edge(b, c, from), nearest_on_edge(c, a, from)}) {
        if ((other - from).squaredNorm() < (best - from).squaredNorm()) best = other;
    }
    return best;
}

Vec3 nearest_point(const SurfaceMesh& mesh, const Vec3& from) {
    if (mesh.triangles.empty())
        throw std::invalid_argument("an empty surface has no nearest point");
    double least = std::numeric_limits<double>::infinity();
    Vec3 best = Vec3::Zero();
    for (const Vec3& vertex : mesh.vertices) {
        const double squared = (vertex - from).squaredNorm();
        if (squared >= least) continue;
        least = squared;
        best = vertex;
    }
    for (const auto& [a, b, c] : mesh.triangles) {
        const Vec3 &p = mesh.vertices[a], &q = mesh.vertices[b], &r = mesh.vertices[c];
        const double longest = std::sqrt(std::max((q - p).squaredNorm(), (r - p).squaredNorm()));
        const double reach = std::sqrt(least) + longest;
        if ((p - from).squaredNorm() > reach * reach) continue;
        const Vec3 point = nearest_in_triangle(p, q, r, from);
        const double squared = (point - from).squaredNorm();
        if (squared >= least) continue;
        least = squared;
        best = point;
    }
    return best;
}

}  // namespace palpate::evaluation
