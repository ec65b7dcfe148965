// Reads trajectories (hand positions over time) from CSV files, for `palpate replay` and devices.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "palpate/io/error.hpp"
#include "palpate/volume.hpp"

namespace palpate::io {

/// HIP positions over time; both vectors have the same length, at least 1.
struct Trajectory {
    std::vector<double> time;    ///< [s], strictly increasing
    std::vector<Vec3> position;  ///< [mm, physical], finite
};

/// A CSV text whose header names t and x, y, z; or t and hip_x, hip_y, hip_z, so that a trace can
/// be replayed. Further columns are ignored. Throws InputError, which calls the text `name`, for
/// anything else: a missing column, no rows, a cell that is not a finite number, time that does not
/// increase.
Trajectory parse_trajectory(std::string_view text, const std::string& name);

/// The same from a file.
Trajectory read_trajectory(const std::filesystem::path& path);

}  // namespace palpate::io
