// Figures by gnuplot, run as a program.
#pragma once

#include <filesystem>
#include <string>

namespace palpate::app {

/// Runs a gnuplot script and puts its figure at `figure`. The script finds the terminal and output
/// set. False, and nothing left behind, if gnuplot is missing or refuses: figures are welcome, not
/// needed.
bool plot(const std::string& script, const std::filesystem::path& figure);

}  // namespace palpate::app
