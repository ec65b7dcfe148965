// What the demos share: renderer, the hand's options, its way in a file and the figure over time.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>
#include <vector>

#include "apps/live/render_options.hpp"
#include "palpate/io/trajectory.hpp"
#include "palpate/scenes/motions.hpp"

namespace palpate::app {

/// --motion and --duration.
void add_motion_options(CLI::App& command, std::string& motion, scenes::MotionSettings& hand);

/// Renders a motion of any rate, with the force limit that was asked for.
Renderer demo_renderer(const RenderOptions& options, const Field& field, double isovalue);

io::Trajectory trajectory_of(const std::vector<scenes::HandSample>& samples);

/// The hand's way as a file that replay takes. Throws io::OutputError.
void write_trajectory(const io::Trajectory& trajectory, const std::filesystem::path& path);

/// Depth, force and density over time, from `folder`/trace.csv with so many rows, as a picture
/// (.png or .svg). False without gnuplot.
bool plot_trace(const std::filesystem::path& folder, const std::filesystem::path& figure,
                std::size_t rows);

}  // namespace palpate::app
