// 3D Systems' Touch and SensAble's PHANToM devices through the HD library of OpenHaptics. See
// docs/devices/openhaptics.md.
#pragma once

#include <memory>
#include <string>

#include "devices/openhaptics/phantom.hpp"
#include "palpate/devices/backend.hpp"

namespace palpate::devices::openhaptics {

/// Looks for the library ("": where it usually is), not for a device: asking the driver for one
/// could disturb a session that another program has with it. Never throws for what it finds.
DeviceFinding find(const std::string& library);

/// Opens the device and starts the driver's servo loop. Throws std::invalid_argument for wrong
/// options, DeviceError where library or device cannot be had.
std::unique_ptr<Phantom> open(const DeviceChoice& choice, const DeviceScene& scene,
                              const Timing& timing = {});

}  // namespace palpate::devices::openhaptics
