// Meshes for rendering and their simplification.
#include <gtest/gtest.h>
#include <Eigen/Geometry>
#include <algorithm>

#include "apps/viewer/scene/render_mesh.hpp"
#include "palpate/scenes/volumes.hpp"
#include "pictures/surface.hpp"
#include "support/fields.hpp"

namespace palpate::viewer {
namespace {

/// A surface with a normal a vertex, its positions measured from `origin` [mm, physical].
RenderMesh render_mesh(const pictures::Surface& surface, const Vec3& origin) {
    RenderMesh drawn;
    drawn.positions.reserve(3 * surface.mesh.vertices.size());
    for (const Vec3& v : surface.mesh.vertices) {
        const Eigen::Vector3f p = (v - origin).cast<float>();
        drawn.positions.insert(drawn.positions.end(), {p[0], p[1], p[2]});
    }
    drawn.normals.reserve(3 * surface.normals.size());
    for (const Eigen::Vector3f& n : surface.normals) {
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

Vec3 vertex(const RenderMesh& mesh, std::int32_t i) {
    return Eigen::Map<const Eigen::Vector3f>(mesh.positions.data() + 3 * i).cast<double>();
}
Vec3 normal(const RenderMesh& mesh, std::int32_t i) {
    return Eigen::Map<const Eigen::Vector3f>(mesh.normals.data() + 3 * i).cast<double>();
}

/// A ball of radius 0.35 * 40 mm, seen from `origin`.
RenderMesh ball_mesh(const Vec3& origin = Vec3::Zero()) {
    const Field field =
        linear_field(scenes::ball(support::cube(40), 0.35, 1.4, SampleType::float32));
    return render_mesh(pictures::shaded_surface(field, 0.5).surface, origin);
}

double volume_of(const RenderMesh& mesh) {
    double six = 0;
    for (std::size_t t = 0; t < mesh.triangles.size(); t += 3) {
        six +=
            vertex(mesh, mesh.triangles[t])
                .dot(
                    vertex(mesh, mesh.triangles[t + 1]).cross(vertex(mesh, mesh.triangles[t + 2])));
    }
    return six / 6;
}

TEST(RenderMesh, simplified_is_small_and_still_the_same_ball) {
    const RenderMesh mesh = ball_mesh();
    ASSERT_GT(mesh.triangle_count(), 20'000U);
    for (const std::size_t most : {10'000U, 3'000U, 1'000U}) {
        const RenderMesh simple = simplified(mesh, most);
        EXPECT_LE(simple.triangle_count(), most * 5 / 4);
        EXPECT_GE(simple.triangle_count(), most / 6);
        EXPECT_NEAR(volume_of(simple) / volume_of(mesh), 1, 0.1) << most;
        for (std::size_t i = 0; i < simple.vertex_count(); ++i) {
            const Vec3 at = vertex(simple, int(i));
            EXPECT_NEAR(normal(simple, int(i)).norm(), 1, 1e-5);
            EXPECT_GT(normal(simple, int(i)).dot(at.normalized()), 0.8);
            EXPECT_NEAR(at.norm(), 14, 1.5);
        }
    }
}

TEST(RenderMesh, that_is_small_enough_stays_as_it_is) {
    const RenderMesh mesh = ball_mesh();
    EXPECT_EQ(simplified(mesh, mesh.triangle_count()).triangles, mesh.triangles);
}

TEST(RenderMesh, simplifying_ends_for_every_budget_and_every_mesh) {
    // Noise has as much surface as there can be; and there may be none.
    const Field noise = support::noise_field().field;
    const RenderMesh mesh = render_mesh(pictures::shaded_surface(noise, 128).surface, Vec3::Zero());
    for (const std::size_t most : {0U, 1U, 100U}) {
        EXPECT_LT(simplified(mesh, most).triangle_count(), 2'000U);
    }
    EXPECT_EQ(simplified({}, 0).triangle_count(), 0U);
}

TEST(RenderMesh, two_sides_of_a_thin_sheet_stay_two) {
    const support::TestField sheet = support::sheet_field();
    const RenderMesh mesh =
        render_mesh(pictures::shaded_surface(sheet.field, sheet.isovalue).surface, Vec3::Zero());
    const RenderMesh simple = simplified(mesh, mesh.triangle_count() / 20);
    // Outer and inner side of the wall at x = 5, away from the edges of the box.
    int out = 0, in = 0;
    for (std::size_t i = 0; i < simple.vertex_count(); ++i) {
        const Vec3 at = vertex(simple, int(i));
        if (std::abs(at[0] - 5) > 0.5 || (at.tail<2>().array() - 11).abs().maxCoeff() > 3) continue;
        (normal(simple, int(i))[0] < 0 ? out : in)++;
        EXPECT_GT(std::abs(normal(simple, int(i))[0]), 0.7);
    }
    EXPECT_GT(out, 1);
    EXPECT_GT(in, 1);
}

TEST(RenderMesh, blocks_that_are_joined_are_all_of_them) {
    const auto one = std::make_shared<const RenderMesh>(ball_mesh());
    const auto other = std::make_shared<const RenderMesh>(ball_mesh(Vec3(50, 0, 0)));
    const MeshBlocks blocks{nullptr, one, nullptr, other};
    EXPECT_EQ(triangle_count(blocks), 2 * one->triangle_count());
    const auto all = joined(blocks);
    ASSERT_EQ(all->triangle_count(), 2 * one->triangle_count());
    ASSERT_EQ(all->vertex_count(), 2 * one->vertex_count());
    for (std::size_t t = 0; t < one->triangles.size(); ++t) {
        ASSERT_EQ(vertex(*all, all->triangles[t]), vertex(*one, one->triangles[t]));
        const std::size_t there = one->triangles.size() + t;
        ASSERT_EQ(vertex(*all, all->triangles[there]), vertex(*other, other->triangles[t]));
        ASSERT_EQ(normal(*all, all->triangles[there]), normal(*other, other->triangles[t]));
    }
    EXPECT_EQ(joined(MeshBlocks{nullptr, one}), one);
    EXPECT_EQ(joined(MeshBlocks{nullptr, nullptr}), nullptr);
}

using namespace std::chrono_literals;

}  // namespace
}  // namespace palpate::viewer
