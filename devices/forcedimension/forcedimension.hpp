// Force Dimension's omega, delta, sigma and lambda and the Novint Falcon through the vendor's SDK.
// See docs/devices/forcedimension.md.
#pragma once

#include <memory>
#include <string>

#include "devices/forcedimension/dhd_device.hpp"
#include "palpate/devices/backend.hpp"

namespace palpate::devices::forcedimension {

/// Looks for the library ("": where it usually is) and counts the devices; opens none. Never throws
/// for what it finds.
DeviceFinding find(const std::string& library);

/// Opens a device, whose thread is not started. Throws std::invalid_argument for wrong options,
/// DeviceError where library or device cannot be had.
std::unique_ptr<DhdDevice> open(const DeviceChoice& choice, const DeviceScene& scene,
                                const Timing& timing = {});

}  // namespace palpate::devices::forcedimension
