// Reads a level (an isovalue or a density) from text, as options and commands give it.
#pragma once

#include <string_view>

#include "palpate/volume.hpp"

namespace palpate::io {

/// "300" is a level in the data's units, "53%" lies at this part of the data's range. Throws
/// std::invalid_argument, quoting the text, for anything else; also for NaN and infinity.
double level_from_text(std::string_view text, const Volume& volume);

}  // namespace palpate::io
