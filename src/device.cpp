// Device: names of its status, and the transform from its workspace into the volume.
#include "palpate/device.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "palpate/names.hpp"

namespace palpate {
namespace {

/// Columns: what lies along the device's right, up and towards the person, in physical axes.
Mat3 axes_facing(Facing facing) {
    const Vec3 left(1, 0, 0), back(0, 1, 0), up(0, 0, 1);
    // Right and up, in the order of Facing.
    const std::array<std::array<Vec3, 2>, 6> sides{
        {{left, up}, {-left, up}, {back, up}, {-back, up}, {-left, -back}, {left, -back}}};
    const auto& [right_hand, top] = sides[static_cast<std::size_t>(facing)];
    Mat3 axes;
    axes << right_hand, top, right_hand.cross(top);
    return axes;
}

}  // namespace

const char* name_of(DeviceStatus status) {
    return enum_name(status);
}

void check(const DeviceInfo& info) {
    if (!(info.workspace_high.array() > info.workspace_low.array()).all()) {
        throw std::invalid_argument("workspace_high has to be above workspace_low");
    }
    if (!(info.stiffness >= 0) || std::isinf(info.stiffness)) {
        throw std::invalid_argument("stiffness [N/mm]: has to be finite and at least 0");
    }
    if (info.buttons < 0 || info.buttons > 32) throw std::invalid_argument("buttons: 0 to 32");
}

DeviceTransform fit_workspace(const Geometry& geometry, const DeviceInfo& device, Facing facing) {
    DeviceTransform transform;
    transform.rotation = axes_facing(facing);
    // Half the extents of the grid along the device's axes.
    Vec3 half = Vec3::Zero();
    for (int a = 0; a < 3; ++a) {
        const double length = 0.5 * geometry.spacing[a] * std::max(1, geometry.size[a] - 1);
        half += length * (transform.rotation.transpose() * geometry.direction.col(a)).cwiseAbs();
    }
    const Vec3 workspace = 0.5 * (device.workspace_high - device.workspace_low);
    transform.scale = (half.array() / workspace.array()).maxCoeff();
    const Vec3 middle = 0.5 * (device.workspace_high + device.workspace_low);
    transform.translation =
        physical_centre(geometry) - transform.scale * (transform.rotation * middle);
    return transform;
}

}  // namespace palpate
