// Starts the viewer, a program of its own, from the command line.
#pragma once

#include <filesystem>

namespace palpate::app {

/// The words after the command's name, as they were given. Kept by main().
struct Words {
    int count = 0;
    char** words = nullptr;
};

/// Where palpate-viewer is: the environment's PALPATE_VIEWER, else beside the running program or in
/// its build tree. Empty if it was not built or installed.
std::filesystem::path viewer_program();

/// Whether a window can open here: an X display is named.
bool has_display();

/// Becomes the viewer with these words. Throws std::invalid_argument, saying what to do, if there
/// is no viewer or no display.
[[noreturn]] void become_viewer(const Words& words);

}  // namespace palpate::app
