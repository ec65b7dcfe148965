// All devices, by name.
#pragma once

#include <vector>

#include "palpate/devices/backend.hpp"
#include "palpate/progress.hpp"

namespace palpate::devices {

/// Looks for every kind of device. Moves nothing. Takes a second or so, or as long as a vendor's
/// library or the lookup of a name. These cannot be stopped: when `progress` throws, they are left
/// alone on a thread of their own, and the exception is passed on at once.
std::vector<DeviceFinding> find_devices(const OnProgress& progress = {});

/// The names of all kinds, found or not.
std::vector<std::string> device_names();

/// Opens a device. Throws std::invalid_argument for an unknown name or option (listing the known
/// ones), DeviceError if the device is not available.
std::unique_ptr<Device> open_device(const DeviceChoice& choice, const DeviceScene& scene);

}  // namespace palpate::devices
