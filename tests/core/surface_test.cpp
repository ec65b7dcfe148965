// Surface: closed and oriented for any data, on the isosurface, around the solid only.
#include "palpate/surface.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <bit>
#include <numbers>
#include <set>
#include <utility>

#include "palpate/lattice.hpp"
#include "support/fields.hpp"
#include "support/mesh_checks.hpp"

using namespace palpate;
using namespace palpate::support;

namespace {

Geometry oblique(Geometry geometry) {
    geometry.spacing = {0.5, 0.7, 2};
    geometry.origin = {-120, 35, 410};
    geometry.direction =
        (Eigen::AngleAxisd(0.7, Vec3::UnitX()) * Eigen::AngleAxisd(-0.4, Vec3::UnitZ()))
            .toRotationMatrix();
    return geometry;
}

Geometry mirrored(Geometry geometry) {
    geometry = oblique(geometry);
    geometry.direction.col(1) *= -1;
    return geometry;
}

Volume noise(const Geometry& geometry, unsigned seed) {
    return noise_volume<std::uint8_t>(geometry, seed, 0, 256);
}

Volume salt(const Geometry& geometry, unsigned seed) {
    Random random(seed);
    return volume_of<std::uint8_t>(geometry,
                                   [&](const Index3&) { return random.chance(0.25) ? 255 : 0; });
}

/// radius - distance from the middle of the grid [mm].
Volume ball(const Geometry& geometry, double radius) {
    const Vec3 middle = physical_centre(geometry);
    return volume_of<float>(geometry, [&](const Index3& i) {
        return radius - (physical_from_index(geometry, i.cast<double>()) - middle).norm();
    });
}

Vec3 random_index(Random& random, const Geometry& geometry) {
    Vec3 index;
    for (int a = 0; a < 3; ++a) index[a] = random.uniform(-1, geometry.size[a]);
    return index;
}

bool is_solid(const Field& field, double isovalue, double density) {
    return field.sign() * (density - isovalue) > 0;
}

void expect_closed(const Field& field, double isovalue) {
    const SurfaceMesh mesh = extract_surface(field, isovalue);
    EXPECT_TRUE(mesh.complete);
    EXPECT_FALSE(mesh.triangles.empty());
    EXPECT_EQ(flaw_in_closed_mesh(mesh), "");
    EXPECT_GT(enclosed_volume(mesh), 0);
    // Euler: every closed orientable surface has an even characteristic.
    const auto v = static_cast<std::int64_t>(mesh.vertices.size());
    const auto f = static_cast<std::int64_t>(mesh.triangles.size());
    EXPECT_EQ((v - f / 2) % 2, 0);
}

}  // namespace

TEST(Surface, is_closed_and_oriented_on_noise_at_every_kind_of_isovalue) {
    const Volume volume = noise(grid({24, 24, 24}), 1);
    for (const double isovalue : {0.0, 1.0, 64.0, 128.0, 128.5, 200.0, 254.0}) {
        expect_closed(linear_field(volume), isovalue);
    }
    for (const double isovalue : {1.0, 128.0, 254.5, 255.0}) {
        expect_closed(linear_field(volume, Solid::below), isovalue);
    }
}

TEST(Surface, is_closed_on_salt_even_at_the_values_of_the_samples) {
    const Volume volume = salt(grid({24, 24, 24}), 2);
    for (const double isovalue : {0.0, 63.75, 127.5, 254.0})
        expect_closed(linear_field(volume), isovalue);
    expect_closed(linear_field(volume, Solid::below), 255);
    expect_closed(linear_field(volume, Solid::below), 127.5);
}

TEST(Surface, is_closed_on_volumes_one_voxel_thin) {
    for (const Geometry& geometry :
         {grid({1, 1, 1}), grid({1, 9, 8}), grid({9, 1, 8}), grid({9, 8, 1}), grid({1, 1, 9}),
          grid({9, 1, 1}), grid({2, 1, 2})}) {
        std::vector<std::uint8_t> samples(static_cast<std::size_t>(sample_count(geometry)), 200);
        samples[samples.size() / 2] = 90;
        const Field field = linear_field(Volume(geometry, std::move(samples)), Solid::above, 0);
        expect_closed(field, 50);
        expect_closed(field, 0);
    }
}

TEST(Surface, is_closed_and_faces_outward_on_anisotropic_oblique_and_mirrored_grids) {
    Geometry anisotropic = grid({12, 15, 9});
    anisotropic.spacing = {0.5, 0.5, 2};
    for (const Geometry& geometry :
         {anisotropic, oblique(grid({12, 15, 9})), mirrored(grid({12, 15, 9}))}) {
        const Volume volume = noise_volume<std::int16_t>(geometry, 3, -1024, 3072);
        expect_closed(linear_field(volume), 300);
        expect_closed(linear_field(volume, Solid::below), -500);
    }
}

TEST(Surface, cuts_a_tetrahedron_between_solid_and_free_corners_and_faces_the_free_ones) {
    const std::array<Vec3, 4> corners{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)};
    for (unsigned solid = 0; solid < 16; ++solid) {
        const TetrahedronCut cut = cut_of(solid);
        const int ends = std::popcount(solid) * (4 - std::popcount(solid));
        ASSERT_EQ(cut.count, ends) << solid;  // one corner an edge that is cut
        if (cut.count == 0) continue;
        std::set<std::pair<int, int>> seen;
        std::vector<Vec3> polygon;
        for (int i = 0; i < cut.count; ++i) {
            const auto [in, out] = cut.edges[i];
            const auto next = cut.edges[(i + 1) % cut.count];
            EXPECT_TRUE(solid >> in & 1U);
            EXPECT_FALSE(solid >> out & 1U);
            EXPECT_TRUE(seen.emplace(in, out).second);
            EXPECT_TRUE(next.solid == in || next.free == out) << "not in turn";
            polygon.push_back(0.5 * (corners[in] + corners[out]));
        }
        const Vec3 normal = (polygon[1] - polygon[0]).cross(polygon[2] - polygon[0]);
        for (int i = 0; i < 4; ++i) {
            const double side = normal.dot(corners[i] - polygon[0]);
            EXPECT_EQ(side < 0, (solid >> i & 1U) != 0) << solid << " " << i;
        }
    }
}

TEST(Surface, of_a_constant_volume_is_empty) {
    const Volume volume(grid({5, 6, 7}), std::vector<std::uint8_t>(210, 9));
    for (const double isovalue : {8.0, 9.0, 10.0}) {
        const SurfaceMesh mesh = extract_surface(linear_field(volume), isovalue);
        EXPECT_TRUE(mesh.vertices.empty());
        EXPECT_TRUE(mesh.triangles.empty());
        EXPECT_EQ(enclosed_volume(mesh), 0);
    }
}

TEST(Surface, stays_a_manifold_without_indices_in_32_bit_floats) {
    for (const Geometry& geometry : {grid({24, 24, 24}), oblique(grid({24, 24, 24}))}) {
        for (const double isovalue : {0.0, 128.0}) {
            const SurfaceMesh mesh = extract_surface(linear_field(noise(geometry, 4)), isovalue);
            const SurfaceMesh welded = welded_as_float(mesh);
            EXPECT_EQ(welded.vertices.size(), mesh.vertices.size());
            EXPECT_EQ(flaw_in_closed_mesh(welded), "");
        }
    }
}

TEST(Surface, has_every_vertex_on_the_isosurface_within_the_margin) {
    for (const Geometry& geometry : {grid({16, 16, 16}), mirrored(grid({16, 16, 16}))}) {
        const Field field = linear_field(noise(geometry, 5));
        for (const double isovalue : {128.0, 99.3}) {
            const SurfaceMesh mesh = extract_surface(field, isovalue);
            std::size_t exact = 0;
            for (const Vec3& v : mesh.vertices) {
                const double off = std::abs(value_at(field, v) - isovalue) / field.range();
                ASSERT_LE(off, surface_margin);
                exact += off < 1e-12;
            }
            // The other vertices were held off the ends of their edges: few, and those only.
            EXPECT_GT(exact, mesh.vertices.size() * 97 / 100);
        }
    }
}

TEST(Surface, winds_once_around_the_solid_and_not_around_the_free_space) {
    for (const Geometry& geometry :
         {grid({9, 8, 10}), oblique(grid({9, 8, 10})), mirrored(grid({9, 8, 10}))}) {
        for (const Solid side : {Solid::above, Solid::below}) {
            const Field field = linear_field(noise(geometry, 6), side);
            const SurfaceMesh mesh = extract_surface(field, 120);
            Random random(7);
            int checked = 0;
            for (int i = 0; i < 400; ++i) {
                const Vec3 p = physical_from_index(geometry, random_index(random, geometry));
                const double density = value_at(field, p);
                // Nearer than the margin the mesh may pass on the other side of the point.
                if (std::abs(density - 120) < 2 * surface_margin * field.range()) continue;
                const Vec3 ray(random.uniform(-1, 1), random.uniform(-1, 1), 1);
                ASSERT_EQ(winding(mesh, p, ray), is_solid(field, 120, density)) << p.transpose();
                ++checked;
            }
            EXPECT_GT(checked, 350);
        }
    }
}

TEST(Surface, encloses_the_volume_that_sampling_counts) {
    const Geometry geometry = mirrored(grid({10, 10, 10}));
    const double box = 11 * 11 * 11 * geometry.spacing.prod();
    for (const Volume& volume : {noise(geometry, 8), salt(geometry, 9)}) {
        const Field field = linear_field(volume);
        const SurfaceMesh mesh = extract_surface(field, 100);
        Random random(10);
        constexpr int count = 400000;
        int solid = 0;
        for (int i = 0; i < count; ++i) {
            const Vec3 p = physical_from_index(geometry, random_index(random, geometry));
            solid += is_solid(field, 100, value_at(field, p));
        }
        const double fraction = double(solid) / count;
        // Four standard deviations of the count: 0.3 % of the box.
        const double tolerance = 4 * std::sqrt(fraction * (1 - fraction) / count) * box;
        EXPECT_NEAR(enclosed_volume(mesh), fraction * box, tolerance);
    }
}

TEST(Surface, of_a_ball_encloses_its_volume_within_one_percent) {
    Geometry geometry = grid({41, 41, 21});
    geometry.spacing = {0.5, 0.5, 1};
    const double exact = 4.0 / 3 * std::numbers::pi * 8 * 8 * 8;
    for (const Mat3& direction : {Mat3(Mat3::Identity()), mirrored(geometry).direction}) {
        geometry.direction = direction;
        const SurfaceMesh mesh = extract_surface(linear_field(ball(geometry, 8)), 0);
        EXPECT_EQ(flaw_in_closed_mesh(mesh), "");
        EXPECT_NEAR(enclosed_volume(mesh), exact, 0.01 * exact);
        // One sphere: V - E + F = 2.
        EXPECT_EQ(mesh.vertices.size(), mesh.triangles.size() / 2 + 2);
    }
}

TEST(Surface, closes_a_body_that_the_border_cuts) {
    Geometry geometry = grid({21, 21, 11});
    const Field field = linear_field(ball(geometry, 9));  // a ball of 18 in a slab of 10
    const SurfaceMesh mesh = extract_surface(field, 0);
    EXPECT_EQ(flaw_in_closed_mesh(mesh), "");
    for (const Vec3& v : mesh.vertices) {
        EXPECT_GT(v[2], -1);
        EXPECT_LT(v[2], 11);
    }
    const double slab = std::numbers::pi * 10 * (81 - 25.0 / 3);
    EXPECT_GT(enclosed_volume(mesh), slab);
    EXPECT_LT(enclosed_volume(mesh), 1.2 * slab);
}

TEST(Surface, bounds_the_free_space_where_the_background_is_solid) {
    const Field field = linear_field(ball(grid({21, 21, 21}), 8), Solid::below);
    const Field solid_outside = linear_field(ball(grid({21, 21, 21}), 8), Solid::below, -100);
    const SurfaceMesh mesh = extract_surface(solid_outside, 0);
    EXPECT_EQ(flaw_in_closed_mesh(mesh), "");
    EXPECT_LT(enclosed_volume(mesh), 0);
    EXPECT_GT(enclosed_volume(extract_surface(field, 0)), 0);
}

TEST(Surface, is_the_same_bit_for_bit_when_extracted_again) {
    const Field field = linear_field(noise(oblique(grid({16, 12, 14})), 11));
    const SurfaceMesh a = extract_surface(field, 77);
    const SurfaceMesh b = extract_surface(field, 77);
    EXPECT_EQ(a.vertices, b.vertices);
    EXPECT_EQ(a.triangles, b.triangles);
}

TEST(Surface, in_boxes_of_cells_is_the_whole_one_in_parts_bit_for_bit) {
    using Corners = std::array<std::array<double, 3>, 3>;
    const auto add_triangles = [](const SurfaceMesh& mesh, std::vector<Corners>& all) {
        for (const auto& t : mesh.triangles) {
            Corners corners;
            for (std::size_t c = 0; c < 3; ++c) {
                const Vec3& v = mesh.vertices[t[c]];
                corners[c] = {v[0], v[1], v[2]};
            }
            std::rotate(corners.begin(), std::ranges::min_element(corners), corners.end());
            all.push_back(corners);
        }
    };
    for (const Geometry& geometry :
         {grid({20, 17, 9}), mirrored(grid({9, 12, 14})), grid({1, 7, 3})}) {
        for (const Volume& volume : {noise(geometry, 21), salt(geometry, 22)}) {
            const Field field = linear_field(volume, Solid::above, 100);
            std::vector<Corners> whole, parts;
            add_triangles(extract_surface(field, 99.5), whole);
            const int step = 5;
            for (int k = -1; k < geometry.size[2]; k += step) {
                for (int j = -1; j < geometry.size[1]; j += step) {
                    for (int i = -1; i < geometry.size[0]; i += step) {
                        SurfaceOptions options;
                        const Index3 low(i, j, k);
                        options.cells = SampleBox{low, low + Index3::Constant(step - 1)};
                        add_triangles(extract_surface(field, 99.5, options), parts);
                    }
                }
            }
            std::ranges::sort(whole);
            std::ranges::sort(parts);
            EXPECT_GT(whole.size(), 100U);
            EXPECT_EQ(whole, parts);
        }
    }
    SurfaceOptions outside;
    outside.cells = SampleBox{Index3(30, 0, 0), Index3(40, 9, 9)};
    EXPECT_TRUE(
        extract_surface(linear_field(noise(grid({8, 8, 8}), 3)), 100, outside).triangles.empty());
}

TEST(Surface, extraction_reports_progress_and_can_be_cancelled) {
    const Field field = linear_field(noise(grid({8, 8, 8}), 12));
    std::vector<double> seen;
    SurfaceOptions options;
    options.progress = [&](double fraction) {
        seen.push_back(fraction);
        return true;
    };
    EXPECT_TRUE(extract_surface(field, 100, options).complete);
    EXPECT_TRUE(std::is_sorted(seen.begin(), seen.end()));
    EXPECT_EQ(seen.front(), 0);
    EXPECT_EQ(seen.back(), 1);
    options.progress = [](double fraction) { return fraction < 0.5; };
    const SurfaceMesh cancelled = extract_surface(field, 100, options);
    EXPECT_FALSE(cancelled.complete);
    EXPECT_TRUE(cancelled.vertices.empty());
    EXPECT_TRUE(cancelled.triangles.empty());
}

TEST(Surface, extraction_refuses_what_it_cannot_do) {
    const Field field = linear_field(noise(grid({8, 8, 8}), 13));
    EXPECT_THROW(extract_surface(field, std::nan("")), std::invalid_argument);
    SurfaceOptions options;
    options.max_vertices = 100;
    EXPECT_THROW(extract_surface(field, 100, options), std::length_error);
}
