// Replaying a recording and comparing it with itself.
#pragma once

#include <string>

namespace palpate::app {

/// Renders every tick of a recording again and compares it bit for bit, update times excepted.
/// Prints the first difference, or that there is none. `volume` is used instead of the name in the
/// recording where it is not empty. Throws io::InputError for a recording or volume that cannot be
/// read or is not the one recorded and for a tick that differs.
void validate(const std::string& recording, const std::string& volume, bool quiet);

}  // namespace palpate::app
