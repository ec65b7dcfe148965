// Options of the viewer.
#include "apps/options/view_options.hpp"

#include <stdexcept>

namespace palpate::app {

void ViewOptions::add_to(CLI::App& command) {
    run.given.device = {"mouse", {}};
    run.add_to(command, RunOptions::For::view);
    command.add_option("--session", session, "Session file to open: volume, view and settings");
    command.add_option("--play", play, "Recording to play, with a time line, in place of feeling");
    command.add_option("--window", size, "Size of the window [pixels]: WIDTHxHEIGHT")
        ->type_name("WxH");
    command.add_option("--screenshot", screenshot,
                       "Write a picture of the window (PNG) once all is drawn, and end");
    command
        .add_option("--after", after, "Second of the session or recording for the screenshot (0)")
        ->check(CLI::NonNegativeNumber);
}

void ViewOptions::check() const {
    if (has_volume() && !session.empty()) {
        throw std::invalid_argument("VOLUME and --session: give only one of them");
    }
    if (!screenshot.empty() && !has_volume() && session.empty() && play.empty()) {
        throw std::invalid_argument("--screenshot needs a VOLUME, --session or --play");
    }
    if (!play.empty() && !session.empty()) {
        throw std::invalid_argument("--play and --session: give only one of them");
    }
}

}  // namespace palpate::app
