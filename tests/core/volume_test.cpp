// Volume: samples keep their type and place, and impossible geometry is refused.
#include "palpate/volume.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <limits>
#include <vector>

#include "palpate/field.hpp"
#include "support/constants.hpp"
#include "support/fields.hpp"
#include "support/scratch_folder.hpp"

using namespace palpate;
using namespace palpate::support;

namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

template <class T>
class VolumeOf : public testing::Test {};
using SampleTypes = testing::Types<std::uint8_t, std::int16_t, std::uint16_t, float>;
TYPED_TEST_SUITE(VolumeOf, SampleTypes);

Volume made(const Geometry& geometry) {
    const auto count = static_cast<std::size_t>(std::max<std::int64_t>(0, sample_count(geometry)));
    return Volume(geometry, std::vector<std::uint8_t>(count));
}

template <class F>
std::string refusal(F&& make) {
    return message_of<std::invalid_argument>(make);
}

}  // namespace

TYPED_TEST(VolumeOf, keeps_type_bytes_and_order_of_its_samples) {
    const Geometry geometry = grid({3, 4, 5});
    std::vector<TypeParam> samples(60);
    for (std::size_t i = 0; i < samples.size(); ++i) samples[i] = static_cast<TypeParam>(2 * i + 1);
    const TypeParam* data = samples.data();
    const Volume volume(geometry, std::move(samples));
    EXPECT_EQ(volume.type(), sample_type_of<TypeParam>());
    EXPECT_EQ(size_of(volume.type()), sizeof(TypeParam));
    EXPECT_EQ(volume.bytes(), 60 * sizeof(TypeParam));
    EXPECT_EQ(volume.data(), data) << "copied instead of taken";
    EXPECT_EQ(volume.template samples<TypeParam>().data(), data);
    EXPECT_EQ(volume.template samples<TypeParam>().size(), 60U);
    for (int z = 0; z < 5; ++z) {
        for (int y = 0; y < 4; ++y) {
            for (int x = 0; x < 3; ++x) {
                EXPECT_EQ(volume.sample({x, y, z}), 2 * (x + 3 * (y + 4 * z)) + 1);
            }
        }
    }
    EXPECT_EQ(volume.minimum(), 1);
    EXPECT_EQ(volume.maximum(), 119);
    EXPECT_EQ(volume.range(), 118);
    const Volume copy = volume;
    EXPECT_EQ(copy.data(), data) << "a copy shares the samples";
}

TYPED_TEST(VolumeOf, adopts_samples_without_copying_and_gives_them_back) {
    const Geometry geometry = grid({2, 2, 2});
    int given_back = 0;
    auto* data = new TypeParam[8]{1, 2, 3, 4, 5, 6, 7, 8};
    {
        const std::shared_ptr<const void> owner(data, [&](const void* p) {
            delete[] static_cast<const TypeParam*>(p);
            ++given_back;
        });
        const Volume volume(geometry, sample_type_of<TypeParam>(), owner, 8 * sizeof(TypeParam));
        EXPECT_EQ(volume.data(), data);
        EXPECT_EQ(volume.sample({1, 1, 1}), 8);
        EXPECT_EQ(volume.range(), 7);
        EXPECT_EQ(given_back, 0);
    }
    EXPECT_EQ(given_back, 1);
}

TYPED_TEST(VolumeOf, holds_the_extremes_of_its_type) {
    constexpr TypeParam low = std::numeric_limits<TypeParam>::lowest();
    constexpr TypeParam high = std::numeric_limits<TypeParam>::max();
    const Volume volume(grid({2, 1, 1}), std::vector<TypeParam>{high, low});
    EXPECT_EQ(volume.minimum(), static_cast<double>(low));
    EXPECT_EQ(volume.maximum(), static_cast<double>(high));
    EXPECT_EQ(volume.sample({0, 0, 0}), static_cast<double>(high));
    EXPECT_EQ(volume.sample({1, 0, 0}), static_cast<double>(low));
}

TYPED_TEST(VolumeOf, finds_its_least_and_greatest_sample_wherever_they_are) {
    for (int count = 2; count < 140; ++count) {
        for (int at = 0; at < count; ++at) {
            std::vector<TypeParam> samples(static_cast<std::size_t>(count), 50);
            samples[static_cast<std::size_t>(at)] = 60;
            samples[static_cast<std::size_t>((at + count / 2) % count)] = 40;
            const Volume volume(grid({count, 1, 1}), std::move(samples));
            ASSERT_EQ(volume.minimum(), 40) << at << " of " << count;
            ASSERT_EQ(volume.maximum(), 60) << at << " of " << count;
        }
    }
}

TYPED_TEST(VolumeOf, gives_its_samples_as_their_own_type_only) {
    const Volume volume(grid({2, 1, 1}), std::vector<TypeParam>{1, 2});
    if constexpr (!std::is_same_v<TypeParam, float>) {
        EXPECT_THROW(volume.template samples<float>(), std::invalid_argument);
    } else {
        EXPECT_THROW(volume.template samples<std::uint8_t>(), std::invalid_argument);
    }
}

TEST(Volume, of_one_value_has_range_one) {
    EXPECT_EQ(Volume(grid({2, 2, 2}), std::vector<float>(8, -7)).range(), 1);
}

TEST(Volume, names_sample_types_both_ways) {
    for (const SampleType type :
         {SampleType::uint8, SampleType::int16, SampleType::uint16, SampleType::float32}) {
        EXPECT_EQ(sample_type_from(name_of(type)), type);
    }
    EXPECT_NE(refusal([] { sample_type_from("double"); }).find("uint8, int16"), std::string::npos);
    EXPECT_THROW(sample_type_from(""), std::invalid_argument);
}

TEST(Volume, refuses_a_wrong_count_of_samples) {
    for (const std::size_t count : {0, 1, 7, 9, 64}) {
        EXPECT_THROW(Volume(grid({2, 2, 2}), std::vector<std::int16_t>(count)),
                     std::invalid_argument);
    }
    const auto data = std::make_shared<std::array<float, 8>>();
    EXPECT_THROW(Volume(grid({2, 2, 2}), SampleType::float32, data, 31), std::invalid_argument);
    EXPECT_THROW(Volume(grid({2, 2, 2}), SampleType::float32, data, 33), std::invalid_argument);
}

TEST(Volume, refuses_float_samples_that_are_not_finite) {
    for (const double bad : {not_a_number, infinite, -infinite}) {
        for (std::size_t at = 0; at < 36; ++at) {
            std::vector<float> samples(36, 1);
            samples[at] = static_cast<float>(bad);
            EXPECT_NE(refusal([&] {
                          Volume(grid({36, 1, 1}), samples);
                      }).find("not finite"),
                      std::string::npos);
        }
    }
}

TEST(Volume, refuses_geometry_that_makes_no_sense_and_says_what_is_wrong) {
    for (const int bad : {0, -1, -1000, (1 << 20) + 1}) {
        for (int axis = 0; axis < 3; ++axis) {
            Geometry geometry = grid({2, 2, 2});
            geometry.size[axis] = bad;
            EXPECT_THROW(check(geometry), std::invalid_argument);
        }
    }
    for (const double bad : {0.0, -1.0, infinite, -infinite, not_a_number, 1e-200, 1e200, 5e-324}) {
        for (int axis = 0; axis < 3; ++axis) {
            Geometry geometry = grid({2, 2, 2});
            geometry.spacing[axis] = bad;
            EXPECT_NE(refusal([&] { made(geometry); }).find("spacing"), std::string::npos) << bad;
        }
    }
    for (const double bad : {infinite, -infinite, not_a_number}) {
        for (int axis = 0; axis < 3; ++axis) {
            Geometry geometry = grid({2, 2, 2});
            geometry.origin[axis] = bad;
            EXPECT_NE(refusal([&] { made(geometry); }).find("origin"), std::string::npos);
            geometry = grid({2, 2, 2});
            geometry.direction(axis, 1) = bad;
            EXPECT_NE(refusal([&] { made(geometry); }).find("direction"), std::string::npos);
        }
    }
}

TEST(Volume, refuses_sheared_scaled_and_degenerate_directions_and_accepts_rotated_and_mirrored) {
    Geometry geometry = grid({2, 2, 2}, Vec3::Ones(), Vec3::Zero(), oblique_direction());
    EXPECT_NO_THROW(made(geometry));
    geometry.direction.col(1) *= -1;
    EXPECT_NO_THROW(made(geometry));
    geometry.direction(0, 0) += 1e-5;  // what six digits in a file's header leave
    EXPECT_NO_THROW(made(geometry));
    Mat3 sheared = Mat3::Identity();
    sheared(0, 1) = 0.01;
    const std::vector<Mat3> refused{sheared, 2 * Mat3::Identity(), Mat3::Zero(), Mat3::Ones()};
    for (const Mat3& direction : refused) {
        geometry.direction = direction;
        EXPECT_NE(refusal([&] { made(geometry); }).find("orthonormal"), std::string::npos);
    }
}

TEST(Volume, index_and_physical_space_are_each_others_inverse) {
    const Geometry geometry = grid({5, 6, 7}, {0.5, 0.7, 2}, {-100, 30, 7}, oblique_direction());
    Random random(91);
    for (int i = 0; i < 1000; ++i) {
        const Vec3 index = random.point(-10, 20);
        const Vec3 physical = physical_from_index(geometry, index);
        EXPECT_LE((index_from_physical(geometry, physical) - index).norm(), 1e-12);
        // Written out: the columns of the direction are the index axes in physical space.
        const Vec3 expected = geometry.origin + 0.5 * index[0] * geometry.direction.col(0) +
                              0.7 * index[1] * geometry.direction.col(1) +
                              2.0 * index[2] * geometry.direction.col(2);
        EXPECT_LE((physical - expected).norm(), 1e-12);
        const Vec3 v = random.direction();
        const Vec3 back = physical_from_grid_axes(geometry, grid_axes_from_physical(geometry, v));
        EXPECT_LE((back - v).norm(), 1e-14);
    }
    EXPECT_EQ(physical_from_index(geometry, Vec3::Zero()), geometry.origin);
    EXPECT_LE((physical_centre(geometry) - physical_from_index(geometry, {2, 2.5, 3})).norm(),
              1e-12);
}

TEST(Volume, has_the_nearest_direction_that_is_orthonormal_to_all_digits) {
    Random random(92);
    for (int i = 0; i < 200; ++i) {
        Geometry geometry = grid({2, 2, 2}, {0.5, 0.7, 2}, {-300, 30, 7}, oblique_direction());
        if (i % 2) geometry.direction.col(1) *= -1;
        EXPECT_EQ(made(geometry).geometry(), geometry) << "what is orthonormal stays as it is";
        const Mat3 exact = geometry.direction;
        for (int k = 0; k < 9; ++k) geometry.direction(k / 3, k % 3) += random.uniform(-3e-5, 3e-5);
        const Geometry had = made(geometry).geometry();
        const Mat3 error = had.direction.transpose() * had.direction - Mat3::Identity();
        EXPECT_LE(error.cwiseAbs().maxCoeff(), 1e-14);
        EXPECT_LE((had.direction - exact).cwiseAbs().maxCoeff(), 1e-4);
        const Vec3 physical = random.point(-10, 10);
        const Vec3 back = physical_from_index(had, index_from_physical(had, physical));
        EXPECT_LE((back - physical).norm(), 1e-11) << "300 mm from the origin";
        // Samples of a large grid as well.
        const Samples large(made(geometry), geometry, ResidentBricks(geometry.size), 0, 1);
        EXPECT_EQ(large.geometry(), had);
    }
}

/// One pass at one sample, straight from the definition.
double binomial(const Volume& volume, const Index3& at) {
    double sum = 0;
    for (int k = -1; k <= 1; ++k) {
        for (int j = -1; j <= 1; ++j) {
            for (int i = -1; i <= 1; ++i) {
                const Index3 near = (at + Index3(i, j, k))
                                        .cwiseMax(0)
                                        .cwiseMin(volume.geometry().size - Index3::Ones());
                sum += volume.sample(near) * (2 - std::abs(i)) * (2 - std::abs(j)) *
                       (2 - std::abs(k)) / 64;
            }
        }
    }
    return sum;
}

TYPED_TEST(VolumeOf, smoothed_once_is_the_binomial_mean_of_the_neighbours) {
    Geometry geometry;
    geometry.size = {5, 1, 4};
    geometry.spacing = {0.5, 2, 1};
    std::vector<TypeParam> samples;
    for (int i = 0; i < 20; ++i) samples.push_back(static_cast<TypeParam>(i * i % 101));
    const Volume volume(geometry, samples);
    const Volume smooth = smoothed(volume);
    EXPECT_EQ(smooth.geometry(), geometry);
    EXPECT_EQ(smooth.type(), SampleType::float32);
    for (int k = 0; k < 4; ++k) {
        for (int i = 0; i < 5; ++i) {
            EXPECT_NEAR(smooth.sample({i, 0, k}), binomial(volume, {i, 0, k}), 1e-4) << i << k;
        }
    }
}

TEST(Volume, work_is_called_with_the_type_that_the_samples_have) {
    for (const SampleType type :
         {SampleType::uint8, SampleType::int16, SampleType::uint16, SampleType::float32}) {
        EXPECT_EQ(with_type(type, [](auto zero) { return sample_type_of<decltype(zero)>(); }),
                  type);
    }
}

TEST(Volume, sharpened_gives_a_lone_sample_its_height_in_the_smooth_field) {
    std::vector<std::uint8_t> samples(7 * 7 * 7, 0);
    samples[3 + 7 * (3 + 7 * 3)] = 96;
    const Geometry geometry{.size = {7, 7, 7}};
    const Volume sharp = sharpened(Volume(geometry, samples));
    EXPECT_EQ(sharp.sample({3, 3, 3}), 96 * 1.75);
    EXPECT_EQ(sharp.sample({3, 4, 3}), -12);
    EXPECT_EQ(sharp.sample({4, 4, 3}), 0);
    const auto peak = [&](const Volume& volume) {
        return value_at(Field(volume, Solid::above, 0.0, Interpolation::cubic), Vec3(3, 3, 3));
    };
    EXPECT_NEAR(peak(Volume(geometry, samples)), 36, 1e-9);
    EXPECT_NEAR(peak(sharp), 57, 1e-9);  // (36 * 168 - 8 * 6 * 12) / 96
}

TEST(Volume, sharpened_quadratics_are_in_the_smooth_field_what_they_were) {
    const Geometry geometry{.size = {9, 8, 7}};
    const auto quadratic = [](const Vec3& p) {
        return 3 * p[0] * p[0] - 2 * p[1] * p[1] + p[2] * p[2] + p[0] * p[1] - 4 * p[2] + 5;
    };
    std::vector<float> samples;
    for (int k = 0; k < 7; ++k) {
        for (int j = 0; j < 8; ++j) {
            for (int i = 0; i < 9; ++i)
                samples.push_back(static_cast<float>(quadratic({1.0 * i, 1.0 * j, 1.0 * k})));
        }
    }
    const Field field(sharpened(Volume(geometry, samples)), Solid::above, std::nullopt,
                      Interpolation::cubic);
    for (const Vec3& at : {Vec3(4, 4, 3), Vec3(3.3, 4.2, 2.9), Vec3(5.5, 3.5, 3.1)}) {
        EXPECT_NEAR(value_at(field, at), quadratic(at), 1e-3);
    }
}

/// How often work reports progress, which never falls or leaves 0..1.
template <class Work>
int reports_of(Work&& work) {
    int reports = 0;
    double last = 0;
    work([&](double part) {
        EXPECT_GE(part, last);
        EXPECT_LE(part, 1);
        last = part;
        ++reports;
    });
    return reports;
}

TEST(Volume, smoothed_and_sharpened_report_progress_and_stop_when_that_throws) {
    struct Cancelled {};
    const OnProgress cancel = [](double) { throw Cancelled(); };
    for (const Index3& size : {Index3(128, 64, 64), Index3(1024, 512, 1), Index3(1, 1, 1 << 19)}) {
        Geometry geometry;
        geometry.size = size;
        const auto count = static_cast<std::size_t>(sample_count(geometry));
        const Volume volume(geometry, std::vector<std::uint8_t>(count, 3));
        EXPECT_GE(reports_of([&](const OnProgress& p) { (void)smoothed(volume, 2, p); }), 7);
        EXPECT_GE(reports_of([&](const OnProgress& p) { (void)sharpened(volume, p); }), 2);
        EXPECT_THROW((void)smoothed(volume, 1, cancel), Cancelled);
        EXPECT_THROW((void)sharpened(volume, cancel), Cancelled);
        const std::shared_ptr<const void> samples(volume.data(), [](const void*) {});
        EXPECT_THROW(Volume(geometry, volume.type(), samples, volume.bytes(), cancel), Cancelled);
    }
}

TEST(Volume, smoothed_twice_is_smoothed_and_smoothed_and_not_at_all_is_the_same) {
    Geometry geometry;
    geometry.size = {4, 3, 2};
    std::vector<std::uint8_t> samples(24);
    for (std::size_t i = 0; i < 24; ++i) samples[i] = static_cast<std::uint8_t>(37 * i % 256);
    const Volume volume(geometry, samples);
    const Volume twice = smoothed(volume, 2), again = smoothed(smoothed(volume));
    EXPECT_TRUE(std::ranges::equal(twice.samples<float>(), again.samples<float>()));
    EXPECT_EQ(smoothed(volume, 0).data(), volume.data());
    EXPECT_THROW(smoothed(volume, -1), std::invalid_argument);
    EXPECT_THROW(smoothed(volume, 65), std::invalid_argument);
}
