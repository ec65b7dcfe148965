// Field: a volume continued over all of space.
#include "palpate/field.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "layers/cover.hpp"
#include "support/fields.hpp"
#include "support/paper_lattice.hpp"

using namespace palpate;
using namespace palpate::support;

namespace {

template <class T>
class FieldOf : public testing::Test {};
using SampleTypes = testing::Types<std::uint8_t, std::int16_t, std::uint16_t, float>;
TYPED_TEST_SUITE(FieldOf, SampleTypes);

}  // namespace

TYPED_TEST(FieldOf, gives_the_eight_samples_of_every_cell_and_background_outside) {
    const Volume volume = noise_volume<TypeParam>(grid({5, 4, 3}), 81, 10, 200);
    const Field field = linear_field(volume, Solid::above, 7.0);
    for (int z = -4; z < 7; ++z) {
        for (int y = -4; y < 8; ++y) {
            for (int x = -4; x < 9; ++x) {
                const Index3 cell(x, y, z);
                const CellSamples samples = field.cell(cell);
                bool all_background = true;
                for (int c = 0; c < 8; ++c) {
                    const Index3 at = cell + Index3(c & 1, c >> 1 & 1, c >> 2 & 1);
                    ASSERT_EQ(samples[static_cast<std::size_t>(c)], paper_sample(field, at));
                    all_background &= (at.array() < 0).any() ||
                                      (at.array() >= field.geometry().size.array()).any();
                }
                ASSERT_EQ(field.is_background(cell), all_background) << cell.transpose();
            }
        }
    }
    // As far out as an index goes.
    constexpr int far = 1'000'000'000;
    for (const Index3& cell : {Index3(far, 0, 0), Index3(-far, -far, -far), Index3(1, 1, far)}) {
        EXPECT_TRUE(field.is_background(cell));
        for (const double s : field.cell(cell)) EXPECT_EQ(s, 7.0);
    }
}

TYPED_TEST(FieldOf, gives_every_sample_with_its_neighbours_and_background_outside) {
    const Volume volume = noise_volume<TypeParam>(grid({5, 4, 3}), 81, 10, 200);
    const Field field = linear_field(volume, Solid::above, 7.0);
    for (int n = 0; n < 13 * 12 * 11; ++n) {
        const Index3 at(n % 13 - 4, n / 13 % 12 - 4, n / (13 * 12) - 4);
        const Neighbours samples = field.around(at);
        bool all_background = true;
        for (int i = 0; i < 27; ++i) {
            const Index3 there = at + Index3(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
            ASSERT_EQ(samples[static_cast<std::size_t>(i)], paper_sample(field, there));
            all_background &=
                (there.array() < 0).any() || (there.array() >= field.geometry().size.array()).any();
        }
        ASSERT_EQ(field.is_background_around(at), all_background) << at.transpose();
    }
    EXPECT_TRUE(field.is_background_around(Index3(1'000'000'000, 0, 0)));
    EXPECT_TRUE(field.is_background_around(Index3::Constant(-1'000'000'000)));
}

TEST(Field, background_is_the_minimum_or_for_solid_below_the_maximum_or_what_is_given) {
    const Volume volume = noise_volume<std::int16_t>(grid({5, 4, 3}), 82, -1000, 1000);
    EXPECT_EQ(linear_field(volume).background(), volume.minimum());
    EXPECT_EQ(linear_field(volume, Solid::below).background(), volume.maximum());
    EXPECT_EQ(linear_field(volume, Solid::above, 12.5).background(), 12.5);
    EXPECT_EQ(linear_field(volume, Solid::below, -3000.0).background(), -3000);
    EXPECT_EQ(linear_field(volume).sign(), 1);
    EXPECT_EQ(linear_field(volume, Solid::below).sign(), -1);
    EXPECT_EQ(linear_field(volume, Solid::below).solid(), Solid::below);
}

TEST(Field, range_covers_samples_and_background_and_is_never_zero) {
    const Volume volume = noise_volume<std::int16_t>(grid({5, 4, 3}), 83, -1000, 1000);
    EXPECT_EQ(linear_field(volume).range(), volume.range());
    EXPECT_EQ(linear_field(volume, Solid::above, -5000.0).range(), volume.maximum() + 5000);
    EXPECT_EQ(linear_field(volume, Solid::above, 5000.0).range(), 5000 - volume.minimum());
    const Volume constant(grid({2, 2, 2}), std::vector<float>(8, 3.5F));
    EXPECT_EQ(linear_field(constant).range(), 1);
    EXPECT_GT(linear_field(constant).tolerance(), 0);
}

TEST(Field, tolerance_is_a_small_part_of_the_range_and_covers_rounding_far_from_zero) {
    EXPECT_LE(noise_field().field.tolerance(), 1e-10 * 255);
    const Field field = offset_field().field;
    EXPECT_GE(field.tolerance(), 1e6 * 4e-16);
    EXPECT_LE(field.tolerance(), 1e-9 * field.range());
}

TEST(Field, refuses_a_background_that_is_not_finite) {
    const Volume volume = noise_volume<std::uint8_t>(grid({2, 2, 2}), 84, 0, 255);
    for (const double bad :
         {std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity(),
          std::numeric_limits<double>::quiet_NaN()}) {
        EXPECT_THROW(linear_field(volume, Solid::above, bad), std::invalid_argument);
    }
}

TEST(Field, closes_a_body_that_the_border_cuts) {
    for (const Solid solid : {Solid::above, Solid::below}) {
        std::vector<std::uint8_t> samples(64, solid == Solid::above ? 255 : 0);
        samples[21] = 128;  // so that the range is not empty
        samples[42] = solid == Solid::above ? 0 : 255;
        const Field field = linear_field(Volume(grid({4, 4, 4}), std::move(samples)), solid);
        const double inside = value_at(field, Vec3(0, 0, 3));
        const double outside = value_at(field, Vec3(0, 0, 4));
        EXPECT_GT(field.sign() * (inside - 128), 0);
        EXPECT_LT(field.sign() * (outside - 128), 0);
    }
}

TEST(Field, of_a_volume_one_voxel_thin_is_a_sheet) {
    for (int axis = 0; axis < 3; ++axis) {
        Index3 size = Index3::Constant(6);
        size[axis] = 1;
        const Field field =
            linear_field(volume_of<std::uint8_t>(grid(size), [](const Index3&) { return 200; }),
                         Solid::above, 0.0);
        Random random(85);
        for (int i = 0; i < 500; ++i) {
            Vec3 p = random.point(0.5, 4.5);
            p[axis] = random.uniform(-2, 2);
            // On the sheet the data, a voxel off it nothing, and monotone between.
            const double value = value_at(field, p);
            ASSERT_TRUE(std::abs(p[axis]) < 1 || value == 0);
            Vec3 nearer = p;
            nearer[axis] *= 0.9;
            ASSERT_GE(value_at(field, nearer), value);
            p[axis] = 0;
            ASSERT_NEAR(value_at(field, p), 200, 1e-12);
        }
    }
    const Field point =
        linear_field(Volume(grid({1, 1, 1}), std::vector<float>{5}), Solid::above, 1.0);
    EXPECT_EQ(value_at(point, Vec3::Zero()), 5);
    EXPECT_EQ(value_at(point, Vec3(1, 0, 0)), 1);
    EXPECT_GT(value_at(point, Vec3(0.3, 0.2, 0.1)), 1);
}

TEST(Field, of_labels_that_cover_themselves_is_1_in_the_solid_ones_and_0_in_others) {
    const Volume labels = noise_volume<std::uint8_t>(grid({5, 4, 3}), 86, 0, 32);
    const auto itself = std::make_shared<const Field>(labels, Solid::above, 0.0);
    Field field = *itself;
    for (const std::uint32_t shown : {0x5a5a5a5bU, 0xa5a5a5a4U}) {
        LabelCover::put(field, itself, shown, 0, 1);
        const auto label = [&](const Index3& at) {
            const bool in_grid =
                (at.array() >= 0).all() && (at.array() < labels.geometry().size.array()).all();
            return in_grid ? static_cast<unsigned>(labels.sample(at)) : 0U;
        };
        for (int place = 0; place < 11 * 11 * 11; ++place) {
            const Index3 at(place % 11 - 3, place / 11 % 11 - 3, place / 121 - 3);
            const CellSamples cell = field.cell(at);
            for (int c = 0; c < 8; ++c) {
                const Index3 corner = at + Index3(c & 1, c >> 1 & 1, c >> 2 & 1);
                ASSERT_EQ(cell[c], shown >> label(corner) & 1U);
            }
            const Neighbours around = field.around(at);
            std::uint32_t seen = 0;
            for (int n = 0; n < 27; ++n) {
                const unsigned of = label(at + Index3(n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1));
                ASSERT_EQ(around[n], shown >> of & 1U);
                seen |= of;
            }
            ASSERT_EQ(LabelCover::is_near(field, at), seen > 0);
        }
    }
}
