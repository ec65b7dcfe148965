// A device whose reading and writing are callbacks of the C interface's caller.
#pragma once

#include <memory>
#include <string>

#include "palpate-c/palpate.h"
#include "palpate/device.hpp"

namespace palpate::c {

/// Throws std::invalid_argument for numbers that no device has, DeviceError for a device that
/// serves another run, std::system_error without a thread.
std::unique_ptr<Device> make_own_device(const palpate_own_device& asked);

/// "own" where the caller gave no name.
std::string name_of(const palpate_own_device& asked);

}  // namespace palpate::c
