// Reads trajectories (hand positions over time) from CSV files, for `palpate replay` and devices.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "palpate/io/error.hpp"
#include "palpate/tool.hpp"

namespace palpate::io {

/// Poses of the hand over time. All vectors have the same length, at least 1, but `orientation` may
/// be empty.
struct Trajectory {
    std::vector<double> time;             ///< [s], strictly increasing
    std::vector<Vec3> position;           ///< [mm, physical], finite
    std::vector<Quaternion> orientation;  ///< unit, tool axes to physical axes
};

/// A CSV text whose header names t and x, y, z; or t and hip_x, hip_y, hip_z, so that a trace can
/// be replayed. Columns qw, qx, qy, qz, all or none, are the orientation. A quaternion that is unit
/// to a thousandth is normalised. Further columns are ignored. Throws InputError, which calls the
/// text `name`, for anything else: a missing column, no rows, a cell that is not a finite number,
/// an orientation that is not unit, time that does not increase.
Trajectory parse_trajectory(std::string_view text, const std::string& name);

/// From numbers in memory. Orientations may be missing. A quaternion that is unit to a thousandth
/// is normalised. Throws std::invalid_argument, naming the row from 0, for vectors of different
/// lengths, no rows, and values that parse_trajectory() refuses.
Trajectory checked_trajectory(std::vector<double> time, std::vector<Vec3> position,
                              std::vector<Quaternion> orientation = {});

/// The same as parse_trajectory() from a file.
Trajectory read_trajectory(const std::filesystem::path& path);

}  // namespace palpate::io
