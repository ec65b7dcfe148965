// The points of a tool that is given as a mesh: evenly over its surface, corners and edges first.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <stdexcept>
#include <unordered_map>
#include <utility>

#include "mesh_tool/joined.hpp"

namespace palpate {
namespace {

using MeshEdge = std::pair<std::uint32_t, std::uint32_t>;

/// In parts of the spacing: points keep this distance from each other, and there is a candidate
/// within two thirds of that one of every place, so that no place is farther than the spacing from
/// a point.
constexpr double distance_of_points = 0.75, candidate_step = 1.0 / 3;
static_assert(distance_of_points + candidate_step * 2 / 3 < 1);
constexpr std::size_t most_candidates = 20'000'000;
/// Triangles or candidates that take milliseconds.
constexpr std::size_t items_in_slice = 4096;

[[noreturn]] void refuse_count() {
    throw std::invalid_argument("a tool has at most " + std::to_string(most_tool_points) +
                                " points: space them farther apart, or simplify the mesh");
}

/// Places a point may be put. Too many are refused.
void add(std::vector<Vec3>& candidates, const Vec3& place) {
    if (candidates.size() == most_candidates) refuse_count();
    candidates.push_back(place);
}

/// A grid of cells that finds the points near a place.
class SpreadPoints {
  public:
    explicit SpreadPoints(double cell) : cell_(cell) {}

    bool has_within(double distance, const Vec3& place) const {
        const Cell low = cell_of(place - Vec3::Constant(distance));
        const Cell high = cell_of(place + Vec3::Constant(distance));
        for (auto z = low[2]; z <= high[2]; ++z) {
            for (auto y = low[1]; y <= high[1]; ++y) {
                for (auto x = low[0]; x <= high[0]; ++x) {
                    if (has_within(distance, place, {x, y, z})) return true;
                }
            }
        }
        return false;
    }

    void add(const Vec3& point) {
        if (points_.size() == most_tool_points) refuse_count();
        points_.push_back(point);
        cells_[cell_of(point)].push_back(point);
    }

    const std::vector<Vec3>& all() const { return points_; }

  private:
    using Cell = std::array<std::int64_t, 3>;
    struct Hash {
        std::size_t operator()(const Cell& c) const {
            std::uint64_t h = 0;
            for (const std::int64_t i : c) {
                h = (h ^ static_cast<std::uint64_t>(i)) * 0x9E3779B97F4A7C15U;
                h ^= h >> 32;
            }
            return static_cast<std::size_t>(h);
        }
    };

    Cell cell_of(const Vec3& place) const {
        Cell cell{};
        for (int a = 0; a < 3; ++a) {
            cell[std::size_t(a)] = static_cast<std::int64_t>(std::floor(place[a] / cell_));
        }
        return cell;
    }
    bool has_within(double distance, const Vec3& place, const Cell& cell) const {
        const auto found = cells_.find(cell);
        if (found == cells_.end()) return false;
        return std::ranges::any_of(found->second, [&](const Vec3& point) {
            return (point - place).squaredNorm() < distance * distance;
        });
    }

    double cell_;
    std::vector<Vec3> points_;
    std::unordered_map<Cell, std::vector<Vec3>, Hash> cells_;
};

/// Makes points of candidates until each has one within `distance`: far from each other first,
/// which leaves few gaps that are neither one nor two points wide (dart throwing with shrinking
/// darts; McCool and Fiume 1992).
void choose(SpreadPoints& points, const std::vector<Vec3>& candidates, double distance,
            ReportedItems& work) {
    for (const double share : {2.0, 1.6, 1.3, 1.1, 1.0}) {
        for (const Vec3& place : candidates) {
            work.done();
            if (!points.has_within(share * distance, place)) points.add(place);
        }
    }
}

Vec3 area_vector(std::span<const Vec3> vertices, const MeshTriangle& t) {
    return 0.5 * (vertices[t[1]] - vertices[t[0]]).cross(vertices[t[2]] - vertices[t[0]]);
}

/// Edges at the border, between more than two triangles, and where two meet at more than 30
/// degrees.
std::vector<MeshEdge> sharp_edges(std::span<const Vec3> vertices,
                                  std::span<const MeshTriangle> triangles, ReportedItems& work) {
    struct Sides {
        int count = 0;
        Vec3 normal;
        bool flat = true;
    };
    const double flat = std::cos(std::acos(-1.0) / 6);
    std::map<MeshEdge, Sides> edges;
    for (const MeshTriangle& t : triangles) {
        work.done();
        const Vec3 normal = area_vector(vertices, t).normalized();
        for (std::size_t i = 0; i < 3; ++i) {
            Sides& sides = edges[std::minmax(t[i], t[(i + 1) % 3])];
            // Files do not agree on which side is out: triangles back to back count as flat.
            sides.flat &= ++sides.count == 1 || std::abs(normal.dot(sides.normal)) >= flat;
            if (sides.count == 1) sides.normal = normal;
        }
    }
    std::vector<MeshEdge> sharp;
    for (const auto& [edge, sides] : edges) {
        if (sides.count != 2 || !sides.flat) sharp.push_back(edge);
    }
    return sharp;
}

/// Where sharp edges end, branch or turn by more than 30 degrees.
std::vector<Vec3> corners_of(std::span<const Vec3> vertices, std::span<const MeshEdge> edges) {
    std::map<std::uint32_t, std::vector<Vec3>> ways;  // unit, from the vertex along its edges
    for (const auto& [a, b] : edges) {
        const Vec3 way = (vertices[b] - vertices[a]).normalized();
        ways[a].push_back(way);
        ways[b].push_back(-way);
    }
    std::vector<Vec3> corners;
    for (const auto& [vertex, from] : ways) {
        const bool passes = from.size() == 2 && from[0].dot(from[1]) < -std::sqrt(0.75);
        if (!passes) add(corners, vertices[vertex]);
    }
    return corners;
}

std::vector<Vec3> along(std::span<const Vec3> vertices, std::span<const MeshEdge> edges,
                        double step) {
    std::vector<Vec3> places;
    for (const auto& [a, b] : edges) {
        const Vec3 way = vertices[b] - vertices[a];
        const double steps = std::ceil(way.norm() / step);
        if (steps > double(most_candidates)) refuse_count();
        const int count = static_cast<int>(steps);
        for (int i = 0; i <= count; ++i) add(places, vertices[a] + way * (double(i) / steps));
    }
    return places;
}

/// The middles of pieces, halved across their longest edge until that is at most `step` long. No
/// place of a piece is farther than two thirds of that edge from its middle.
void add_pieces(std::vector<Vec3>& places, const std::array<Vec3, 3>& corners, double step) {
    std::vector<std::array<Vec3, 3>> left{corners};
    while (!left.empty()) {
        const std::array<Vec3, 3> piece = left.back();
        left.pop_back();
        std::size_t longest = 0;
        double length = 0;
        for (std::size_t i = 0; i < 3; ++i) {
            const double of_this = (piece[(i + 1) % 3] - piece[i]).norm();
            if (of_this > length) longest = i, length = of_this;
        }
        if (!(length > step)) {
            add(places, (piece[0] + piece[1] + piece[2]) / 3);
            continue;
        }
        const Vec3 &a = piece[longest], &b = piece[(longest + 1) % 3],
                   &c = piece[(longest + 2) % 3];
        const Vec3 middle = 0.5 * (a + b);
        left.push_back({middle, b, c});
        left.push_back({a, middle, c});
    }
}

}  // namespace

Tool mesh_tool(ToolShape mesh, double spacing, const OnProgress& progress) {
    if (!(spacing > 0 && spacing < 1e9)) {
        throw std::invalid_argument("the spacing of a tool's points must be > 0");
    }
    const std::span<const Vec3> vertices(mesh.vertices);
    // Three passes over the triangles, and five over the candidates, of which there are some two
    // per triangle or more.
    ReportedItems work(progress, 13 * mesh.triangles.size(), items_in_slice);
    const std::vector<MeshTriangle> triangles = joined(vertices, mesh.triangles, &work);
    double area = 0;
    for (const MeshTriangle& t : triangles) area += area_vector(vertices, t).norm();
    // The closest packing that leaves no place farther than the spacing from a point.
    if (!(area < 1.5 * std::sqrt(3.0) * spacing * spacing * double(most_tool_points))) {
        refuse_count();
    }
    const double step = candidate_step * spacing, distance = distance_of_points * spacing;
    const std::vector<MeshEdge> edges = sharp_edges(vertices, triangles, work);
    SpreadPoints points(spacing);
    choose(points, corners_of(vertices, edges), distance, work);
    choose(points, along(vertices, edges, step), distance, work);
    std::vector<Vec3> places;
    for (const MeshTriangle& t : triangles) {
        work.done();
        add_pieces(places, {vertices[t[0]], vertices[t[1]], vertices[t[2]]}, step);
    }
    choose(points, places, distance, work);
    return Tool(points.all(), std::nullopt, true, std::move(mesh));
}

}  // namespace palpate
