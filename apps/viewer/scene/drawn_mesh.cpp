// Vertex clustering (Rossignac and Borrel 1993): one pass, whatever the mesh is like.
#include "apps/viewer/scene/drawn_mesh.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

namespace palpate::viewer {
namespace {

using Eigen::Map;
using Eigen::Vector3f;

Vector3f at(const std::vector<float>& values, std::size_t i) {
    return Map<const Vector3f>(values.data() + 3 * i);
}

/// From keys to numbers 0, 1, 2, ... in the order in which they come.
class Numbering {
  public:
    explicit Numbering(std::size_t most) {
        std::size_t room = 16;
        while (room < 2 * most) room *= 2;
        slots_.resize(room, {0, -1});
    }
    std::int32_t number_of(std::uint64_t key) {
        std::size_t i = (key * 0x9E3779B97F4A7C15u) >> 20 & (slots_.size() - 1);
        while (slots_[i].number >= 0 && slots_[i].key != key) i = (i + 1) & (slots_.size() - 1);
        if (slots_[i].number < 0) slots_[i] = {key, count_++};
        return slots_[i].number;
    }
    std::size_t count() const { return static_cast<std::size_t>(count_); }

  private:
    struct Slot {
        std::uint64_t key;
        std::int32_t number;
    };
    std::vector<Slot> slots_;
    std::int32_t count_ = 0;
};

double area_of(const DrawnMesh& mesh) {
    double twice = 0;
    for (std::size_t t = 0; t < mesh.triangles.size(); t += 3) {
        const auto corner = [&](std::size_t c) {
            return at(mesh.positions, static_cast<std::size_t>(mesh.triangles[t + c]));
        };
        const Vector3f a = corner(0);
        twice += (corner(1) - a).cross(corner(2) - a).norm();
    }
    return 0.5 * twice;
}

/// The box of a grid, and the octant that the vertex faces: the two sides of a thin wall stay two.
std::uint64_t key_of(const Vector3f& p, const Vector3f& normal, float size) {
    std::uint64_t key = 0;
    for (int a = 0; a < 3; ++a) {
        const auto box = static_cast<std::int64_t>(std::floor(p[a] / size)) + (1 << 19);
        key = key << 21 | (static_cast<std::uint64_t>(box & ((1 << 20) - 1)) << 1) |
              std::uint64_t(normal[a] < 0);
    }
    return key;
}

/// The triangles that are still ones, each once.
void add_triangles(const DrawnMesh& mesh, const std::vector<std::int32_t>& cluster,
                   DrawnMesh& result) {
    std::vector<std::array<std::int32_t, 3>> kept;
    for (std::size_t t = 0; t < mesh.triangles.size(); t += 3) {
        const auto corner = [&](std::size_t i) {
            return cluster[static_cast<std::size_t>(mesh.triangles[t + i])];
        };
        const std::int32_t a = corner(0), b = corner(1), c = corner(2);
        if (a == b || b == c || a == c) continue;
        const std::int32_t least = std::min({a, b, c});  // first, and the turn stays
        kept.push_back(a == least ? std::array{a, b, c}
                                  : (b == least ? std::array{b, c, a} : std::array{c, a, b}));
    }
    std::ranges::sort(kept);
    kept.erase(std::unique(kept.begin(), kept.end()), kept.end());
    for (const auto& t : kept) result.triangles.insert(result.triangles.end(), t.begin(), t.end());
}

DrawnMesh clustered(const DrawnMesh& mesh, float size) {
    DrawnMesh result;
    std::vector<std::int32_t> cluster(mesh.vertex_count());
    std::vector<float> members;
    Numbering numbering(std::min<std::size_t>(mesh.vertex_count(), 1u << 24));
    for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
        const Vector3f p = at(mesh.positions, v), n = at(mesh.normals, v);
        cluster[v] = numbering.number_of(key_of(p, n, size));
        const auto c = static_cast<std::size_t>(cluster[v]);
        if (members.size() < numbering.count()) {
            members.push_back(0);
            result.positions.insert(result.positions.end(), 3, 0.0F);
            result.normals.insert(result.normals.end(), 3, 0.0F);
        }
        members[c] += 1;
        Map<Vector3f>(result.positions.data() + 3 * c) += p;
        Map<Vector3f>(result.normals.data() + 3 * c) += n;
    }
    for (std::size_t c = 0; c < members.size(); ++c) {
        Map<Vector3f>(result.positions.data() + 3 * c) /= members[c];
        Map<Vector3f>(result.normals.data() + 3 * c).normalize();
    }
    add_triangles(mesh, cluster, result);
    return result;
}

}  // namespace

DrawnMesh drawn_mesh(const pictures::Surface& surface, const Vec3& origin) {
    DrawnMesh drawn;
    drawn.positions.reserve(3 * surface.mesh.vertices.size());
    for (const Vec3& v : surface.mesh.vertices) {
        const Vector3f p = (v - origin).cast<float>();
        drawn.positions.insert(drawn.positions.end(), {p[0], p[1], p[2]});
    }
    drawn.normals.reserve(3 * surface.normals.size());
    for (const Vector3f& n : surface.normals) {
        drawn.normals.insert(drawn.normals.end(), {n[0], n[1], n[2]});
    }
    drawn.triangles.reserve(3 * surface.mesh.triangles.size());
    for (const auto& [a, b, c] : surface.mesh.triangles) {
        drawn.triangles.insert(drawn.triangles.end(),
                               {static_cast<std::int32_t>(a), static_cast<std::int32_t>(b),
                                static_cast<std::int32_t>(c)});
    }
    return drawn;
}

DrawnMesh simplified(const DrawnMesh& mesh, std::size_t most_triangles) {
    if (mesh.triangle_count() <= most_triangles) return mesh;
    constexpr int most_attempts = 12;
    // About three triangles a box that the surface goes through.
    const double most = static_cast<double>(std::max<std::size_t>(most_triangles, 1));
    double size = std::sqrt(3 * area_of(mesh) / most);
    for (int attempt = 0;; ++attempt) {
        DrawnMesh result = clustered(mesh, static_cast<float>(size));
        const auto count = static_cast<double>(result.triangle_count());
        if (count <= 1.25 * most || attempt == most_attempts) return result;
        size *= std::max(1.1, std::sqrt(count / most));
    }
}

DrawnMesh part_of(const DrawnMesh& mesh, std::size_t first, std::size_t last) {
    DrawnMesh part;
    if (first >= last) return part;
    const auto from = mesh.triangles.begin() + static_cast<std::ptrdiff_t>(3 * first);
    const auto to = mesh.triangles.begin() + static_cast<std::ptrdiff_t>(3 * last);
    std::vector<std::int32_t> used(from, to);
    std::ranges::sort(used);
    used.erase(std::unique(used.begin(), used.end()), used.end());
    for (const std::int32_t v : used) {
        const auto i = 3 * static_cast<std::ptrdiff_t>(v);
        part.positions.insert(part.positions.end(), mesh.positions.begin() + i,
                              mesh.positions.begin() + i + 3);
        part.normals.insert(part.normals.end(), mesh.normals.begin() + i,
                            mesh.normals.begin() + i + 3);
    }
    part.triangles.reserve(3 * (last - first));
    for (auto i = from; i != to; ++i) {
        part.triangles.push_back(
            static_cast<std::int32_t>(std::ranges::lower_bound(used, *i) - used.begin()));
    }
    return part;
}

}  // namespace palpate::viewer
