// Finds the tetrahedra at a point and cuts them with the isosurface.
#include "apps/viewer/scene/local.hpp"

#include <algorithm>
#include <cmath>

#include "apps/viewer/scene/surface_blocks.hpp"
#include "palpate/surface.hpp"

namespace palpate::viewer {
namespace {

/// How near to the isovalue the density at the SCP has to be for it to lie on the surface, relative
/// to the data's range: a good deal more than the proxy's promise (G2).
constexpr double on_surface = 1e-6;

/// A cubic field's tetrahedron is cut in so many parts along each edge.
constexpr int parts = 4;

/// The parts of a tetrahedron, n^3 of one shape class and size, by their corners in steps along its
/// edges 0-1, 1-2 and 2-3.
std::vector<std::array<Index3, 4>> parts_of(int n) {
    std::vector<std::array<Index3, 4>> all;
    for (int i = 0; i < n * n * n; ++i) {
        std::array<int, 3> order{0, 1, 2};
        do {
            std::array<Index3, 4> part{Index3(i % n, i / n % n, i / (n * n))};
            for (std::size_t step = 0; step < 3; ++step) {
                part[step + 1] = part[step];
                ++part[step + 1][order[step]];
            }
            if (std::ranges::all_of(part,
                                    [](const Index3& c) { return c[0] >= c[1] && c[1] >= c[2]; })) {
                all.push_back(part);
            }
        } while (std::ranges::next_permutation(order).found);
    }
    return all;
}

/// The isosurface in the tetrahedron, in folded coordinates.
class Patch {
  public:
    Patch(const Field& field, const Tetrahedron& tetrahedron, double isovalue)
        : field_(field), tetrahedron_(tetrahedron), isovalue_(isovalue) {}

    std::vector<std::vector<Vec3>> polygons() const {
        const int n = field_.interpolation() == Interpolation::cubic ? parts : 1;
        const auto corner = [](std::size_t i) {
            const auto [d, s, e] = folded_corners[i];
            return Vec3(d, s, e);
        };
        std::vector<std::vector<Vec3>> found;
        for (const auto& part : parts_of(n)) {
            std::array<Vec3, 4> corners;
            for (std::size_t c = 0; c < 4; ++c) {
                corners[c] = corner(0);
                for (std::size_t a = 0; a < 3; ++a) {
                    corners[c] += (corner(a + 1) - corner(a)) * part[c][int(a)] / n;
                }
            }
            if (std::vector<Vec3> polygon = cut(corners); !polygon.empty()) {
                found.push_back(std::move(polygon));
            }
        }
        return found;
    }

  private:
    double above(const Vec3& folded) const {
        return value_at(field_, LatticePoint{tetrahedron_, folded}) - isovalue_;
    }
    std::vector<Vec3> cut(const std::array<Vec3, 4>& corners) const {
        std::array<double, 4> value{};
        unsigned solid = 0;
        for (std::size_t i = 0; i < 4; ++i) {
            value[i] = above(corners[i]);
            solid |= unsigned{value[i] > 0} << i;
        }
        const TetrahedronCut cut = cut_of(solid);
        std::vector<Vec3> polygon;
        for (std::size_t i = 0; i < static_cast<std::size_t>(cut.count); ++i) {
            const auto [a, b] = cut.edges[i];
            polygon.push_back(root(corners[a], value[a], corners[b], value[b]));
        }
        return polygon;
    }
    /// By false position: one step is exact on a linear field.
    Vec3 root(Vec3 a, double at_a, Vec3 b, double at_b) const {
        for (int i = 0;; ++i) {
            const Vec3 middle = a + at_a / (at_a - at_b) * (b - a);
            const double value = above(middle);
            if (i == 8 || std::abs(value) <= 1e-9 * field_.range()) return middle;
            if ((value > 0) == (at_a > 0)) {
                a = middle, at_a = value;
            } else {
                b = middle, at_b = value;
            }
        }
    }

    const Field& field_;
    const Tetrahedron& tetrahedron_;
    double isovalue_;
};

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
        const auto place = [&](const Vec3& folded) {
            return physical_from_index(g, index_of(way, LatticePoint{tetrahedron, folded}));
        };
        for (std::size_t c = 0; c < 4; ++c) {
            const auto [d, s, e] = folded_corners[c];
            local.corners[c] = place({d, s, e});
        }
        local.patch = Patch(field, tetrahedron, isovalue).polygons();
        for (auto& polygon : local.patch) std::ranges::transform(polygon, polygon.begin(), place);
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

std::shared_ptr<const RenderMesh> local_patch(const Field& field, const Vec3& physical,
                                              double isovalue) {
    constexpr int edge = 24;  // [cells]
    const Geometry& g = field.geometry();
    const Vec3 index = index_from_physical(g, physical);
    if (!(index.cwiseAbs().maxCoeff() <= farthest_index)) return nullptr;
    const Vec3 first = (index - Vec3::Constant(0.5 * edge)).array().round();
    const Vec3 middle = physical_centre(g);
    const auto block = block_mesh(field, isovalue, first.cast<int>(), edge, middle);
    if (!block) return nullptr;
    // Round, not a cube's shape.
    const double radius = (0.5 * edge - 1) * g.spacing.minCoeff();
    auto patch = std::make_shared<RenderMesh>(*block);
    patch->triangles.clear();
    const auto inside = [&](std::int32_t v) {
        const float* const at = patch->positions.data() + 3 * static_cast<std::size_t>(v);
        return (Vec3(at[0], at[1], at[2]) + middle - physical).norm() < radius;
    };
    for (std::size_t t = 0; t + 2 < block->triangles.size(); t += 3) {
        const std::int32_t* const corners = block->triangles.data() + t;
        if (std::all_of(corners, corners + 3, inside)) {
            patch->triangles.insert(patch->triangles.end(), corners, corners + 3);
        }
    }
    return patch->triangles.empty() ? nullptr : patch;
}

}  // namespace palpate::viewer
