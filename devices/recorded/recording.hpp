// The rows of a CSV file that the device `recorded` plays.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "palpate/device.hpp"
#include "palpate/progress.hpp"

namespace palpate::devices {

/// What a device reported besides its position.
struct Told {
    DeviceStatus status = DeviceStatus::ready;
    std::uint32_t buttons = 0;
    double age = 0;                      ///< [s]
    std::optional<double> opening = {};  ///< [rad] of a gripper
};

/// All vectors are as long as `time`, or empty where the file has no such columns.
struct Recording {
    std::vector<double> time;       ///< [s], strictly increasing, at least one
    std::vector<Vec3> position;     ///< [device mm]; never empty
    std::vector<Told> told;         ///< of a recording
    std::vector<Mat3> orientation;  ///< tool axes to device axes; empty, too, if never turned
};

/// Positions of a trajectory or a trace are mapped from physical space by `transform`. Those of a
/// recording, and its tool's axes, move through the volume as they were recorded: the transform in
/// its head leads to physical space and `transform` back. If both are equal, or there is no head,
/// they are unchanged bit for bit. `hand`: of a recording of several, from 1. `progress`: as for
/// io::read_text(). Throws io::InputError.
Recording read_recording(const std::string& file, const DeviceTransform& transform, int hand,
                         const OnProgress& progress);

}  // namespace palpate::devices
