// Meshes: simplified, extracted in the background, and the tetrahedra at the SCP.
#include <gtest/gtest.h>
#include <Eigen/Geometry>
#include <Eigen/LU>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "apps/viewer/scene/local.hpp"
#include "apps/viewer/scene/render_mesh.hpp"
#include "apps/viewer/scene/surface_extractor.hpp"
#include "palpate/scenes/volumes.hpp"
#include "palpate/surface.hpp"
#include "pictures/surface.hpp"
#include "support/fields.hpp"
#include "support/random.hpp"

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

/// Collects what comes from the working thread.
struct Results {
    std::mutex mutex;
    std::condition_variable changed;
    std::vector<ExtractedSurface> made;
    std::vector<std::string> failed;

    SurfaceExtractor::Results into() {
        return {[this](ExtractedSurface surface) {
                    const std::lock_guard lock(mutex);
                    made.push_back(std::move(surface));
                    changed.notify_all();
                },
                [this](std::uint64_t, const std::string& what) {
                    const std::lock_guard lock(mutex);
                    failed.push_back(what);
                    changed.notify_all();
                }};
    }
    /// False if it does not happen within a minute.
    template <class Happened>
    bool wait_for(Happened happened) {
        std::unique_lock lock(mutex);
        return changed.wait_for(lock, 60s, [&] { return happened(*this); });
    }
};

auto finished(std::uint64_t request) {
    return [request](const Results& r) {
        return !r.made.empty() && r.made.back().request == request && r.made.back().finished;
    };
}

Field ball(int edge) {
    return linear_field(scenes::ball(support::cube(edge)));
}

TEST(SurfaceExtractor, is_coarse_first_and_then_as_the_proxy_meets_it) {
    Results results;
    SurfaceExtractor work(results.into());
    const Field field = ball(100);
    work.ask(7, field, 128);
    ASSERT_TRUE(results.wait_for(finished(7)));
    ASSERT_EQ(results.made.size(), 2U);  // every 2nd sample: fewer than 350,000
    for (std::size_t i = 0; i < 2; ++i) {
        EXPECT_EQ(results.made[i].request, 7U);
        EXPECT_EQ(results.made[i].isovalue, 128);
        EXPECT_EQ(results.made[i].every, 2 >> i);
        EXPECT_EQ(results.made[i].finished, i == 1);
    }
    const SurfaceMesh mesh = extract_surface(field, 128);
    EXPECT_EQ(triangle_count(results.made.back().blocks), mesh.triangles.size());
    EXPECT_LE(results.made.back().moving->triangle_count(),
              SurfaceLimits().moving_triangles * 5 / 4);
}

TEST(SurfaceExtractor, steps_start_small_and_end_with_every_sample) {
    for (const Index3& size :
         {Index3(1, 1, 1), Index3(64, 64, 64), Index3(512, 512, 640), Index3(3000, 20, 1)}) {
        const std::vector<int> steps = steps_for(size);
        EXPECT_EQ(steps.back(), 1);
        EXPECT_LE(size.cast<double>().prod() / std::pow(steps.front(), 3), 350'000);
        for (std::size_t i = 1; i < steps.size(); ++i) EXPECT_EQ(steps[i - 1], 2 * steps[i]);
    }
}

TEST(SurfaceExtractor, the_newest_of_fifty_requests_is_the_last_one_extracted) {
    Results results;
    SurfaceExtractor work(results.into());
    const Field field = ball(80);
    for (int i = 1; i <= 50; ++i) work.ask(std::uint64_t(i), field, 60 + 3 * i);
    ASSERT_TRUE(results.wait_for(finished(50)));
    EXPECT_EQ(results.made.back().isovalue, 210);
    // Not all were carried out, and none out of its turn.
    EXPECT_LT(results.made.size(), 50U);
    for (std::size_t i = 1; i < results.made.size(); ++i) {
        EXPECT_LE(results.made[i - 1].request, results.made[i].request);
    }
}

TEST(SurfaceExtractor, keeps_within_its_triangles) {
    Results results;
    SurfaceLimits limits;
    limits.most_triangles = 20'000;
    limits.moving_triangles = 2'000;
    SurfaceExtractor work(results.into(), limits);
    work.ask(1, ball(64), 128);
    ASSERT_TRUE(results.wait_for(finished(1)));
    EXPECT_GT(results.made.back().every, 1);
    EXPECT_LE(triangle_count(results.made.back().blocks), 20'000U);
    EXPECT_LE(results.made.back().moving->triangle_count(), 2'500U);
    EXPECT_GT(results.made.back().moving->triangle_count(), 100U);
}

TEST(SurfaceExtractor, says_what_is_wrong_with_an_isovalue_and_goes_on) {
    Results results;
    SurfaceExtractor work(results.into());
    const Field field = ball(16);
    work.ask(1, field, std::nan(""));
    ASSERT_TRUE(results.wait_for([](const Results& r) { return !r.failed.empty(); }));
    EXPECT_FALSE(results.failed.front().empty());
    work.ask(2, field, 128);
    ASSERT_TRUE(results.wait_for(finished(2)));
}

TEST(SurfaceExtractor, can_be_destroyed_while_it_extracts) {
    Results results;
    {
        SurfaceExtractor work(results.into());
        work.ask(1,
                 linear_field(support::noise_volume<std::uint8_t>(support::grid(support::cube(160)),
                                                                  3, 0, 256)),
                 128);
        ASSERT_TRUE(results.wait_for([](const Results& r) { return !r.made.empty(); }));
    }
    EXPECT_FALSE(results.made.back().finished);
}

TEST(SurfaceExtractor, a_dropped_request_gives_no_surface) {
    Results results;
    SurfaceExtractor work(results.into());
    work.ask(1,
             linear_field(
                 support::noise_volume<std::uint8_t>(support::grid(support::cube(160)), 3, 0, 256)),
             128);
    work.forget();
    work.ask(2, ball(16), 128);
    ASSERT_TRUE(results.wait_for(finished(2)));
    for (const ExtractedSurface& made : results.made) {
        EXPECT_FALSE(made.request == 1 && made.finished);
    }
}

using support::Random;

std::size_t count_at(const Field& field, const Vec3& index) {
    return local_tetrahedra(field, locate(index), 0).size();
}

TEST(LocalTetrahedra, are_as_many_as_touch_the_point) {
    const Field field = support::box_field().field;
    EXPECT_EQ(count_at(field, Vec3(10.4, 10.3, 10.55)), 1U);  // inside one
    EXPECT_EQ(count_at(field, Vec3(10.0, 10.3, 10.55)), 2U);  // on a face of the cell
    EXPECT_EQ(count_at(field, Vec3(10.5, 10.5, 10.5)), 24U);  // the cell's centre
    EXPECT_EQ(count_at(field, Vec3(10.0, 10.5, 10.5)), 8U);   // the centre of a face
    EXPECT_EQ(count_at(field, Vec3(10.0, 10.0, 10.25)), 8U);  // on an edge of the cell
    EXPECT_EQ(count_at(field, Vec3(10.0, 10.0, 10.0)), 48U);  // a sample
}

TEST(LocalTetrahedra, contain_the_point_and_are_a_24th_of_a_voxel) {
    const support::TestField oblique = support::oblique_field();
    const double voxel = oblique.field.geometry().spacing.prod();
    Random random(1);
    for (int i = 0; i < 200; ++i) {
        Vec3 index = random.point(1, 15);
        if (i % 2) index = (4 * index).array().round() / 4;  // onto walls, edges and corners
        const LatticePoint point = locate(index);
        const Vec3 scp = physical_from_index(oblique.field.geometry(), index_of(point));
        for (const LocalTetrahedron& t : local_tetrahedra(oblique.field, point, 33000.3)) {
            Mat3 edges;
            for (int e = 0; e < 3; ++e) edges.col(e) = t.corners[std::size_t(e) + 1] - t.corners[0];
            EXPECT_NEAR(std::abs(edges.determinant()) / 6, voxel / 24, 1e-9 * voxel);
            const Vec3 weights = edges.inverse() * (scp - t.corners[0]);
            EXPECT_GE(weights.minCoeff(), -1e-9);
            EXPECT_LE(weights.sum(), 1 + 1e-9);
        }
    }
}

/// Checks that the polygons are convex, with corners where the field that is felt has the isovalue.
void expect_on_isosurface(const support::TestField& test, const LocalTetrahedron& local,
                          double within) {
    for (const std::vector<Vec3>& polygon : local.patch) {
        const std::size_t n = polygon.size();
        ASSERT_TRUE(n == 3 || n == 4);
        Vec3 first = Vec3::Zero();
        for (std::size_t c = 0; c < n; ++c) {
            EXPECT_NEAR(value_at(test.field, polygon[c]), test.isovalue,
                        within * test.field.range());
            const Vec3 turn = (polygon[(c + 1) % n] - polygon[c])
                                  .cross(polygon[(c + 2) % n] - polygon[(c + 1) % n]);
            if (c == 0) first = turn;
            EXPECT_GE(turn.dot(first), -1e-6 * first.squaredNorm() - 1e-12);
        }
    }
}

TEST(LocalTetrahedra, patches_lie_on_the_isosurface_and_are_convex) {
    for (const support::TestField& test : {support::oblique_field(), support::noise_field()}) {
        Random random(2);
        int triangles = 0, quads = 0;
        for (int i = 0; i < 300; ++i) {
            const LatticePoint point = locate(random.point(1, 16));
            for (const LocalTetrahedron& t : local_tetrahedra(test.field, point, test.isovalue)) {
                if (t.patch.empty()) continue;
                ASSERT_EQ(t.patch.size(), 1U);
                (t.patch[0].size() == 3 ? triangles : quads)++;
                expect_on_isosurface(test, t, 1e-9);
            }
        }
        EXPECT_GT(triangles, 10);
        EXPECT_GT(quads, 10);
    }
}

TEST(LocalTetrahedra, patches_of_a_smooth_field_are_curved) {
    support::TestField test = support::oblique_field();
    test.field.set_interpolation(Interpolation::cubic);
    Random random(2);
    int curved = 0;
    for (int i = 0; i < 300; ++i) {
        const LatticePoint point = locate(Interpolation::cubic, random.point(1, 16));
        for (const LocalTetrahedron& t : local_tetrahedra(test.field, point, test.isovalue)) {
            expect_on_isosurface(test, t, 1e-4);
            curved += t.patch.size() > 1;
        }
    }
    EXPECT_GT(curved, 20);
}

TEST(LocalTetrahedra, planes_are_those_of_the_field_at_a_point_on_the_surface) {
    for (const Solid solid : {Solid::above, Solid::below}) {
        const Field field = support::oblique_field(9).field;
        const Field sided = linear_field(field.volume(), solid);
        Random random(3);
        for (int i = 0; i < 100; ++i) {
            const LatticePoint point = locate(random.point(1, 15));
            const double level = value_at(sided, point);
            const auto all = local_tetrahedra(sided, point, level);
            ASSERT_EQ(all.size(), 1U);
            ASSERT_TRUE(all[0].plane);
            const Vec3 scp = physical_from_index(sided.geometry(), index_of(point));
            EXPECT_LT((all[0].plane->point - scp).norm(), 1e-9);
            const Vec3 out = -sided.sign() * gradient_at(sided, scp).normalized();
            EXPECT_LT((all[0].plane->normal - out).norm(), 1e-6);
            EXPECT_FALSE(local_tetrahedra(sided, point, level + 0.01 * sided.range())[0].plane);
        }
    }
}

TEST(LocalTetrahedra, of_a_constant_field_have_neither_patch_nor_plane) {
    const Field field = linear_field(support::volume_of<std::uint8_t>(
        support::grid(support::cube(8)), [](const Index3&) { return 5; }));
    for (const LocalTetrahedron& t : local_tetrahedra(field, locate(Vec3(4, 4, 4)), 5)) {
        EXPECT_TRUE(t.patch.empty());
        EXPECT_FALSE(t.plane);
    }
}

}  // namespace
}  // namespace palpate::viewer
