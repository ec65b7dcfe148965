// A 3D mouse (SpaceNavigator, SpaceMouse and their like) through the daemon spacenavd: position
// only, no force. See docs/devices/spacenav.md.
#pragma once

#include <memory>

#include "devices/spacenav/mouse.hpp"
#include "palpate/devices/backend.hpp"

namespace palpate::devices::spacenav {

/// Tries to connect to the daemon. Never throws for what it finds.
DeviceFinding find();

/// Connects, and connects again when the connection is lost later. The thread is not started.
/// Throws std::invalid_argument for wrong options, DeviceError if no daemon listens.
std::unique_ptr<Mouse> open(const DeviceChoice& choice, const DeviceScene& scene,
                            const Timing& timing = {});

}  // namespace palpate::devices::spacenav
