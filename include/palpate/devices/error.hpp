// The error of opening a device.
#pragma once

#include <stdexcept>

namespace palpate::devices {

/// The device is not available. The message names the missing part and the remedy. One line.
class DeviceError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

}  // namespace palpate::devices
