// The surface in blocks: equal to the surface in one piece, and after a change equal to a new one.
#include "apps/viewer/scene/surface_blocks.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "apps/viewer/model/sample_block.hpp"
#include "palpate/edit.hpp"
#include "palpate/scenes/volumes.hpp"
#include "pictures/surface.hpp"
#include "support/fields.hpp"
#include "viewer/scene/mesh_points.hpp"

namespace palpate::viewer {
namespace {

constexpr std::size_t all = 1u << 30;
const auto always = [] { return true; };

Point point(const std::vector<float>& values, std::int32_t i) {
    const auto at = 3 * static_cast<std::size_t>(i);
    return {values[at], values[at + 1], values[at + 2]};
}

/// The field itself, or its coarse version.
Field version(const Field& field, CoarseSamples& samples, int every) {
    return every == 1 ? field : samples.of(field);
}

SurfaceBlocks blocks_of(const Field& field, double isovalue, int every = 1) {
    SurfaceBlocks blocks(field.geometry(), every, field.interpolation());
    CoarseSamples samples(every);
    EXPECT_EQ(blocks.renew(version(field, samples, every), isovalue, always, all),
              SurfaceBlocks::Outcome::done);
    return blocks;
}

/// Edges, by where their ends lie, that do not have as many triangles along them as against them.
int open_edges(const RenderMesh& mesh) {
    ByPlace<Edge, int> turns;
    for (std::size_t t = 0; t < mesh.triangles.size(); t += 3) {
        for (std::size_t c = 0; c < 3; ++c) {
            const Point a = point(mesh.positions, mesh.triangles[t + c]);
            const Point b = point(mesh.positions, mesh.triangles[t + (c + 1) % 3]);
            if (a < b) ++turns[{a, b}];
            if (b < a) --turns[{b, a}];
        }
    }
    int open = 0;
    for (const auto& [edge, turn] : turns) open += turn != 0;
    return open;
}

/// How far the surface reaches out of the grid's samples at most [samples].
double overhang(const Field& field, double isovalue, int every) {
    const Geometry& g = field.geometry();
    const SurfaceBlocks blocks = blocks_of(field, isovalue, every);
    const auto mesh = joined(blocks.meshes());
    if (!mesh) return 0;
    double most = -g.size.cast<double>().maxCoeff();
    for (std::size_t v = 0; v < mesh->vertex_count(); ++v) {
        const Point p = point(mesh->positions, static_cast<std::int32_t>(v));
        const Vec3 index = index_from_physical(g, physical_centre(g) + Vec3(p[0], p[1], p[2]));
        const Vec3 behind = index - (g.size - Index3::Ones()).cast<double>();
        most = std::max({most, behind.maxCoeff(), (-index).maxCoeff()});
    }
    return most;
}

void expect_same(const SurfaceBlocks& a, const SurfaceBlocks& b) {
    ASSERT_EQ(a.meshes().size(), b.meshes().size());
    for (std::size_t i = 0; i < a.meshes().size(); ++i) {
        const auto &p = a.meshes()[i], &q = b.meshes()[i];
        ASSERT_EQ(p == nullptr, q == nullptr) << i;
        if (!p) continue;
        EXPECT_EQ(p->triangles, q->triangles) << i;
        EXPECT_EQ(p->positions, q->positions) << i;
        EXPECT_EQ(p->normals, q->normals) << i;
    }
}

Field noise(const Geometry& geometry, Solid solid = Solid::above) {
    return linear_field(support::noise_volume<std::int16_t>(geometry, 5, -300, 1000), solid, -77);
}

TEST(SurfaceBlocks, are_the_surface_with_its_normals_on_every_grid) {
    Mat3 mirrored = support::oblique_direction();
    mirrored.col(1) *= -1;
    for (const Geometry& g :
         {support::grid({70, 40, 33}, {1, 1, 1}),
          support::grid({35, 34, 30}, {0.5, 1.5, 2}, {300, -20, 1000}, mirrored),
          support::grid({1, 40, 1})}) {
        for (const auto& [solid, interpolation] : {std::pair{Solid::above, Interpolation::linear},
                                                   std::pair{Solid::below, Interpolation::linear},
                                                   std::pair{Solid::above, Interpolation::cubic}}) {
            Field field = noise(g, solid);
            field.set_interpolation(interpolation);
            const pictures::Surface whole = pictures::shaded_surface(field, 350.5).surface;
            const Vec3 middle = physical_centre(g);
            const auto mesh = joined(blocks_of(field, 350.5).meshes());
            ASSERT_EQ(mesh->triangle_count(), whole.mesh.triangles.size());
            ByPlace<Point, Eigen::Vector3f> normals;
            for (std::size_t v = 0; v < whole.normals.size(); ++v) {
                const Eigen::Vector3f p = (whole.mesh.vertices[v] - middle).cast<float>();
                normals[{p[0], p[1], p[2]}] = whole.normals[v];
            }
            std::size_t elsewhere = 0, otherwise = 0;
            for (std::size_t v = 0; v < mesh->vertex_count(); ++v) {
                const auto at = normals.find(point(mesh->positions, int(v)));
                if (at == normals.end()) {  // rounded to the next float
                    ++elsewhere;
                    continue;
                }
                const Point n = point(mesh->normals, int(v));
                otherwise += (Eigen::Vector3f(n.data()) - at->second).norm() > 1e-3F;
            }
            EXPECT_LE(elsewhere, mesh->vertex_count() / 100);
            EXPECT_LE(otherwise, mesh->vertex_count() / 1000);
        }
    }
}

TEST(SurfaceBlocks, meet_without_cracks) {
    for (const int every : {1, 2}) {
        for (const auto interpolation : {Interpolation::linear, Interpolation::cubic}) {
            Field field = noise(support::grid({70, 40, 33}));
            field.set_interpolation(interpolation);
            EXPECT_EQ(open_edges(*joined(blocks_of(field, 300, every).meshes())), 0);
        }
    }
}

TEST(SurfaceBlocks, after_edits_are_those_of_the_flattened_volume) {
    const Geometry g = support::grid({75, 66, 40}, {1, 1.25, 0.8}, {10, 0, -5});
    Field field = noise(g);
    Field smooth = linear_field(scenes::ball(support::cube(70)));
    support::Random random(11);
    for (const int every : {1, 2, 3}) {
        for (Field* one : {&field, &smooth}) {
            Field now = *one;
            const double level = one == &field ? 350 : 128;
            SurfaceBlocks blocks = blocks_of(now, level, every);
            CoarseSamples samples(every);
            version(now, samples, every);
            for (int i = 0; i < 6; ++i) {
                const Index3 size = now.geometry().size;
                Index3 at;
                for (int a = 0; a < 3; ++a) at[a] = int(random.uniform(-2, size[a] + 2));
                edit::Stroke stroke;
                stroke.brush = brush_for(i % 2 ? BrushKind::add : BrushKind::carve, now, level, 7);
                stroke.from = stroke.to = physical_from_index(now.geometry(), at.cast<double>());
                const Edited after = edited(now.shared_samples(), stroke);
                const Field before = now;
                now.use(after.samples);
                const SampleBox changed = i % 3 == 2 ? changed_between(before, now) : after.changed;
                blocks.mark(changed);
                samples.mark(changed);
                ASSERT_EQ(blocks.renew(version(now, samples, every), level, always, all),
                          SurfaceBlocks::Outcome::done);
            }
            const Field flat =
                linear_field(flattened(now.samples()), now.solid(), now.background());
            expect_same(blocks, blocks_of(flat, level, every));
        }
    }
}

TEST(SurfaceBlocks, a_small_edit_costs_few_blocks_and_the_others_stay_as_they_are) {
    Field field = linear_field(scenes::ball(support::cube(128)));
    SurfaceBlocks blocks = blocks_of(field, 128);
    const MeshBlocks before = blocks.meshes();
    blocks.mark({Index3(40, 40, 40), Index3(40, 40, 40)});  // a sample in one block's middle
    EXPECT_EQ(blocks.outdated(), 1U);
    blocks.mark({Index3(63, 50, 50), Index3(63, 50, 50)});  // beside a border
    EXPECT_EQ(blocks.outdated(), 2U);
    blocks.mark({Index3(5, 6, 7), Index3(4, 9, 9)});  // nothing
    EXPECT_EQ(blocks.outdated(), 2U);
    blocks.renew(field, 128, always, all);
    int others = 0;
    for (std::size_t i = 0; i < before.size(); ++i) others += before[i] == blocks.meshes()[i];
    EXPECT_GE(others, int(before.size()) - 2);
}

TEST(SurfaceBlocks, between_two_frames_are_those_of_the_samples_between_them) {
    const Geometry g = support::grid({40, 36, 35});
    std::vector<Frame> frames;
    for (int i = 0; i < 2; ++i) {
        frames.push_back({0.5 * i, support::noise_volume<float>(g, 3 + std::uint64_t(i), 0, 1)});
    }
    Field field = linear_field(std::make_shared<const Samples>(frames), Solid::above, 0);
    for (const double time : {0.0, 0.2, 0.5}) {
        field.set_time(time);
        const Field flat =
            linear_field(flattened(field.samples(), field.moment()), Solid::above, 0);
        expect_same(blocks_of(field, 0.6), blocks_of(flat, 0.6));
    }
}

TEST(SurfaceBlocks, stop_on_request_or_when_too_large_and_continue_later) {
    const Field field = noise(support::grid(support::cube(80)));
    SurfaceBlocks blocks(field.geometry(), 1, field.interpolation());
    std::atomic<int> asked{0};
    EXPECT_EQ(blocks.renew(
                  field, 350, [&] { return ++asked < 5; }, all),
              SurfaceBlocks::Outcome::interrupted);
    EXPECT_GE(blocks.outdated(), blocks.meshes().size() - 5);
    EXPECT_LT(blocks.outdated(), blocks.meshes().size());
    EXPECT_EQ(blocks.renew(field, 350, always, 100'000), SurfaceBlocks::Outcome::too_many);
    EXPECT_EQ(blocks.renew(field, 350, always, all), SurfaceBlocks::Outcome::done);
    expect_same(blocks, blocks_of(field, 350));
}

TEST(SampleBlock, is_what_the_samples_are_wherever_they_are_stored) {
    Field field = noise(support::grid({37, 20, 18}));
    for (int i = 0; i < 2; ++i) {
        const edit::Fill fill{{Index3(14 + 9 * i, 3, 15), Index3(20 + 9 * i, 16, 17)}, 5.0 * i};
        field.use(edited(field.shared_samples(), fill).samples);
    }
    const Index3 low(-2, -1, -3), size(48, 24, 25);
    const std::vector<float> block = sample_block(field, low, size);
    std::size_t n = 0;
    for (int k = 0; k < size[2]; ++k) {
        for (int j = 0; j < size[1]; ++j) {
            for (int i = 0; i < size[0]; ++i, ++n) {
                const Index3 at = low + Index3(i, j, k);
                const bool in =
                    (at.array() >= 0).all() && (at.array() < field.geometry().size.array()).all();
                ASSERT_EQ(block[n], in ? field.samples().sample(at) : -77);
            }
        }
    }
}

TEST(SampleBlock, changes_between_versions_are_found_by_their_bricks) {
    const Field first = noise(support::grid(support::cube(50)));
    Field second = first;
    EXPECT_TRUE(changed_between(first, second).empty());
    second.use(
        edited(first.shared_samples(), edit::Fill{{Index3(20, 20, 20), Index3(22, 22, 22)}, 1})
            .samples);
    for (const auto& [a, b] : {std::pair(first, second), std::pair(second, first)}) {
        const SampleBox box = changed_between(a, b);
        EXPECT_TRUE((box.low.array() <= 20).all() && (box.low.array() >= 16).all());
        EXPECT_TRUE((box.high.array() >= 22).all() && (box.high.array() <= 32).all());
    }
    // The same edit elsewhere, another volume, another side: everything.
    EXPECT_EQ(changed_between(first, noise(support::grid(support::cube(50)))),
              whole_box(first.geometry()));
    EXPECT_EQ(changed_between(first, linear_field(first.shared_samples(), Solid::below, -77)),
              whole_box(first.geometry()));
}

TEST(SurfaceBlocks, coarse_ones_reach_as_far_out_of_the_grid_as_the_surface_does) {
    Geometry g = support::grid({23, 18, 30});
    g.spacing = {3.2, 3.2, 3.6};
    for (const Interpolation interpolation : {Interpolation::linear, Interpolation::cubic}) {
        const Field full(Volume(g, std::vector<std::uint8_t>(23 * 18 * 30, 200)), Solid::above, 0,
                         interpolation);
        for (int every = 1; every <= 7; ++every) {
            SCOPED_TRACE(every);
            EXPECT_NEAR(overhang(full, 100, every), overhang(full, 100, 1), 0.1);
            EXPECT_GT(overhang(full, 20, every), 0.5) << "it is closed outside of the samples";
            EXPECT_LT(overhang(full, 20, every), closing_samples(interpolation) + 0.001);
        }
    }
}

}  // namespace
}  // namespace palpate::viewer
