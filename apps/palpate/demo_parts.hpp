// What the demos share: the hand's way in a file and the figure over time.
#pragma once

#include <filesystem>

#include "io/trajectory.hpp"

namespace palpate::app {

/// The hand's way as a file that replay takes. Throws io::OutputError.
void write_trajectory(const io::Trajectory& trajectory, const std::filesystem::path& path);

/// Depth, force and density over time, from `folder`/trace.csv with so many rows, as a picture
/// (.png or .svg). False without gnuplot.
bool plot_trace(const std::filesystem::path& folder, const std::filesystem::path& figure,
                std::size_t rows);

}  // namespace palpate::app
