// The contour of a slice, compared with the field that is felt.
#include "apps/viewer/slices/contour.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "palpate/field.hpp"
#include "support/fields.hpp"

namespace palpate::viewer {
namespace {

using support::TestField;

std::vector<TestField> fields() {
    return {support::noise_field(1, Solid::below), support::salt_field(), support::sheet_field(),
            support::anisotropic_field(), support::oblique_field()};
}

/// In the grid, between layers, exactly halfway, in the ring of cells round the grid.
std::vector<double> positions(const Field& field, int axis) {
    const double last = field.geometry().size[axis] - 1;
    return {0, 5, 6.25, 7.5, 9.9, last, -0.4, last + 0.7};
}

/// Linear and smooth ones.
std::vector<TestField> all_fields() {
    std::vector<TestField> all = fields();
    for (TestField test : fields()) {
        if (test.name == "sheet") continue;  // too thin for a smooth field
        test.name += ", smooth";
        test.field.set_interpolation(Interpolation::cubic);
        all.push_back(test);
    }
    return all;
}

constexpr int fine = 16;  // parts

struct Sliced {
    Field field;
    SlicePlane plane;
    SliceSamples samples;
    std::vector<ContourPiece> pieces;

    Sliced(const TestField& test, int axis, double position, int parts = fine)
        : field(test.field), plane(slice_plane(field.geometry(), axis)), samples(field, plane) {
        samples.go_to(position);
        append_contour(samples, test.isovalue, {-2, -2, samples.width() + 1, samples.height() + 1},
                       parts, pieces);
    }
    double value(double u, double v) const {
        return value_at(field, plane.physical({u, v, samples.position()}));
    }
};

TEST(SliceSamples, have_the_values_of_the_field_that_is_felt) {
    support::Random random(4);
    for (const TestField& test : all_fields()) {
        for (int axis = 0; axis < 3; ++axis) {
            for (const double position : positions(test.field, axis)) {
                const Sliced cut(test, axis, position);
                for (int i = 0; i < 50; ++i) {
                    const double u = random.uniform(-2, cut.samples.width() + 1);
                    const double v = random.uniform(-2, cut.samples.height() + 1);
                    ASSERT_NEAR(cut.samples.value(test.field.interpolation(), u, v),
                                cut.value(u, v), 1e-5 * test.field.range())
                        << test.name << " axis " << axis << " at " << position << ": " << u << ", "
                        << v;
                }
            }
        }
    }
}

/// Slope of the field in the slice [data units per sample].
double slope_at(const Sliced& cut, double u, double v) {
    constexpr double step = 1e-3;
    return std::hypot(cut.value(u + step, v) - cut.value(u - step, v),
                      cut.value(u, v + step) - cut.value(u, v - step)) /
           (2 * step);
}

TEST(Contour, lies_on_the_surface_that_is_felt) {
    for (const TestField& test : all_fields()) {
        int points = 0, off = 0;
        for (int axis = 0; axis < 3; ++axis) {
            for (const double position : positions(test.field, axis)) {
                const Sliced cut(test, axis, position);
                for (const ContourPiece& p : cut.pieces) {
                    for (const float t : {0.0F, 0.5F}) {
                        const float u = p.u0 + t * (p.u1 - p.u0), v = p.v0 + t * (p.v1 - p.v0);
                        ++points;
                        off += std::abs(cut.value(u, v) - test.isovalue) >
                               0.015 * slope_at(cut, u, v) + 1e-3 * test.field.range();
                    }
                }
            }
        }
        EXPECT_GT(points, 1000) << test.name;
        EXPECT_LE(off, points / 50) << test.name;  // about saddles and edges
    }
}

/// Whether a piece crosses the way from (u0, v) to (u1, v).
bool crossed(const std::vector<ContourPiece>& pieces, double u0, double u1, double v, double hair) {
    for (const ContourPiece& p : pieces) {
        if ((p.v0 - v) * (p.v1 - v) > hair * hair) continue;
        const double part = p.v0 == p.v1 ? 0.5 : (v - p.v0) / (p.v1 - p.v0);
        const double u = p.u0 + part * (p.u1 - p.u0);
        if (u > u0 - hair && u < u1 + hair) return true;
    }
    return false;
}

TEST(Contour, is_met_wherever_one_goes_from_solid_to_free) {
    support::Random random(6);
    for (const TestField& test : all_fields()) {
        int changes = 0, missed = 0;
        for (int axis = 0; axis < 3; ++axis) {
            for (const double position : positions(test.field, axis)) {
                const Sliced cut(test, axis, position);
                const double sign = test.field.sign();
                for (int i = 0; i < support::scaled(400); ++i) {
                    const double u = random.uniform(-2, cut.samples.width() + 1);
                    const double v = random.uniform(-2, cut.samples.height() + 1);
                    const double du = random.uniform(0.2, 1);
                    const double da = sign * (cut.value(u, v) - test.isovalue);
                    const double db = sign * (cut.value(u + du, v) - test.isovalue);
                    if ((da > 0) == (db > 0)) continue;
                    ++changes;
                    missed += !crossed(cut.pieces, u, u + du, v, 0.02);
                }
            }
        }
        EXPECT_GT(changes, support::scaled(20)) << test.name;
        EXPECT_LE(missed, changes / 100) << test.name;  // small islands
    }
}

TEST(Contour, through_the_samples_alone_is_less_than_a_sample_away) {
    const TestField test = support::marschner_lobb_field();
    const Sliced exact(test, 2, 11.3), quick(test, 2, 11.3, 1);
    ASSERT_GT(quick.pieces.size(), 100U);
    EXPECT_LT(3 * quick.pieces.size(), exact.pieces.size());
    for (const ContourPiece& q : quick.pieces) {
        double nearest = 9;
        for (const ContourPiece& e : exact.pieces) {
            nearest = std::min<double>(nearest, std::hypot(e.u0 - q.u0, e.v0 - q.v0));
        }
        EXPECT_LT(nearest, 1);
    }
}

TEST(Contour, no_level_without_a_surface_has_one) {
    const TestField test = support::noise_field();
    for (const double isovalue : {-1e9, 1e9, std::nan(""), std::numeric_limits<double>::infinity(),
                                  -std::numeric_limits<double>::infinity()}) {
        const Sliced cut({test.name, test.field, isovalue}, 0, 4.5);
        // If data and background are solid, there is no border either.
        EXPECT_TRUE(cut.pieces.empty()) << isovalue;
    }
}

TEST(Contour, a_range_of_cells_gives_the_pieces_of_those_cells) {
    const TestField test = support::noise_field();
    const Sliced whole(test, 1, 3.25);
    std::vector<ContourPiece> parts;
    const SliceSamples& samples = whole.samples;
    append_contour(samples, test.isovalue, {-5, -5, 9, 100}, fine, parts);
    append_contour(samples, test.isovalue, {9, -5, 100, 100}, fine, parts);
    EXPECT_EQ(parts.size(), whole.pieces.size());
}

}  // namespace
}  // namespace palpate::viewer
