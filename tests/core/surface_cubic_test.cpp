// Surface of the smooth field: closed and oriented for any data, and on the isosurface that is
// felt.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>

#include "palpate/edit.hpp"
#include "palpate/field.hpp"
#include "palpate/surface.hpp"
#include "support/cubic_reference.hpp"
#include "support/fields.hpp"
#include "support/mesh_checks.hpp"
#include "support/paper_lattice.hpp"

using namespace palpate;
using namespace palpate::support;

namespace {

std::vector<TestField> smooth_fields() {
    std::vector<TestField> fields{noise_field(),       salt_field(),    box_field(),
                                  anisotropic_field(), oblique_field(), marschner_lobb_field(),
                                  offset_field(),      terraces_field()};
    fields.push_back(noise_field(7, Solid::below));
    for (TestField& test : fields) test.field = smooth(test.field);
    return fields;
}

double excess_at(const Field& field, double isovalue, const Vec3& point) {
    return std::abs(value_at(field, point) - isovalue) / field.range();
}

/// Distance in index space from the nearest sample, face's centre or corner of a cube along an
/// axis.
bool is_near_a_node(const Field& field, const Vec3& point) {
    const Vec3 twice = 2 * index_from_physical(field.geometry(), point);
    const Vec3 off = twice - twice.array().round().matrix();
    return off.cwiseAbs().maxCoeff() <= 2.001 * surface_margin;
}

}  // namespace

TEST(SmoothSurface, is_closed_and_oriented_on_every_kind_of_field) {
    for (const TestField& test : smooth_fields()) {
        SCOPED_TRACE(test.name);
        const SurfaceMesh mesh = extract_surface(test.field, test.isovalue);
        EXPECT_GT(mesh.triangles.size(), 1000U);
        EXPECT_EQ(flaw_in_closed_mesh(mesh), "");
        EXPECT_GT(enclosed_volume(mesh), 0);
    }
}

TEST(SmoothSurface, has_its_vertices_on_what_is_felt) {
    for (const TestField& test : smooth_fields()) {
        SCOPED_TRACE(test.name);
        std::size_t at_nodes = 0;
        const SurfaceMesh mesh = extract_surface(test.field, test.isovalue);
        for (const Vec3& vertex : mesh.vertices) {
            const double off = excess_at(test.field, test.isovalue, vertex);
            if (off > 1e-9 && is_near_a_node(test.field, vertex)) {
                ++at_nodes;  // kept away from the node by surface_margin
                ASSERT_LE(off, 4 * surface_margin);
                continue;
            }
            ASSERT_LE(off, 1e-9) << vertex.transpose();
        }
        // Where samples do not lie on the isovalue these are few.
        if (test.name == "noise" || test.name == "oblique") {
            EXPECT_LT(at_nodes, mesh.vertices.size() / 50);
        }
    }
}

TEST(SmoothSurface, has_its_vertices_where_the_reference_is_at_the_isovalue) {
    const TestField test = marschner_lobb_field();
    const Field field = smooth(test.field);
    const SurfaceMesh mesh = extract_surface(field, test.isovalue);
    const auto sample = [&](const Index3& at) { return paper_sample(field, at); };
    for (std::size_t v = 0; v < mesh.vertices.size(); v += 97) {
        if (is_near_a_node(field, mesh.vertices[v])) continue;
        const Vec3 index = index_from_physical(field.geometry(), mesh.vertices[v]);
        const auto value = cubic_value(index.cast<long double>(), sample).value;
        ASSERT_NEAR(double(value), test.isovalue, 1e-9 * field.range());
    }
}

TEST(SmoothSurface, is_where_edits_and_moments_put_it) {
    const TestField test = noise_field();
    const auto base = test.field.shared_samples();
    const auto carved = edited(base, edit::Fill{{Index3(4, 5, 6), Index3(12, 19, 11)}, 0}).samples;
    const auto now = carved;
    Field field(now, Solid::above, std::nullopt, Interpolation::cubic);
    const SurfaceMesh mesh = extract_surface(field, test.isovalue);
    EXPECT_EQ(flaw_in_closed_mesh(mesh), "");
    EXPECT_NE(mesh.vertices, extract_surface(smooth(test.field), test.isovalue).vertices);
    for (const Vec3& vertex : mesh.vertices) {
        ASSERT_TRUE(excess_at(field, test.isovalue, vertex) <= 1e-9 ||
                    is_near_a_node(field, vertex));
    }
}

TEST(SmoothSurface, in_boxes_is_the_whole_one_bit_for_bit) {
    const TestField test = oblique_field();
    const Field field = smooth(test.field);
    const SurfaceMesh whole = extract_surface(field, test.isovalue);
    const SampleBox all = surface_cells(field);
    const int middle = 9;
    std::size_t triangles = 0;
    std::set<std::array<double, 3>> vertices;
    for (int part = 0; part < 8; ++part) {
        SurfaceOptions options;
        options.cells = all;
        for (int a = 0; a < 3; ++a) {
            if (part >> a & 1) {
                options.cells->low[a] = middle + 1;
            } else {
                options.cells->high[a] = middle;
            }
        }
        const SurfaceMesh mesh = extract_surface(field, test.isovalue, options);
        triangles += mesh.triangles.size();
        for (const Vec3& v : mesh.vertices) vertices.insert({v[0], v[1], v[2]});
    }
    EXPECT_EQ(triangles, whole.triangles.size());
    std::set<std::array<double, 3>> expected;
    for (const Vec3& v : whole.vertices) expected.insert({v[0], v[1], v[2]});
    EXPECT_EQ(vertices, expected);
}

TEST(SmoothSurface, has_facets_as_near_to_it_as_asked) {
    for (const TestField& test : smooth_fields()) {
        if (test.name != "box" && test.name != "marschner_lobb" && test.name != "oblique") continue;
        SCOPED_TRACE(test.name);
        const Field& field = test.field;
        const double voxel = field.geometry().spacing.minCoeff();
        SurfaceOptions options;
        options.tolerance = 0.01;
        const SurfaceMesh coarse = extract_surface(field, test.isovalue);
        const SurfaceMesh fine = extract_surface(field, test.isovalue, options);
        EXPECT_EQ(flaw_in_closed_mesh(fine), "");
        EXPECT_GT(fine.triangles.size(), coarse.triangles.size() * 5 / 4);
        std::size_t edges = 0, far = 0;
        for (const auto& t : fine.triangles) {
            for (int i = 0; i < 3; ++i) {
                const Vec3 middle = 0.5 * (fine.vertices[t[i]] + fine.vertices[t[(i + 1) % 3]]);
                const double slope = gradient_at(field, middle).norm();
                const double off = std::abs(value_at(field, middle) - test.isovalue) / slope;
                ++edges;
                far += off > 1.5 * options.tolerance * voxel;
            }
        }
        EXPECT_LT(far,
                  edges / 50);  // where the surface pinches, Newton's method finds another part
    }
}

TEST(SmoothSurface, can_be_cancelled_while_facets_are_split) {
    const TestField test = oblique_field();
    const Field field = smooth(test.field);
    SurfaceOptions options;
    int calls = 0;
    options.progress = [&](double) { return ++calls > 0; };
    (void)extract_surface(field, test.isovalue, options);
    options.progress = [&](double) { return --calls >= 0; };  // the first one after those
    options.tolerance = 0.01;
    const SurfaceMesh mesh = extract_surface(field, test.isovalue, options);
    EXPECT_FALSE(mesh.complete);
    EXPECT_TRUE(mesh.triangles.empty());
}

TEST(SmoothSurface, normals_can_be_cancelled) {
    const TestField test = oblique_field();
    const Field field = smooth(test.field);
    int calls = 0;
    SurfaceOptions options;
    options.progress = [&](double) { return ++calls > 0; };
    (void)extract_surface(field, test.isovalue, options);
    options.progress = [&](double) { return --calls >= 0; };  // the first one after those
    options.normals = true;
    const SurfaceMesh mesh = extract_surface(field, test.isovalue, options);
    EXPECT_FALSE(mesh.complete);
    EXPECT_TRUE(mesh.triangles.empty());
}

TEST(SmoothSurface, has_the_normals_that_are_felt) {
    const TestField test = oblique_field();
    SurfaceOptions options;
    options.normals = true;
    EXPECT_TRUE(extract_surface(test.field, test.isovalue, options).normals.empty());
    const Field field = smooth(test.field);
    const SurfaceMesh mesh = extract_surface(field, test.isovalue, options);
    ASSERT_EQ(mesh.normals.size(), mesh.vertices.size());
    for (std::size_t i = 0; i < mesh.normals.size(); i += 13) {
        const Vec3 out = -field.sign() * gradient_at(field, mesh.vertices[i]).normalized();
        EXPECT_LT((mesh.normals[i] - out).norm(), 1e-12);
    }
}

TEST(SmoothSurface, of_a_body_that_the_border_cuts_is_closed_outside_the_grid) {
    const Field field(Volume(grid({5, 6, 7}), std::vector<std::uint8_t>(210, 200)), Solid::above,
                      0.0, Interpolation::cubic);
    const SurfaceMesh mesh = extract_surface(field, 100);
    EXPECT_EQ(flaw_in_closed_mesh(mesh), "");
    EXPECT_NEAR(enclosed_volume(mesh), 5 * 6 * 7, 15);
}
