// Devices that are plugged in, whether or not their library or service is there.
#pragma once

#include <string>
#include <vector>

namespace palpate::app {

/// In words, those that the backend of this name is for.
std::vector<std::string> plugged_in(const std::string& backend);

}  // namespace palpate::app
