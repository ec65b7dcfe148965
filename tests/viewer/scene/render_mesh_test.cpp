// Meshes for rendering.
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

}  // namespace
}  // namespace palpate::viewer
