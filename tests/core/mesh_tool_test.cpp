// A tool of a mesh has points all over the mesh, nowhere else, and no more than it needs.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "palpate/tool.hpp"
#include "support/random.hpp"

namespace palpate {
namespace {

using support::Random;
using Triangle = std::array<std::uint32_t, 3>;

using Mesh = ToolShape;

std::array<Vec3, 3> corners_of(const Mesh& mesh, const Triangle& t) {
    return {mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]};
}

double area_of(const Mesh& mesh) {
    double sum = 0;
    for (const Triangle& t : mesh.triangles) {
        const auto [a, b, c] = corners_of(mesh, t);
        sum += 0.5 * (b - a).cross(c - a).norm();
    }
    return sum;
}

Mesh box(const Vec3& size) {
    Mesh mesh;
    for (int i = 0; i < 8; ++i) {
        mesh.vertices.emplace_back((i & 1) * size[0], (i >> 1 & 1) * size[1], (i >> 2) * size[2]);
    }
    mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                      {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    return mesh;
}

/// A ball of `rings` x 2 `rings` slim quadrangles, every vertex repeated for each triangle, as STL
/// files have them.
Mesh ball(double radius, int rings) {
    Mesh mesh;
    const double pi = std::acos(-1.0);
    const auto at = [&](int i, int j) {
        const double down = pi * i / rings, round = pi * j / rings;
        return Vec3(radius * std::sin(down) * std::cos(round),
                    radius * std::sin(down) * std::sin(round), radius * std::cos(down));
    };
    for (int i = 0; i < rings; ++i) {
        for (int j = 0; j < 2 * rings; ++j) {
            const int next = (j + 1) % (2 * rings);
            for (const auto& corners : {std::array{at(i, j), at(i + 1, j), at(i + 1, next)},
                                        std::array{at(i, j), at(i + 1, next), at(i, next)}}) {
                const auto n = static_cast<std::uint32_t>(mesh.vertices.size());
                mesh.vertices.insert(mesh.vertices.end(), corners.begin(), corners.end());
                mesh.triangles.push_back({n, n + 1, n + 2});
            }
        }
    }
    return mesh;
}

/// Triangles of all sizes and shapes through each other, turned either way.
Mesh soup(Random& random) {
    Mesh mesh;
    for (std::uint32_t i = 0; i < 60; i += 3) {
        const Vec3 middle = random.point(-8, 8);
        const Vec3 size = random.point(0, 1).cwiseAbs2().cwiseProduct(Vec3::Constant(6));
        for (int k = 0; k < 3; ++k) {
            mesh.vertices.push_back(middle + random.point(-1, 1).cwiseProduct(size));
        }
        mesh.triangles.push_back({i, i + 1, i + 2});
    }
    return mesh;
}

/// Distance of a point from a triangle: the nearest of plane and edges.
double distance_from(const std::array<Vec3, 3>& corners, const Vec3& point) {
    const auto& [a, b, c] = corners;
    const Vec3 normal = (b - a).cross(c - a);
    double nearest = std::numeric_limits<double>::infinity();
    bool over = normal.norm() > 0;
    for (std::size_t i = 0; i < 3; ++i) {
        const Vec3 from = corners[i], way = corners[(i + 1) % 3] - from;
        over = over && normal.cross(way).dot(point - from) >= 0;
        const double share =
            std::clamp((point - from).dot(way) / std::max(way.squaredNorm(), 1e-300), 0.0, 1.0);
        nearest = std::min(nearest, (from + share * way - point).norm());
    }
    return over ? std::min(nearest, std::abs(normal.normalized().dot(point - a))) : nearest;
}

double nearest_point(const Tool& tool, const Vec3& place) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const Vec3& point : tool.points()) nearest = std::min(nearest, (point - place).norm());
    return nearest;
}

void is_covered(const Mesh& mesh, double spacing) {
    const Tool tool = mesh_tool(mesh, spacing);
    Random random(5);
    for (int i = 0; i < support::scaled(4000); ++i) {
        const auto [a, b, c] =
            corners_of(mesh, mesh.triangles[std::size_t(random.below(int(mesh.triangles.size())))]);
        double u = random.uniform(0, 1), v = random.uniform(0, 1);
        if (u + v > 1) u = 1 - u, v = 1 - v;
        const Vec3 place = a + u * (b - a) + v * (c - a);
        ASSERT_LE(nearest_point(tool, place), spacing * (1 + 1e-12)) << place.transpose();
    }
    for (std::size_t i = 0; i < tool.points().size(); ++i) {
        const Vec3& point = tool.points()[i];
        double nearest = std::numeric_limits<double>::infinity();
        for (const Triangle& t : mesh.triangles) {
            nearest = std::min(nearest, distance_from(corners_of(mesh, t), point));
        }
        ASSERT_LE(nearest, 1e-12 * (1 + point.norm()));
        for (std::size_t j = 0; j < i; ++j) {
            ASSERT_GE((point - tool.points()[j]).norm(), 0.75 * spacing * (1 - 1e-12));
        }
    }
}

TEST(MeshTool, no_place_is_farther_than_the_spacing_from_a_point_and_every_point_is_on_the_mesh) {
    is_covered(box({4, 3, 2}), 0.37);
    is_covered(box({6, 0.1, 5}), 0.5);
    is_covered(ball(3, 40), 0.5);
    is_covered(ball(3, 4), 0.5);
    Random random(2);
    for (int i = 0; i < support::scaled(20); ++i) is_covered(soup(random), random.uniform(0.3, 2));
}

TEST(MeshTool, has_not_many_more_points_than_a_grid_would) {
    const Mesh round = ball(5, 60);
    const double spacing = 0.4;
    const auto count = static_cast<double>(mesh_tool(round, spacing).points().size());
    EXPECT_LT(count, 1.25 * area_of(round) / (spacing * spacing));
    // Slivers do not bring more.
    Mesh strip;
    strip.vertices = {{0, 0, 0}, {100, 0.001, 0}, {100, 0, 0}};
    strip.triangles = {{0, 1, 2}};
    EXPECT_LT(mesh_tool(strip, 1).points().size(), 140U);
}

TEST(MeshTool, has_the_corners_of_a_mesh_among_its_points) {
    const Mesh mesh = box({4, 3, 2});
    const Tool tool = mesh_tool(mesh, 0.7);
    for (const Vec3& corner : mesh.vertices) EXPECT_EQ(nearest_point(tool, corner), 0);
    // And its edges are as full of points as its faces.
    for (double x = 0; x <= 4; x += 0.05) {
        double nearest = 1e9;
        for (const Vec3& p : tool.points()) {
            if (p[1] == 0 && p[2] == 0) nearest = std::min(nearest, std::abs(p[0] - x));
        }
        EXPECT_LE(nearest, 0.7) << x;
    }
}

TEST(MeshTool, is_the_same_whichever_way_its_triangles_turn) {
    Mesh mesh = ball(3, 12);
    const Tool tool = mesh_tool(mesh, 0.5);
    Random random(4);
    for (Triangle& t : mesh.triangles) {
        if (random.chance(0.5)) std::swap(t[1], t[2]);
    }
    const Tool turned = mesh_tool(mesh, 0.5);
    EXPECT_NEAR(double(turned.points().size()), double(tool.points().size()),
                0.05 * double(tool.points().size()));
}

TEST(MeshTool, what_is_no_mesh_or_too_large_is_refused) {
    const Mesh mesh = box({4, 3, 2});
    const auto refused = [](const Mesh& m, double spacing) {
        EXPECT_THROW((void)mesh_tool(m, spacing), std::invalid_argument);
    };
    for (const double spacing : {0.0, -1.0, std::nan(""), 1e-9, 0.01, 1e300}) {
        refused(mesh, spacing);
    }
    refused({}, 1);
    refused({mesh.vertices, {{0, 1, 8}}}, 1);
    refused({mesh.vertices, {{0, 0, 1}}}, 1);
    refused({{{0, 0, 0}, {1, 0, 0}, {0, std::nan(""), 0}}, {{0, 1, 2}}}, 1);
    EXPECT_THROW(Tool({Vec3::Zero()}, 1, true, {{Vec3::Zero()}, {{0, 0, 1}}}),
                 std::invalid_argument);
    refused({{{0, 0, 0}, {1e9, 0, 0}, {0, 1e-9, 0}}, {{0, 1, 2}}}, 1);  // a line of 1e9 mm
    const Mesh far = box({1e5, 1e5, 1e5});
    EXPECT_LE(mesh_tool(far, 5e3).points().size(), most_tool_points);
}

}  // namespace
}  // namespace palpate
