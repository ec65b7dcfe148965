// What there is to play: rows of a CSV file, as far as they concern a device.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "palpate/device.hpp"

namespace palpate::devices {

/// What a device told beside its position.
struct Told {
    DeviceStatus status = DeviceStatus::ready;
    std::uint32_t buttons = 0;
    double age = 0;  ///< [s]
};

/// All vectors are as long as `time` or, where the file has nothing of the kind, empty.
struct Recording {
    std::vector<double> time;       ///< [s], strictly increasing, at least one
    std::vector<Vec3> position;     ///< [device mm]; never empty
    std::vector<Told> told;         ///< of a recording
    std::vector<Mat3> orientation;  ///< tool axes to device axes; empty, too, if never turned
};

/// Positions of a trajectory or a trace are mapped from physical space by `transform`. Those of a
/// recording, and its tools, go the same way through the volume as when they were recorded: the
/// transform in its head leads there and `transform` back; where both are the same, and where there
/// is no head, they stay as they are, bit for bit. Throws io::InputError.
Recording read_recording(const std::string& file, const DeviceTransform& transform);

}  // namespace palpate::devices
