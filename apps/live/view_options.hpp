// The options of the viewer: those of a live session, and what to open in place of a volume.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "apps/live/touch_options.hpp"

namespace palpate::app {

struct ViewOptions {
    TouchOptions touch;
    std::string session;     ///< file to open in place of a volume
    std::string play;        ///< recording to play in place of feeling
    std::string screenshot;  ///< PNG to write once all is drawn; then the viewer ends
    double after = 0;        ///< [s] of the session or recording that the screenshot shows
    std::string size;        ///< of the window, WIDTHxHEIGHT [pixels]

    /// For `palpate view` and for the viewer itself.
    void add_to(CLI::App& command);
    /// To be called when the command line has been read. Throws std::invalid_argument for options
    /// that exclude each other.
    void finish(const CLI::App& command);
};

}  // namespace palpate::app
