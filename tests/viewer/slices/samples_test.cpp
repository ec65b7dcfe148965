// Samples of slices between layers, and grey levels.
#include "apps/viewer/slices/samples.hpp"

#include <gtest/gtest.h>

#include "support/fields.hpp"

namespace palpate::viewer {
namespace {

/// A value that tells its place, on a mirrored and turned grid.
Field ramp(SampleType type) {
    Mat3 direction;
    direction << 0, 0, -1, -1, 0, 0, 0, 1, 0;
    const Geometry geometry = support::grid({7, 6, 5}, {1, 2, 3}, {10, 20, 30}, direction);
    const auto value = [](const Index3& i) { return i[0] + 10 * i[1] + 40 * i[2]; };
    return with_type(type, [&](auto zero) {
        return linear_field(support::volume_of<decltype(zero)>(geometry, value));
    });
}

TEST(SliceSamples, are_those_of_the_volume_whatever_its_type_axis_and_direction) {
    for (const SampleType type :
         {SampleType::uint8, SampleType::int16, SampleType::uint16, SampleType::float32}) {
        const Field field = ramp(type);
        for (int axis = 0; axis < 3; ++axis) {
            const SlicePlane plane = slice_plane(field.geometry(), axis);
            SliceSamples samples(field, plane);
            for (const double position : {1.25, 2.0, 0.0, 3.5, 3.75, 2.75}) {
                samples.go_to(position);
                std::vector<float> row(static_cast<std::size_t>(samples.width()));
                for (int v = 0; v < samples.height(); ++v) {
                    samples.interpolate(v, row.data());
                    for (int u = 0; u < samples.width(); ++u) {
                        const Vec3 i =
                            index_from_slice(plane, field.geometry(), Vec3(u, v, position));
                        EXPECT_NEAR(row[std::size_t(u)], i[0] + 10 * i[1] + 40 * i[2], 1e-4);
                    }
                }
            }
        }
    }
}

TEST(SliceSamples, have_a_ring_of_background_and_are_background_outside) {
    const Field field = linear_field(ramp(SampleType::int16).volume(), Solid::above, -77);
    const SlicePlane plane = slice_plane(field.geometry(), 1);
    SliceSamples samples(field, plane);
    samples.go_to(2.5);
    for (int v = -1; v <= samples.height(); ++v) {
        for (const int layer : {0, 1}) {
            EXPECT_EQ(samples.row(layer, v)[-1], -77);
            EXPECT_EQ(samples.row(layer, v)[samples.width()], -77);
        }
    }
    for (const double outside : {-1.0, 6.0, 1e300, -1e300}) {
        samples.go_to(outside);
        EXPECT_FALSE(samples.in_data());
        for (int u = 0; u < samples.width(); ++u) EXPECT_EQ(samples.row(0, 2)[u], -77);
    }
    samples.go_to(std::nan(""));
    EXPECT_TRUE(std::isfinite(samples.position()));
}

TEST(SliceSamples, beyond_the_last_layer_its_voxels_go_on) {
    const Field field = ramp(SampleType::float32);
    SliceSamples samples(field, slice_plane(field.geometry(), 2));
    std::vector<float> inside(static_cast<std::size_t>(samples.width())), border = inside;
    for (const auto& [position, layer] : {std::pair{4.4, 4.0}, {-0.4, 0.0}}) {
        samples.go_to(layer);
        samples.interpolate(1, inside.data());
        samples.go_to(position);
        EXPECT_TRUE(samples.in_data());
        samples.interpolate(1, border.data());
        EXPECT_EQ(inside, border);
    }
}

}  // namespace
}  // namespace palpate::viewer
