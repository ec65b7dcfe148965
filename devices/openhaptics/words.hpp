// Differences between systems in calling and installing OpenHaptics.
#pragma once

#include <string>
#include <vector>

namespace palpate::devices::openhaptics {

extern const char* const library_name;  ///< its usual one
/// All that it may have, in the order to try.
std::vector<std::string> library_names();
// Each ends a message.
extern const char* const how_to_install;
extern const char* const how_to_attach;

}  // namespace palpate::devices::openhaptics
