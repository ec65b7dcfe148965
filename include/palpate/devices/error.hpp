// What goes wrong before a device is there.
#pragma once

#include <stdexcept>

namespace palpate::devices {

/// No device: which file, service or device was looked for, and what to install or do. One line.
class DeviceError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

}  // namespace palpate::devices
