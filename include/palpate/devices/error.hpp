// The error of opening a device.
#pragma once

#include <stdexcept>

namespace palpate::devices {

/// The device is not available: what was looked for, and what to install or do. One line.
class DeviceError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

}  // namespace palpate::devices
