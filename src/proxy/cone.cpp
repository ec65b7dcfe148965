// Projection on a convex cone of few half-spaces: tries candidates by the dimension of their face.
#include "proxy/cone.hpp"

#include <cmath>

namespace palpate {
namespace {

/// By how much rounding may carry a candidate beyond another half-space, relative to |normal| |h|.
constexpr double slack_of_feasible = 1e-13;
/// Two normals with a smaller sine between them count as one plane.
constexpr double least_sine = 1e-12;

template <int Most>
bool feasible(const Vec3& p, const HalfSpaces<Most>& cone, double h_length, int skip_a,
              int skip_b) {
    for (int i = 0; i < cone.count; ++i) {
        if (i == skip_a || i == skip_b) continue;
        const Vec3& n = cone.normal[i];
        const double above = dot(n, p);
        if (above > 0 && above > slack_of_feasible * std::sqrt(dot(n, n)) * h_length) return false;
    }
    return true;
}

}  // namespace

template <int Most>
ConeProjection project_on_cone(const Vec3& h, const HalfSpaces<Most>& cone) {
    std::array<double, Most> pull;  // n . h
    bool inside = true;
    for (int i = 0; i < cone.count; ++i) {
        pull[i] = dot(cone.normal[i], h);
        inside &= pull[i] <= 0;
    }
    if (inside) return {h, {-1, -1}};
    if (cone.count == 1) {  // inside a tetrahedron, in contact: the common case
        const Vec3& n = cone.normal[0];
        return {h - n * (pull[0] / dot(n, n)), {0, -1}};
    }
    const double length = std::sqrt(dot(h, h));

    ConeProjection best;
    double best_gain = 0;
    const auto offer = [&](const Vec3& p, int i, int j) {
        const double gain = dot(p, p);
        if (gain <= best_gain || !feasible(p, cone, length, i, j)) return;
        best = {p, {i, j}};
        best_gain = gain;
    };
    for (int i = 0; i < cone.count; ++i) {
        if (pull[i] <= 0) continue;
        const Vec3& n = cone.normal[i];
        offer(h - n * (pull[i] / dot(n, n)), i, -1);
    }
    // A face has at least the dimension of the face it borders, so what projects on a plane
    // feasibly is at least as long as anything on a line: lines only count if no plane did.
    if (best_gain > 0) return best;
    for (int i = 0; i + 1 < cone.count; ++i) {
        const Vec3 e1 = cone.normal[i] / std::sqrt(dot(cone.normal[i], cone.normal[i]));
        for (int j = i + 1; j < cone.count; ++j) {
            // Orthogonalised twice: then both half-spaces hold to rounding however close to
            // parallel their normals are (a cross product loses digits there).
            const Vec3& n = cone.normal[j];
            Vec3 e2 = n - e1 * dot(e1, n);
            e2 -= e1 * dot(e1, e2);
            const double sine = std::sqrt(dot(e2, e2));
            if (sine <= least_sine * std::sqrt(dot(n, n))) continue;
            e2 /= sine;
            Vec3 p = h - e1 * dot(e1, h);
            p -= e2 * dot(e2, p);
            offer(p, i, j);
        }
    }
    return best;
}

template ConeProjection project_on_cone(const Vec3&, const HalfSpaces<4>&);
template ConeProjection project_on_cone(const Vec3&, const HalfSpaces<48>&);

}  // namespace palpate
