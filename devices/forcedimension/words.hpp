// Differences between systems in calling and installing Force Dimension's library.
#pragma once

#include <string>
#include <vector>

namespace palpate::devices::forcedimension {

/// The first one that is there is taken: libdrd holds all of libdhd.
std::vector<std::string> library_names();
// For messages.
extern const char* const names_in_words;
extern const char* const how_to_install;
extern const char* const how_to_attach;

}  // namespace palpate::devices::forcedimension
