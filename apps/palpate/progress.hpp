// A progress bar on standard error, where that is a terminal and the work takes a while.
#pragma once

#include <chrono>
#include <optional>
#include <string>

#include "apps/options/source_options.hpp"
#include "palpate/filters/dequantize.hpp"

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

/// Reads or makes the volume, with a progress bar; prints notes about it on standard error unless
/// quiet. Throws as run::load(), and Interrupted.
run::LoadedVolume load_for_terminal(const run::Source& source, bool quiet);
run::LoadedVolume load_for_terminal(const SourceOptions& options);
/// The same with the samples of the level of a store that the options choose. Without a level, an
/// overview and a note. Throws io::InputError for a level larger than the memory.
run::LoadedVolume load_whole(const SourceOptions& options);

/// "--dequantize: why"; empty where it is not worth it.
std::string dequantize_suggestion(const std::optional<filters::Terraces>& terraces);
/// Says on standard error, in a line, that wide terraces will be felt and which option removes
/// them. Silent for volumes that were dequantized or smoothed, for stores and for live sources.
void note_terraces(const run::LoadedVolume& loaded);

}  // namespace palpate::app
