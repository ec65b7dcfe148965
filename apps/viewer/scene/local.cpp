// Tetrahedra at a point, cut by the isosurface.
#include "apps/viewer/scene/local.hpp"

#include <cmath>

namespace palpate::viewer {
namespace {

/// How near to the isovalue the density at the SCP has to be for it to lie on the surface, relative
/// to the data's range: a good deal more than the proxy's promise (G2).
constexpr double on_surface = 1e-6;

const std::array<Vec3, 4>& folded_corners() {
    static const std::array<Vec3, 4> corners{Vec3(0, 0, 0), Vec3(0.5, 0, 0), Vec3(0.5, 0.5, -0.5),
                                             Vec3(0.5, 0.5, 0.5)};
    return corners;
}

/// Where a linear field meets the isovalue, in the tetrahedron: on up to four edges, in turn.
std::vector<Vec3> patch_of(const std::array<Vec3, 4>& corners, const std::array<double, 4>& above) {
    std::vector<std::size_t> in, out;
    for (std::size_t i = 0; i < 4; ++i) (above[i] > 0 ? in : out).push_back(i);
    const auto between = [&](std::size_t a, std::size_t b) {
        const double t = above[a] / (above[a] - above[b]);
        return Vec3(corners[a] + t * (corners[b] - corners[a]));
    };
    if (in.empty() || out.empty()) return {};
    if (in.size() == 2) {
        return {between(in[0], out[0]), between(in[0], out[1]), between(in[1], out[1]),
                between(in[1], out[0])};
    }
    const bool one = in.size() == 1;
    const std::size_t tip = one ? in[0] : out[0];
    std::vector<Vec3> triangle;
    for (const std::size_t other : one ? out : in) {
        triangle.push_back(one ? between(tip, other) : between(other, tip));
    }
    return triangle;
}

}  // namespace

std::vector<LocalTetrahedron> local_tetrahedra(const Field& field, const LatticePoint& point,
                                               double isovalue) {
    const Geometry& g = field.geometry();
    const Vec3 scp = physical_from_index(g, index_of(point));
    const double off = std::abs(value_at(field, point) - isovalue) / field.range();
    std::vector<LocalTetrahedron> found;
    const Incident incident = incident_tetrahedra(point);
    for (std::size_t i = 0; i < static_cast<std::size_t>(incident.count); ++i) {
        const Tetrahedron& tetrahedron = incident.tetrahedra[i];
        const LinearPiece piece = piece_of(tetrahedron, field.cell(tetrahedron.cell));
        LocalTetrahedron local;
        std::array<double, 4> above{};
        for (std::size_t c = 0; c < 4; ++c) {
            const Vec3& folded = folded_corners()[c];
            local.corners[c] = physical_from_index(g, index_of({tetrahedron, folded}));
            above[c] = piece(folded) - isovalue;
        }
        local.patch = patch_of(local.corners, above);
        const Vec3 gradient =
            g.direction * unfold(tetrahedron, piece.gradient).cwiseQuotient(g.spacing);
        if (off <= on_surface && gradient.norm() > 0) {
            local.plane = ConstraintPlane{scp, -field.sign() * gradient.normalized()};
        }
        found.push_back(std::move(local));
    }
    return found;
}

}  // namespace palpate::viewer
