// Device: names of its status, and the transform from its workspace into the volume.
#include "palpate/device.hpp"

#include <Eigen/Geometry>
#include <algorithm>

#include "palpate/names.hpp"

namespace palpate {
namespace {

/// Columns: what lies along the device's right, up and towards the person, in physical axes.
Mat3 axes_facing(Facing facing) {
    const Vec3 left(1, 0, 0), back(0, 1, 0), up(0, 0, 1);
    Mat3 axes;
    const auto set = [&](const Vec3& right_hand, const Vec3& top) {
        axes.col(0) = right_hand;
        axes.col(1) = top;
        axes.col(2) = right_hand.cross(top);
    };
    switch (facing) {
        case Facing::anterior:
            set(left, up);
            break;
        case Facing::posterior:
            set(-left, up);
            break;
        case Facing::left:
            set(back, up);
            break;
        case Facing::right:
            set(-back, up);
            break;
        case Facing::superior:
            set(-left, -back);
            break;
        case Facing::inferior:
            set(left, -back);
            break;
    }
    return axes;
}

}  // namespace

const char* name_of(DeviceStatus status) {
    return enum_name(status);
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
