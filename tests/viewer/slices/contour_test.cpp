// The contour of a slice, compared with the field that is felt.
#include "apps/viewer/slices/contour.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

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

std::vector<TestField> smooth_fields() {
    std::vector<TestField> all = fields();
    std::erase_if(all, [](const TestField& test) { return test.name == "sheet"; });  // too thin
    for (TestField& test : all) test.field.set_interpolation(Interpolation::cubic);
    return all;
}

struct Sliced {
    Field field;
    SlicePlane plane;
    SliceSamples samples;
    std::vector<ContourPiece> pieces;

    Sliced(const TestField& test, int axis, double position,
           ContourDetail detail = ContourDetail::lattice)
        : field(test.field), plane(slice_plane(field.geometry(), axis)), samples(field, plane) {
        samples.go_to(position);
        append_contour(samples, test.isovalue, {-1, -1, samples.width(), samples.height()}, detail,
                       pieces);
    }
    double value(double u, double v) const {
        const Vec3 index =
            index_from_slice(plane, field.geometry(), Vec3(u, v, samples.position()));
        return value_at(field, physical_from_index(field.geometry(), index));
    }
};

TEST(Contour, lies_on_the_surface_that_is_felt) {
    for (const TestField& test : fields()) {
        for (int axis = 0; axis < 3; ++axis) {
            std::size_t pieces = 0;
            for (const double position : positions(test.field, axis)) {
                const Sliced cut(test, axis, position);
                pieces += cut.pieces.size();
                for (const ContourPiece& p : cut.pieces) {
                    for (const float t : {0.0F, 0.3F, 1.0F}) {
                        const double value =
                            cut.value(p.u0 + t * (p.u1 - p.u0), p.v0 + t * (p.v1 - p.v0));
                        // 32-bit coordinates, and slopes of up to eight ranges a voxel.
                        ASSERT_NEAR(value, test.isovalue, 1e-4 * test.field.range())
                            << test.name << " axis " << axis << " at " << position;
                    }
                }
            }
            EXPECT_GT(pieces, 100U) << test.name;
        }
    }
}

/// Of the field in the slice [data units a sample].
double slope_at(const Sliced& cut, double u, double v) {
    constexpr double step = 1e-3;
    return std::hypot(cut.value(u + step, v) - cut.value(u - step, v),
                      cut.value(u, v + step) - cut.value(u, v - step)) /
           (2 * step);
}

TEST(Contour, of_a_smooth_field_is_bent_along_the_surface_that_is_felt) {
    for (const TestField& test : smooth_fields()) {
        int pieces = 0, off = 0;
        for (int axis = 0; axis < 3; ++axis) {
            for (const double position : positions(test.field, axis)) {
                const Sliced cut(test, axis, position);
                for (const ContourPiece& p : cut.pieces) {
                    const float u = 0.5F * (p.u0 + p.u1), v = 0.5F * (p.v0 + p.v1);
                    const double hair = 1e-3 * test.field.range();
                    ++pieces;
                    off += std::abs(cut.value(p.u0, p.v0) - test.isovalue) > hair ||
                           std::abs(cut.value(u, v) - test.isovalue) >
                               0.015 * slope_at(cut, u, v) + hair;
                }
            }
        }
        EXPECT_GT(pieces, 100) << test.name;
        EXPECT_LE(off, pieces / 50) << test.name;  // about saddles
    }
}

/// The pieces by the cell that they are in.
std::map<std::pair<int, int>, std::vector<ContourPiece>> by_cell(const Sliced& cut) {
    std::map<std::pair<int, int>, std::vector<ContourPiece>> cells;
    for (const ContourPiece& p : cut.pieces) {
        cells[{static_cast<int>(std::floor(0.5F * (p.u0 + p.u1))),
               static_cast<int>(std::floor(0.5F * (p.v0 + p.v1)))}]
            .push_back(p);
    }
    return cells;
}

/// Whether a piece crosses the way from (u0, v) to (u1, v).
bool crossed(const std::vector<ContourPiece>& pieces, double u0, double u1, double v,
             double hair = 1e-4) {
    for (const ContourPiece& p : pieces) {
        if ((p.v0 - v) * (p.v1 - v) > hair * hair) continue;
        const double part = p.v0 == p.v1 ? 0.5 : (v - p.v0) / (p.v1 - p.v0);
        const double u = p.u0 + part * (p.u1 - p.u0);
        if (u > u0 - hair && u < u1 + hair) return true;
    }
    return false;
}

TEST(Contour, is_met_wherever_one_goes_from_solid_to_free) {
    support::Random random(5);
    for (const TestField& test : fields()) {
        int changes = 0;
        for (int axis = 0; axis < 3; ++axis) {
            for (const double position : positions(test.field, axis)) {
                const Sliced cut(test, axis, position);
                const auto cells = by_cell(cut);
                const double sign = test.field.sign();
                for (int i = 0; i < support::scaled(400); ++i) {
                    // Both in the same cell.
                    const int cu = random.below(cut.samples.width() + 1) - 1;
                    const int cv = random.below(cut.samples.height() + 1) - 1;
                    double a = random.uniform(0, 1), b = random.uniform(0, 1);
                    const double v = cv + random.uniform(0.001, 0.999);
                    if (a > b) std::swap(a, b);
                    const double da = sign * (cut.value(cu + a, v) - test.isovalue);
                    const double db = sign * (cut.value(cu + b, v) - test.isovalue);
                    const double clear = 1e-3 * test.field.range();
                    if (std::min(da, db) > -clear || std::max(da, db) < clear) continue;
                    ++changes;
                    const auto cell = cells.find({cu, cv});
                    ASSERT_TRUE(cell != cells.end() && crossed(cell->second, cu + a, cu + b, v))
                        << test.name << " axis " << axis << " at " << position << ": " << cu + a
                        << " to " << cu + b << ", " << v;
                }
            }
        }
        EXPECT_GT(changes, support::scaled(20)) << test.name;
    }
}

TEST(Contour, of_a_smooth_field_is_met_from_solid_to_free) {
    support::Random random(6);
    for (const TestField& test : smooth_fields()) {
        int changes = 0, missed = 0;
        for (int axis = 0; axis < 3; ++axis) {
            for (const double position : positions(test.field, axis)) {
                const Sliced cut(test, axis, position);
                const double sign = test.field.sign();
                for (int i = 0; i < support::scaled(400); ++i) {
                    const double u = random.uniform(-1, cut.samples.width());
                    const double v = random.uniform(-1, cut.samples.height());
                    const double du = random.uniform(0.2, 1);
                    const double da = sign * (cut.value(u, v) - test.isovalue);
                    const double db = sign * (cut.value(u + du, v) - test.isovalue);
                    if ((da > 0) == (db > 0)) continue;
                    ++changes;
                    missed += !crossed(cut.pieces, u, u + du, v, 0.02);
                }
            }
        }
        EXPECT_GT(changes, support::scaled(100)) << test.name;
        EXPECT_LE(missed, changes / 100) << test.name;  // small islands
    }
}

TEST(Contour, of_two_triangles_a_cell_is_less_than_a_sample_away) {
    const TestField test = support::marschner_lobb_field();
    const Sliced exact(test, 2, 11.3), quick(test, 2, 11.3, ContourDetail::cells);
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
        // Where all of the data are solid and the background too, there is no border either.
        EXPECT_TRUE(cut.pieces.empty()) << isovalue;
    }
}

TEST(Contour, a_range_of_cells_gives_the_pieces_of_those_cells) {
    const TestField test = support::noise_field();
    const Sliced whole(test, 1, 3.25);
    std::vector<ContourPiece> parts;
    const SliceSamples& samples = whole.samples;
    append_contour(samples, test.isovalue, {-5, -5, 9, 100}, ContourDetail::lattice, parts);
    append_contour(samples, test.isovalue, {9, -5, 100, 100}, ContourDetail::lattice, parts);
    EXPECT_EQ(parts.size(), whole.pieces.size());
}

}  // namespace
}  // namespace palpate::viewer
