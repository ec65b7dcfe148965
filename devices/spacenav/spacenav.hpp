// A 3D mouse (SpaceNavigator, SpaceMouse and their like) through the daemon spacenavd: position
// only, no force. See docs/devices/spacenav.md.
#pragma once

#include <memory>

#include "devices/spacenav/mouse.hpp"
#include "palpate/devices/backend.hpp"

namespace palpate::devices {

/// Tries to connect to the daemon. Never throws for what it finds.
DeviceFinding find_spacenav();

/// Connects, and connects again when the connection is lost later. Throws std::invalid_argument for
/// wrong options, DeviceError if no daemon listens.
std::unique_ptr<Device> open_spacenav(const DeviceChoice& choice, const DeviceScene& scene);

namespace spacenav {
/// As open_spacenav(), without the thread.
std::unique_ptr<Mouse> open(const DeviceChoice& choice, const DeviceScene& scene,
                            const Timing& timing = {});
}  // namespace spacenav

}  // namespace palpate::devices
