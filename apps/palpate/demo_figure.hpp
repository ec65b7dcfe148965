// The figure of a demo over time, drawn by gnuplot.
#pragma once

#include <filesystem>
#include <vector>

#include "palpate/io/trace.hpp"

namespace palpate::app {

/// Depth, force and density as session.png and session.svg in the folder; false where gnuplot is
/// missing or fails.
bool plot_over_time(const std::vector<io::TraceRow>& rows, const std::filesystem::path& folder);

}  // namespace palpate::app
