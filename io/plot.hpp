// Figures by gnuplot, run as a program.
#pragma once

#include <filesystem>
#include <string>

namespace palpate::io {

struct PlotSize {
    int width = 1000, height = 750;  ///< [pixels]
};

/// False if gnuplot is not installed.
bool can_plot();

/// Runs a gnuplot script and puts its figure at `figure`: an SVG by that extension, else a PNG. The
/// script finds the terminal and output set. Empty if it worked, else what gnuplot said (one line),
/// and then nothing is left behind.
std::string plot(const std::string& script, const std::filesystem::path& figure,
                 const PlotSize& size = {});

}  // namespace palpate::io
