// A 3D mouse (SpaceNavigator, SpaceMouse and their like) through the daemon spacenavd: position
// only, no force. See docs/devices/spacenav.md.
#pragma once

#include "palpate/devices/backend.hpp"

namespace palpate::devices {

/// Knocks at the daemon's socket. Never throws for what it finds.
DeviceFinding find_spacenav();

/// Connects; losses later on are answered by connecting again. Throws std::invalid_argument for
/// wrong options, DeviceError where no daemon listens.
std::unique_ptr<Device> open_spacenav(const DeviceChoice& choice, const DeviceScene& scene);

}  // namespace palpate::devices
