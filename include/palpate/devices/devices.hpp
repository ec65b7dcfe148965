// Every device there is, by name.
#pragma once

#include <vector>

#include "palpate/devices/backend.hpp"

namespace palpate::devices {

/// Looks for every kind of device; takes at most a second or so. Moves nothing.
std::vector<DeviceFinding> find_devices();

/// Opens a device. Throws std::invalid_argument for a name or option that there is not (listing
/// those there are), DeviceError where the device cannot be had.
std::unique_ptr<Device> open_device(const DeviceChoice& choice, const DeviceScene& scene);

}  // namespace palpate::devices
