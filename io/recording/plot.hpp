// Draws figures with gnuplot, run as a program.
#pragma once

#include <filesystem>
#include <string>

namespace palpate::io {

struct PlotSize {
    int width = 1000, height = 750;  ///< [pixels]
};

/// False if gnuplot is not installed.
bool can_plot();

/// Runs a gnuplot script and writes its figure to `figure`: an SVG for that extension, else a PNG.
/// Terminal and output are set before the script. Returns gnuplot's error (one line, and nothing is
/// left behind), or empty.
std::string plot(const std::string& script, const std::filesystem::path& figure,
                 const PlotSize& size = {});

}  // namespace palpate::io
