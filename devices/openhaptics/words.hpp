// What differs by system in how OpenHaptics is called and installed.
#pragma once

namespace palpate::devices::openhaptics {

extern const char* const library_name;
// Each ends a message.
extern const char* const how_to_install;
extern const char* const how_to_attach;

}  // namespace palpate::devices::openhaptics
