// Device: the transform from its workspace into the volume.
#include "palpate/device.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <set>
#include <string>

#include "support/fields.hpp"

using namespace palpate;
using namespace palpate::support;

namespace {

constexpr Facing facings[] = {Facing::anterior, Facing::posterior, Facing::left,
                              Facing::right,    Facing::superior,  Facing::inferior};

TEST(FitWorkspace, the_named_side_faces_the_person_and_axes_stay_right_handed) {
    const Vec3 towards[] = {{0, -1, 0}, {0, 1, 0}, {1, 0, 0}, {-1, 0, 0}, {0, 0, 1}, {0, 0, -1}};
    for (std::size_t i = 0; i < 6; ++i) {
        const Mat3 r = fit_workspace(grid(cube(9)), {}, facings[i]).rotation;
        EXPECT_EQ(r * Vec3::UnitZ(), towards[i]);
        EXPECT_DOUBLE_EQ(r.determinant(), 1);
    }
}

TEST(FitWorkspace,
     standing_patients_have_their_head_up_and_an_anterior_view_their_left_on_the_right) {
    for (std::size_t i = 0; i < 4; ++i) {
        EXPECT_EQ(fit_workspace(grid(cube(9)), {}, facings[i]).rotation * Vec3::UnitY(),
                  Vec3::UnitZ());
    }
    EXPECT_EQ(fit_workspace(grid(cube(9)), {}).rotation * Vec3::UnitX(), Vec3::UnitX());
}

TEST(FitWorkspace, the_whole_grid_fits_and_touches_the_workspace_centre_on_centre) {
    const Geometry geometry =
        grid(Index3(40, 70, 20), Vec3(0.5, 0.8, 2.5), Vec3(-100, 30, 7), oblique_direction());
    DeviceInfo device;
    device.workspace_low = Vec3(-60, -20, 0);
    device.workspace_high = Vec3(60, 100, 70);
    for (const Facing facing : facings) {
        const DeviceTransform t = fit_workspace(geometry, device, facing);
        const Vec3 middle = 0.5 * (device.workspace_low + device.workspace_high);
        EXPECT_LT((physical_from_device(t, middle) - physical_centre(geometry)).norm(), 1e-9);
        double farthest = -1e9;  // of the corners beyond the box
        for (int c = 0; c < 8; ++c) {
            const Vec3 index((c & 1) * (geometry.size[0] - 1),
                             (c >> 1 & 1) * (geometry.size[1] - 1),
                             (c >> 2 & 1) * (geometry.size[2] - 1));
            const Vec3 p = device_from_physical(t, physical_from_index(geometry, index));
            farthest = std::max({farthest, (p - device.workspace_high).maxCoeff(),
                                 (device.workspace_low - p).maxCoeff()});
        }
        EXPECT_NEAR(farthest, 0, 1e-9);
    }
}

TEST(DeviceStatus, every_one_has_its_own_name) {
    std::set<std::string> names;
    for (int s = 0; s <= static_cast<int>(DeviceStatus::finished); ++s) {
        names.insert(name_of(static_cast<DeviceStatus>(s)));
    }
    EXPECT_EQ(names.size(), 7U);
    EXPECT_FALSE(names.contains("unknown"));
}

}  // namespace
