// The device `simulated`: no hardware, a haptic device and the hand that holds it as one dynamic
// system. See docs/devices/simulated.md.
#pragma once

#include <memory>

#include "palpate/devices/backend.hpp"

namespace palpate::devices {

/// Always found.
DeviceFinding find_simulated();

/// Computes in Device::read(), so the same reads and writes at the same times give the same bits.
/// Throws std::invalid_argument for unknown options, io::InputError for a trajectory file that
/// cannot be read.
std::unique_ptr<Device> open_simulated(const DeviceChoice& choice, const DeviceScene& scene);

}  // namespace palpate::devices
