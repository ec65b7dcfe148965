// The interface of a backend: one function that looks for it, one that opens it. A backend NAME
// is the folder devices/NAME with the header NAME.hpp, which declares them. The table in
// devices/devices.cpp makes of them
//   DeviceFinding find();
//   std::unique_ptr<Device> open(const DeviceChoice& choice, const DeviceScene& scene);
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "palpate/device.hpp"
#include "palpate/devices/error.hpp"
#include "palpate/devices/options.hpp"
#include "palpate/field.hpp"
#include "palpate/progress.hpp"

namespace palpate::devices {

/// Facts about the run for which a device is opened.
struct DeviceScene {
    const Field& field;
    double isovalue;  ///< [data units]
    double rate;      ///< [Hz] of the servo loop
    /// Gives the place of a device with this workspace in the volume. Scripted and recorded hands
    /// move in physical space.
    std::function<DeviceTransform(const DeviceInfo&)> transform;
    /// Called while a service or a vendor's library is waited for. Its exceptions are passed on at
    /// once. The call of the library is then left alone, and a device that it opens later is closed
    /// again.
    OnProgress progress = {};
};

/// Whether one kind of device was found, and if not, why.
struct DeviceFinding {
    std::string name;     ///< for --device
    bool found = false;   ///< it could be opened now
    std::string what;     ///< the device that was found: model, version, address
    std::string missing;  ///< which file, service or device was looked for, and what to install
    std::string options;  ///< KEY=VALUE options with their defaults, one line
};

}  // namespace palpate::devices
