// The smooth field: equal to the slow reference, C1 everywhere, within the range of its samples.
#include "palpate/cubic.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "support/cubic_reference.hpp"
#include "support/edits.hpp"
#include "support/fields.hpp"
#include "support/paper_lattice.hpp"
#include "tool_proxy/around.hpp"

using namespace palpate;
using namespace palpate::support;

namespace {

std::vector<TestField> every_kind() {
    return {
        noise_field(),
        noise_field(7, Solid::below),
        anisotropic_field(),
        oblique_field(),
        offset_field(),
        marschner_lobb_field(),
        {"float", linear_field(noise_volume<float>(grid({7, 9, 8}), 6, -3, 9), Solid::below), 2}};
}

/// A random point of the folded tetrahedron on the walls of a mask.
Vec3 random_on_walls(Random& random, unsigned walls = 0) {
    const double d = random.uniform(0, 0.5);
    const double s = random.uniform(0, d);
    return snap({d, s, random.uniform(-s, s)}, walls);
}

/// A random point (index space) in and a little outside a field's grid, half of them on walls.
Vec3 random_index(Random& random, const Field& field) {
    const Vec3 size = field.geometry().size.cast<double>();
    const Vec3 p = random.point(-0.2, 1.2).cwiseProduct(size) - Vec3::Constant(0.5);
    return random.chance(0.5) ? p : Vec3((p * 4).array().round() / 4);
}

/// A field whose samples are a function of their index, without a border near the points of a test.
template <class T, class F>
Field field_of(F&& sample) {
    return Field(volume_of<T>(grid(cube(12)), sample));
}

Vec3 random_inner_index(Random& random) {
    return random.point(3, 8);
}

Vec3 index_gradient(const Field& field, const Vec3& index) {
    const auto [t, folded] = cubic::locate(index);
    return unfold(t, cubic::piece_of(t, field.around(t.cell)).at(folded).gradient) / cubic::scale;
}

/// [data units / mm^2] as tools use it, for a field whose solid is above.
Mat3 hessian_of(const Field& field, const Vec3& physical) {
    tool::Surroundings none;
    return tool::Around(field, 0, none, 0).expand(physical).hessian;
}

}  // namespace

TEST(Cubic, masks_are_means_of_at_most_23_neighbours) {
    std::array<int, 27> used{};
    for (const CubicMask& mask : cubic_masks) {
        int sum = 0;
        for (int n = 0; n < 27; ++n) {
            EXPECT_GE(mask.weights[n], 0);
            sum += mask.weights[n];
            used[n] += mask.weights[n];
        }
        EXPECT_EQ(sum, 192);
    }
    EXPECT_EQ(std::ranges::count_if(used, [](int n) { return n > 0; }), 23);
}

TEST(Cubic, value_and_gradient_are_those_of_the_reference) {
    for (const TestField& test : every_kind()) {
        SCOPED_TRACE(test.name);
        const Field field = smooth(test.field);
        Random random(31);
        for (int i = 0; i < scaled(4000); ++i) {
            const Vec3 index = random_index(random, field);
            const CubicValue expected =
                cubic_value(index.cast<long double>(),
                            [&](const Index3& at) { return paper_sample(field, at); });
            const double near = 1e-13 * field.range() + 2 * field.tolerance();
            ASSERT_NEAR(value_at(field, cubic::locate(index)), double(expected.value), near)
                << index.transpose();
            const Vec3 gradient = index_gradient(field, index);
            ASSERT_LT((gradient - expected.gradient.cast<double>()).norm(), 10 * near)
                << index.transpose();
        }
    }
}

TEST(Cubic, value_and_gradient_are_continuous_across_every_kind_of_wall) {
    for (const TestField& test : every_kind()) {
        SCOPED_TRACE(test.name);
        const Field field = smooth(test.field);
        Random random(32);
        double greatest_jump_of_curvature = 0;
        for (int i = 0; i < scaled(8000); ++i) {
            const unsigned wall = static_cast<unsigned>(i) % wall_count;
            LatticePoint point = cubic::locate(random_index(random, field));
            point.folded = random_on_walls(random, 1U << wall);
            const Tetrahedron& t = point.tetrahedron;
            const Tetrahedron next = across(t, wall);
            const cubic::Piece piece = cubic::piece_of(t, field.around(t.cell));
            const cubic::Piece other = cubic::piece_of(next, field.around(next.cell));
            const auto here = piece.at(point.folded), there = other.at(point.folded);
            const double near = cubic::scale * (1e-13 * field.range() + 2 * field.tolerance());
            ASSERT_NEAR(here.value, there.value, near) << "wall " << wall;
            ASSERT_LT((unfold(t, here.gradient) - unfold(next, there.gradient)).norm(), 10 * near)
                << "wall " << wall;
            greatest_jump_of_curvature =
                std::max(greatest_jump_of_curvature, std::abs(piece.at(point.folded).hessian.d[0] -
                                                              other.at(point.folded).hessian.d[0]));
        }
        // It is C1, not C2: the tetrahedra differ.
        EXPECT_GT(greatest_jump_of_curvature, 0.01 * cubic::scale * field.range());
    }
}

TEST(Cubic, a_mirrored_name_of_a_tetrahedron_has_the_same_field) {
    const Field field = smooth(noise_field().field);
    Random random(33);
    for (int i = 0; i < 1000; ++i) {
        const LatticePoint point = cubic::locate(random_index(random, field));
        Tetrahedron mirrored = point.tetrahedron;
        mirrored.sign[2] = static_cast<std::int8_t>(-mirrored.sign[2]);
        const Vec3 folded(point.folded[0], point.folded[1], -point.folded[2]);
        ASSERT_NEAR(value_at(field, point), value_at(field, LatticePoint{mirrored, folded}),
                    1e-12 * field.range());
    }
}

TEST(Cubic, never_leaves_the_range_of_the_samples) {
    for (const TestField& test : every_kind()) {
        SCOPED_TRACE(test.name);
        const Field field = smooth(test.field);
        const double low = std::min(field.samples().minimum(), field.background());
        const double high = std::max(field.samples().maximum(), field.background());
        Random random(34);
        for (int i = 0; i < scaled(20000); ++i) {
            const double f = value_at(field, cubic::locate(random_index(random, field)));
            ASSERT_GE(f, low - field.tolerance());
            ASSERT_LE(f, high + field.tolerance());
        }
    }
}

TEST(Cubic, reproduces_linear_functions) {
    const Vec3 slope(3, -7, 2);
    const Field field =
        field_of<std::int16_t>([&](const Index3& i) { return 40 + slope.dot(i.cast<double>()); });
    Random random(35);
    for (int i = 0; i < 2000; ++i) {
        const Vec3 index = random_inner_index(random);
        ASSERT_NEAR(value_at(field, cubic::locate(index)), 40 + slope.dot(index), 1e-12);
        ASSERT_EQ(index_gradient(field, index), slope);
    }
}

TEST(Cubic, of_a_quadratic_has_its_gradient_and_an_eighth_of_its_laplacian_more) {
    Mat3 a;
    a << 2, -3, 1, -3, 5, 4, 1, 4, -6;
    const auto quadratic = [&](const Vec3& p) { return p.dot(a * p); };
    const Field field =
        field_of<std::int16_t>([&](const Index3& i) { return quadratic(i.cast<double>()); });
    Random random(36);
    for (int i = 0; i < 2000; ++i) {
        const Vec3 index = random_inner_index(random);
        ASSERT_NEAR(value_at(field, cubic::locate(index)), quadratic(index) + 2 * a.trace() / 8,
                    1e-10);
        ASSERT_LT((index_gradient(field, index) - 2 * a * index).norm(), 1e-11);
        const Mat3 hessian = hessian_of(field, index);
        ASSERT_LT((hessian - 2 * a).norm(), 1e-11);
    }
}

TEST(Cubic, coefficients_of_integer_samples_are_integers) {
    Random random(37);
    for (const TestField& test : {noise_field(), anisotropic_field(), oblique_field()}) {
        for (int i = 0; i < 500; ++i) {
            const Tetrahedron t = cubic::locate(random_index(random, test.field)).tetrahedron;
            const cubic::Piece p = cubic::piece_of(t, test.field.around(t.cell));
            const cubic::Symmetric& h = p.hessian;
            const auto is_whole = [](auto... c) { return ((c == std::round(c)) && ...); };
            ASSERT_TRUE(is_whole(p.value, p.gradient[0], p.gradient[1], p.gradient[2], h.ee));
            for (const cubic::Vec2& pair : {h.d, h.s, h.e, p.dd, p.ds, p.de, p.ss, p.se, p.ee}) {
                ASSERT_TRUE(is_whole(pair[0], pair[1]));
            }
        }
    }
}

TEST(Cubic, of_a_constant_is_that_constant_bit_for_bit) {
    for (const float constant : {0.1F, -3.7e30F, 1e-30F}) {
        const Field field = Field(Volume(grid(cube(6)), std::vector<float>(216, constant)));
        Random random(38);
        for (int i = 0; i < 200; ++i) {
            const Vec3 index = random_index(random, field);
            ASSERT_EQ(value_at(field, cubic::locate(index)), double(constant));
            ASSERT_TRUE(index_gradient(field, index).isZero(0));
        }
    }
}

TEST(Cubic, derivatives_are_physical_on_anisotropic_and_oblique_grids) {
    for (const TestField& test : {anisotropic_field(), oblique_field(), marschner_lobb_field()}) {
        SCOPED_TRACE(test.name);
        const Field field = smooth(test.field);
        const double near = 1e-3 * field.range();
        constexpr double h = 1e-5;  // [mm]
        int jumps = 0;
        Random random(39);
        for (int i = 0; i < 500; ++i) {
            const Vec3 at = physical_from_index(field.geometry(), random.point(2, 12));
            const Vec3 gradient = gradient_at(field, at);
            const Mat3 hessian = hessian_of(field, at);
            for (int a = 0; a < 3; ++a) {
                const Vec3 before = at - h * Vec3::Unit(a), behind = at + h * Vec3::Unit(a);
                const double rise = value_at(field, behind) - value_at(field, before);
                ASSERT_NEAR(gradient[a], rise / (2 * h), near);
                const Vec3 turn = gradient_at(field, behind) - gradient_at(field, before);
                jumps += (hessian.col(a) - turn / (2 * h)).norm() > near;
            }
        }
        // Second derivatives jump where a wall lies between the two points.
        EXPECT_LT(jumps, 5);
    }
}

TEST(Cubic, is_the_background_outside_the_grid) {
    const Field field(noise_volume<std::uint8_t>(grid({3, 4, 5}), 40, 0, 255), Solid::above, 9.0,
                      Interpolation::cubic);
    for (const Vec3& far : {Vec3(-1.5, 1, 1), Vec3(4.5, 2, 2), Vec3(1, 1, 1e8), Vec3(1e30, 0, 0)}) {
        EXPECT_EQ(value_at(field, far), 9);
        EXPECT_TRUE(gradient_at(field, far).isZero(0));
    }
    EXPECT_NE(value_at(field, Vec3(-1.4, 1, 1)), 9);
}
