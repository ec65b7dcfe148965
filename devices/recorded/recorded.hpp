// The device `recorded`: a hand that moves along a file and ignores forces. See
// docs/devices/recorded.md.
#pragma once

#include <memory>

#include "palpate/devices/backend.hpp"

namespace palpate::devices {

/// Always found.
DeviceFinding find_recorded();

/// Reads the file. Throws std::invalid_argument for unknown options, io::InputError for a file
/// that cannot be read.
std::unique_ptr<Device> open_recorded(const DeviceChoice& choice, const DeviceScene& scene);

}  // namespace palpate::devices
