// Options of the viewer.
#include "apps/options/view_options.hpp"
#include "apps/options/no_effect.hpp"
#include "apps/options/values.hpp"

#include <algorithm>
#include <cstdio>
#include <iterator>
#include <stdexcept>
#include <utility>

namespace palpate::app {
namespace {

/// They act on a session without settings only.
const std::vector<std::string> without_settings{"--tool",      "--tool-spacing", "--penetrability",
                                                "--threshold", "--minimum",      "--range",
                                                "--facing"};

}  // namespace

void ViewOptions::add_to(CLI::App& command) {
    command_ = &command;
    run.given.device = {"mouse", {}};
    run.add_to(command, RunOptions::For::view);
    command.add_option("--session", session, "Session file to open: volume, view and settings")
        ->type_name("FILE.json");
    command
        .add_option("--play", play, "Recording to play, with a timeline, instead of a live session")
        ->type_name("FILE.csv");
    command.add_option("--window", size, "Size of the window [pixels]: WIDTHxHEIGHT")
        ->type_name("WxH");
    command
        .add_option("--screenshot", screenshot,
                    "Write a picture of the window once all is drawn, and end")
        ->type_name("FILE.png");
    command
        .add_option("--after", after, "Second of the session or recording for the screenshot (0)")
        ->check(from_zero());
}

void ViewOptions::settle() {
    std::string& volume = run.source.volume();
    if (volume.ends_with(".json") && session.empty()) session = std::exchange(volume, {});
    if (volume.ends_with(".csv") && play.empty()) play = std::exchange(volume, {});
    if (has_volume() && !session.empty()) {
        throw std::invalid_argument("VOLUME and --session: give only one of them");
    }
    if (!screenshot.empty() && !has_volume() && session.empty() && play.empty()) {
        throw std::invalid_argument("--screenshot needs a VOLUME, --session or --play");
    }
    if (!play.empty() && !session.empty()) {
        throw std::invalid_argument("--play and --session: give only one of them");
    }
    (void)window_size();
}

void ViewOptions::warn() const {
    if (screenshot.empty()) warn_of_no_effect(*command_, {"--after"}, "there is no --screenshot");
    if (session.empty() && play.empty()) return;
    std::vector<std::string> used{"--session", "--play",       "--window", "--after",
                                  "--device",  "--screenshot", "--quiet"};
    if (!session.empty()) {
        std::ranges::move(run.beside_session(), std::back_inserter(used));
        std::ranges::copy(without_settings, std::back_inserter(used));
    }
    if (!has_volume()) used.emplace_back("VOLUME");
    std::vector<std::string> useless;
    for (const CLI::Option* option : command_->get_options()) {
        const auto names_it = [&](const std::string& name) { return option->check_name(name); };
        if (std::ranges::none_of(used, names_it)) useless.push_back(option->get_name());
    }
    warn_of_no_effect(*command_, useless,
                      "the " + std::string(play.empty() ? "session" : "recording") +
                          " gives the data and the settings");
}

void ViewOptions::warn_beside_settings() const {
    warn_of_no_effect(*command_, without_settings, "the session has settings of its own");
}

std::optional<std::array<int, 2>> ViewOptions::window_size() const {
    if (size.empty()) return std::nullopt;
    int width = 0, height = 0, end = 0;
    const bool read = std::sscanf(size.c_str(), "%dx%d%n", &width, &height, &end) == 2;
    if (!read || end != static_cast<int>(size.size()) || width < 320 || height < 240 ||
        width > 16384 || height > 16384) {
        throw std::invalid_argument("--window " + size +
                                    ": write WIDTHxHEIGHT in pixels, as in 1280x800");
    }
    return std::array{width, height};
}

}  // namespace palpate::app
