// palpate view, and how any command opens the viewer.
#include "apps/palpate/window.hpp"

#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <stdexcept>
#include <vector>

#include "apps/options/view_options.hpp"
#include "apps/palpate/commands.hpp"

namespace palpate::app {

namespace fs = std::filesystem;

fs::path viewer_program() {
    if (const char* set = std::getenv("PALPATE_VIEWER")) return set;
    std::error_code error;
    const fs::path here = fs::read_symlink("/proc/self/exe", error).parent_path();
    for (const fs::path& folder : {here, here / "../viewer"}) {  // installed, built
        if (::access((folder / "palpate-viewer").c_str(), X_OK) == 0) {
            return folder / "palpate-viewer";
        }
    }
    return {};
}

bool has_display() {
    const char* display = std::getenv("DISPLAY");
    return display && *display;
}

void become_viewer(const Words& words) {
    const fs::path program = viewer_program();
    if (program.empty()) {
        throw std::invalid_argument(
            "the viewer is not installed: build with PALPATE_VIEWER=ON (package libvtk9-qt-dev), "
            "or touch without a window (palpate touch --headless)");
    }
    if (!has_display()) {
        throw std::invalid_argument(
            "there is no display to open a window on: DISPLAY is not set (over ssh: ssh -X; a "
            "virtual one: xvfb-run palpate view ...)");
    }
    std::vector<char*> arguments{const_cast<char*>(program.c_str())};
    arguments.insert(arguments.end(), words.words, words.words + words.count);
    arguments.push_back(nullptr);
    // The viewer decides itself which signals to ignore or catch.
    for (const int s : {SIGPIPE, SIGXFSZ}) std::signal(s, SIG_DFL);
    ::execv(program.c_str(), arguments.data());
    throw std::runtime_error(program.string() + " could not be started: " + std::strerror(errno));
}

void add_view(CLI::App& app, const Words& words) {
    auto options = std::make_shared<ViewOptions>();
    CLI::App* command = app.add_subcommand("view", "Touch a volume and look at it, in a window");
    command->footer(
        "Without a VOLUME the window offers the CT of a head that comes with the program. Open or "
        "drop any file there. ? lists the shortcuts.\n\nExample:\n  palpate view head.nrrd "
        "--device mouse");
    options->add_to(*command);
    command->callback([options, words] {
        options->settle();
        become_viewer(words);
    });
}

}  // namespace palpate::app
