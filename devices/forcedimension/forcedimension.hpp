// Force Dimension's omega, delta, sigma and lambda and the Novint Falcon through the vendor's SDK.
// See docs/devices/forcedimension.md.
#pragma once

#include <memory>
#include <string>

#include "devices/forcedimension/dhd_device.hpp"
#include "palpate/devices/backend.hpp"

namespace palpate::devices {

/// Looks for the library and counts the devices; opens none. Never throws for what it finds.
DeviceFinding find_forcedimension();

/// Opens a device and starts a thread of its own for it. Throws std::invalid_argument for wrong
/// options, DeviceError where library or device cannot be had.
std::unique_ptr<Device> open_forcedimension(const DeviceChoice& choice, const DeviceScene& scene);

namespace forcedimension {
/// As find_forcedimension(), in this library ("": where it usually is).
DeviceFinding find(const std::string& library);
/// As open_forcedimension(), without the thread.
std::unique_ptr<DhdDevice> open(const DeviceChoice& choice, const DeviceScene& scene,
                                const Timing& timing = {});
}  // namespace forcedimension

}  // namespace palpate::devices
