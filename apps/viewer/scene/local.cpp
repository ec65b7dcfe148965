// Finds the tetrahedra at a point and cuts them with the isosurface.
#include "apps/viewer/scene/local.hpp"

#include <cmath>

#include "palpate/surface.hpp"

namespace palpate::viewer {
namespace {

/// How near to the isovalue the density at the SCP has to be for it to lie on the surface, relative
/// to the data's range: a good deal more than the proxy's promise (G2).
constexpr double on_surface = 1e-6;

/// Where a linear field with these values at the corners meets the isovalue, in the tetrahedron: on
/// up to four edges, in turn.
std::vector<Vec3> patch_of(const std::array<Vec3, 4>& corners, const std::array<double, 4>& above) {
    unsigned solid = 0;
    for (std::size_t i = 0; i < 4; ++i) solid |= unsigned{above[i] > 0} << i;
    const TetrahedronCut cut = cut_of(solid);
    std::vector<Vec3> patch;
    for (std::size_t i = 0; i < static_cast<std::size_t>(cut.count); ++i) {
        const auto [a, b] = cut.edges[i];
        const double t = above[a] / (above[a] - above[b]);
        patch.emplace_back(corners[a] + t * (corners[b] - corners[a]));
    }
    return patch;
}

}  // namespace

std::vector<LocalTetrahedron> local_tetrahedra(const Field& field, const LatticePoint& point,
                                               double isovalue) {
    const Geometry& g = field.geometry();
    const Interpolation way = field.interpolation();
    const Vec3 scp = physical_from_index(g, index_of(way, point));
    const double off = std::abs(value_at(field, point) - isovalue) / field.range();
    std::vector<LocalTetrahedron> found;
    const Incident incident = incident_tetrahedra(point);
    for (std::size_t i = 0; i < static_cast<std::size_t>(incident.count); ++i) {
        const Tetrahedron& tetrahedron = incident.tetrahedra[i];
        LocalTetrahedron local;
        std::array<double, 4> above{};
        for (std::size_t c = 0; c < 4; ++c) {
            const auto [d, s, e] = folded_corners[c];
            const Vec3 folded(d, s, e);
            const LatticePoint corner{tetrahedron, folded};
            local.corners[c] = physical_from_index(g, index_of(way, corner));
            above[c] = value_at(field, corner) - isovalue;
        }
        local.patch = patch_of(local.corners, above);
        const Vec3 gradient =
            g.direction *
            gradient_at(field, LatticePoint{tetrahedron, point.folded}).cwiseQuotient(g.spacing);
        if (off <= on_surface && gradient.norm() > 0) {
            local.plane = ConstraintPlane{scp, -field.sign() * gradient.normalized()};
        }
        found.push_back(std::move(local));
    }
    return found;
}

}  // namespace palpate::viewer
