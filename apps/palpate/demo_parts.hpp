// Parts of the demos: options of the hand, its trajectory in a file, a figure over time.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>
#include <vector>

#include "palpate/io/trajectory.hpp"
#include "palpate/scenes/motions.hpp"

namespace palpate::app {

/// --motion and --duration.
void add_motion_options(CLI::App& command, std::string& motion, scenes::MotionSettings& hand);

io::Trajectory trajectory_of(const std::vector<scenes::HandSample>& samples);

/// The trajectory of the hand as a file that replay reads. Throws io::OutputError.
void write_trajectory(const io::Trajectory& trajectory, const std::filesystem::path& path);

/// Depth, force and density over time, from `folder`/trace.csv with so many rows, as a picture
/// (.png or .svg). False without gnuplot.
bool plot_trace(const std::filesystem::path& folder, const std::filesystem::path& figure,
                std::size_t rows);

}  // namespace palpate::app
