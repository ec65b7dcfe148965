// All devices, by name.
#pragma once

#include <vector>

#include "palpate/devices/backend.hpp"

namespace palpate::devices {

/// Looks for every kind of device; takes at most a second or so. Moves nothing.
std::vector<DeviceFinding> find_devices();

/// The names of all kinds, found or not.
std::vector<std::string> device_names();

/// Opens a device. Throws std::invalid_argument for an unknown name or option (listing the known
/// ones), DeviceError if the device is not available.
std::unique_ptr<Device> open_device(const DeviceChoice& choice, const DeviceScene& scene);

}  // namespace palpate::devices
