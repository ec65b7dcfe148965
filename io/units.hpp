// Units of length and time, by the names that headers of all formats give them. Private to io/ and
// stream/.
#pragma once

#include <optional>
#include <string>

namespace palpate::io {

/// How long a unit is: "um", "microns", "Micrometre", ... Nothing if its name is not known.
std::optional<double> millimetres_in(const std::string& unit);
/// The same for units of time: "ms", "seconds", "hour", ... [s]
std::optional<double> seconds_in(const std::string& unit);

}  // namespace palpate::io
