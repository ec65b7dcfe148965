// A progress bar on standard error, where that is a terminal and the work is long enough to wait
// for.
#pragma once

#include <chrono>
#include <string>

#include "apps/live/volume_options.hpp"

namespace palpate::app {

class ProgressBar {
  public:
    /// Silent if `quiet`, or if standard error is not a terminal.
    ProgressBar(std::string label, bool quiet);
    /// Clears the line.
    ~ProgressBar();
    ProgressBar(const ProgressBar&) = delete;
    ProgressBar& operator=(const ProgressBar&) = delete;

    /// Part done, 0 to 1. Throws Interrupted after Ctrl-C, so long work stops here.
    void at(double fraction);

  private:
    std::string label_;
    std::chrono::steady_clock::time_point begin_;
    std::chrono::steady_clock::time_point last_;
    bool show_;
    bool drawn_ = false;
};

/// Reads or makes the volume, with a progress bar; prints what there is to note on standard error
/// unless quiet. Throws as load(), and Interrupted.
LoadedVolume load_for_terminal(const VolumeOptions& options);

}  // namespace palpate::app
