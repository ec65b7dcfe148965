// Splitting of edges: a triangle becomes two, three or four.
#include "surface/refine.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <unordered_map>

#include "palpate/field.hpp"

namespace palpate::marching {
namespace {

constexpr int most_rounds = 8;
constexpr std::uint32_t none = 0xffffffff;
using Triangle = std::array<std::uint32_t, 3>;

class Refinement {
  public:
    Refinement(SurfaceMesh& mesh, const Field& field, double isovalue, double tolerance,
               std::uint64_t max_vertices)
        : mesh_(mesh),
          field_(field),
          isovalue_(isovalue),
          tolerance_(tolerance),
          max_vertices_(max_vertices) {}

    /// Only what was split may have to be split again: all other edges are as they should be.
    bool run(const std::function<bool(double)>& progress) {
        constexpr std::uint64_t between_reports = 4096;  // triangles
        std::uint64_t seen = 0;
        std::vector<Triangle> done;
        std::vector<Triangle> fresh = std::move(mesh_.triangles);
        for (int round = 0; round < most_rounds && !fresh.empty(); ++round) {
            middle_.clear();
            std::vector<Triangle> next;
            for (const Triangle& triangle : fresh) {
                if (seen++ % between_reports == 0 && progress && !progress(1)) return false;
                Triangle middle;
                for (int i = 0; i < 3; ++i) {
                    middle[i] = middle_of(triangle[i], triangle[(i + 1) % 3]);
                }
                if (middle == Triangle{none, none, none}) {
                    done.push_back(triangle);
                } else {
                    split(triangle, middle, next);
                }
            }
            fresh = std::move(next);
        }
        done.insert(done.end(), fresh.begin(), fresh.end());
        mesh_.triangles = std::move(done);
        return true;
    }

  private:
    /// The vertex that splits the edge, or none.
    std::uint32_t middle_of(std::uint32_t a, std::uint32_t b) {
        const std::uint64_t edge = std::uint64_t{std::min(a, b)} << 32 | std::max(a, b);
        const auto [found, is_new] = middle_.try_emplace(edge, none);
        if (!is_new) return found->second;
        const Vec3 &p = mesh_.vertices[a], &q = mesh_.vertices[b];
        const Vec3 straight = 0.5 * (p + q);
        const Vec3 middle = onto_surface(straight, 0.5 * (q - p).norm());
        if (!((middle - straight).norm() > tolerance_)) return none;
        if (mesh_.vertices.size() >= max_vertices_) {
            throw std::length_error("with this tolerance the isosurface has more than " +
                                    std::to_string(max_vertices_) + " vertices: take a larger one");
        }
        found->second = static_cast<std::uint32_t>(mesh_.vertices.size());
        mesh_.vertices.push_back(middle);
        return found->second;
    }
    /// By Newton's method along the gradient; the point itself if that leads farther than `most`.
    Vec3 onto_surface(const Vec3& point, double most) const {
        Vec3 at = point;
        const double enough = 1e-12 * field_.range();
        for (int i = 0; i < 12; ++i) {
            const double value = value_at(field_, at) - isovalue_;
            if (std::abs(value) <= enough) return at;
            const Vec3 gradient = gradient_at(field_, at);
            if (!(gradient.squaredNorm() > 0)) return point;
            at -= value / gradient.squaredNorm() * gradient;
            if ((at - point).norm() > most) return point;
        }
        return std::abs(value_at(field_, at) - isovalue_) <= 1e-10 * field_.range() ? at : point;
    }
    static void split(const Triangle& t, const Triangle& middle, std::vector<Triangle>& into) {
        const int count = (middle[0] != none) + (middle[1] != none) + (middle[2] != none);
        if (count == 3) {
            into.push_back({t[0], middle[0], middle[2]});
            into.push_back({middle[0], t[1], middle[1]});
            into.push_back({middle[2], middle[1], t[2]});
            into.push_back(middle);
            return;
        }
        // Turned so that the first edge is split, and of two the second as well.
        int first = 0;
        while (middle[first] == none || (count == 2 && middle[(first + 1) % 3] == none)) ++first;
        const auto [a, b, c] = Triangle{t[first], t[(first + 1) % 3], t[(first + 2) % 3]};
        const std::uint32_t ab = middle[first], bc = middle[(first + 1) % 3];
        if (count == 1) {
            into.push_back({a, ab, c});
            into.push_back({ab, b, c});
            return;
        }
        into.push_back({ab, b, bc});
        into.push_back({a, ab, bc});
        into.push_back({a, bc, c});
    }

    SurfaceMesh& mesh_;
    const Field& field_;
    double isovalue_, tolerance_;
    std::uint64_t max_vertices_;
    std::unordered_map<std::uint64_t, std::uint32_t> middle_;  // of an edge, its lesser end first
};

}  // namespace

bool refine(SurfaceMesh& mesh, const Field& field, double isovalue, double tolerance,
            const SurfaceOptions& options) {
    const std::uint64_t most = std::min<std::uint64_t>(options.max_vertices, none);
    return Refinement(mesh, field, isovalue, tolerance, most).run(options.progress);
}

}  // namespace palpate::marching
