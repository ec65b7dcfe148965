// The Novint Falcon without its vendor's SDK, through libftdi. See docs/devices/falcon.md.
#pragma once

#include <memory>
#include <string>

#include "devices/falcon/falcon_device.hpp"
#include "palpate/devices/backend.hpp"

namespace palpate::devices {

/// Looks for the library and counts the devices; opens none. Never throws for what it finds.
DeviceFinding find_falcon();

/// Opens a device and starts a thread of its own for it. Throws std::invalid_argument for wrong
/// options, DeviceError where library, firmware or device cannot be had.
std::unique_ptr<Device> open_falcon(const DeviceChoice& choice, const DeviceScene& scene);

namespace falcon {
/// As find_falcon(), in this library ("": where it usually is).
DeviceFinding find(const std::string& library);
/// As open_falcon(), without the thread.
std::unique_ptr<FalconDevice> open(const DeviceChoice& choice, const DeviceScene& scene,
                                   const Timing& timing = {});
}  // namespace falcon

}  // namespace palpate::devices
