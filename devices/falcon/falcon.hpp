// The Novint Falcon without its vendor's SDK, through libftdi. See docs/devices/falcon.md.
#pragma once

#include <memory>
#include <string>

#include "devices/falcon/falcon_device.hpp"
#include "palpate/devices/backend.hpp"

namespace palpate::devices::falcon {

/// Looks for the library ("": where it usually is) and counts the devices; opens none. Never throws
/// for what it finds.
DeviceFinding find(const std::string& library);

/// Opens a device, whose thread is not started. Throws std::invalid_argument for wrong options,
/// DeviceError where library, firmware or device cannot be had.
std::unique_ptr<FalconDevice> open(const DeviceChoice& choice, const DeviceScene& scene,
                                   const Timing& timing = {});

}  // namespace palpate::devices::falcon
