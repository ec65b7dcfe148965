// The options of the viewer: those of a live run, and what to open in place of a volume.
#pragma once

#include <CLI/CLI.hpp>
#include <array>
#include <optional>
#include <string>

#include "apps/options/run_options.hpp"

namespace palpate::app {

struct ViewOptions {
    RunOptions run;
    std::string session;     ///< session file to open in place of a volume
    std::string play;        ///< recording to play in place of feeling
    std::string screenshot;  ///< PNG to write once everything is drawn; then the viewer ends
    double after = 0;        ///< [s] of the run or recording that the screenshot shows
    std::string size;        ///< of the window, WIDTHxHEIGHT [pixels]

    /// For `palpate view` and for the viewer itself.
    void add_to(CLI::App& command);
    /// Once the command line has been read. A VOLUME that is a session or a recording takes the
    /// place of that option. Throws std::invalid_argument for options that exclude each other.
    void settle();
    /// Warns on standard error of options that do nothing. After settle(), and only in the viewer:
    /// `palpate view` becomes it, and each warning shall appear once.
    void warn() const;
    /// The same of those that do nothing because the session file has settings.
    void warn_beside_settings() const;
    /// Width and height of the window [pixels]; nothing: not given. Throws std::invalid_argument
    /// for a size that is none.
    std::optional<std::array<int, 2>> window_size() const;
    bool has_volume() const { return !run.source.name().empty(); }

  private:
    const CLI::App* command_ = nullptr;
};

}  // namespace palpate::app
