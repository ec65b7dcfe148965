// What every backend is made of: one function that looks for it, one that opens it. A backend
// NAME is the folder devices/NAME with the header NAME.hpp, which declares
//   DeviceFinding find_NAME();
//   std::unique_ptr<Device> open_NAME(const DeviceChoice& choice, const DeviceScene& scene);
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "palpate/device.hpp"
#include "palpate/devices/error.hpp"
#include "palpate/devices/options.hpp"
#include "palpate/field.hpp"

namespace palpate::devices {

/// What a device may want to know of the session it is opened for.
struct DeviceScene {
    const Field& field;
    double isovalue;  ///< [data units]
    double rate;      ///< [Hz] of the servo loop
    /// Where a device with this workspace will lie in the volume: hands that move by a script or a
    /// recording do so in physical space.
    std::function<DeviceTransform(const DeviceInfo&)> transform;
};

/// What was found of one kind of device, and why it was not.
struct DeviceFinding {
    std::string name;     ///< for --device
    bool found = false;   ///< it could be opened now
    std::string what;     ///< what was found: model, version, address
    std::string missing;  ///< which file, service or device was looked for, and what to install
    std::string options;  ///< KEY=VALUE options with their defaults, one line
};

}  // namespace palpate::devices
