// 3D Systems' Touch and SensAble's PHANToM devices through the HD library of OpenHaptics. See
// docs/devices/openhaptics.md.
#pragma once

#include <memory>
#include <string>

#include "devices/link.hpp"
#include "palpate/devices/backend.hpp"

namespace palpate::devices {

/// Looks for the library, not for a device: asking the driver for one could disturb a session that
/// another program has with it. Never throws for what it finds.
DeviceFinding find_openhaptics();

/// Opens the device and starts the driver's servo loop. Throws std::invalid_argument for wrong
/// options, DeviceError where library or device cannot be had.
std::unique_ptr<Device> open_openhaptics(const DeviceChoice& choice, const DeviceScene& scene);

namespace openhaptics {
/// As find_openhaptics(), in this library ("": where it usually is).
DeviceFinding find(const std::string& library);
/// As open_openhaptics(), with a time of the caller's.
std::unique_ptr<Device> open(const DeviceChoice& choice, const DeviceScene& scene,
                             const Timing& timing);
}  // namespace openhaptics

}  // namespace palpate::devices
