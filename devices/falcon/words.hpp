// Differences between systems in calling and installing libftdi.
#pragma once

#include <string>
#include <vector>

namespace palpate::devices::falcon {

std::vector<std::string> library_names();
// For messages.
extern const char* const how_to_install;
extern const char* const how_to_attach;

}  // namespace palpate::devices::falcon
