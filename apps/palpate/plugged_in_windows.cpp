// Devices that are plugged in are not looked for on Windows.
#include "apps/palpate/plugged_in.hpp"

namespace palpate::app {

std::vector<std::string> plugged_in(const std::string&) {
    return {};
}

}  // namespace palpate::app
