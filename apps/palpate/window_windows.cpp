// The viewer is not built for Windows yet.
#include <stdexcept>

#include "apps/palpate/commands.hpp"
#include "apps/palpate/window.hpp"

namespace palpate::app {

std::filesystem::path viewer_program() {
    return {};
}

bool has_display() {
    return false;
}

void become_viewer(const Words&) {
    throw std::invalid_argument(
        "there is no viewer for Windows yet: touch without a window (palpate touch --headless)");
}

}  // namespace palpate::app
