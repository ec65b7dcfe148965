// Levels (isovalues and densities) as options and commands give them: in the data's units or in
// percent of their range.
#pragma once

#include <string_view>
#include <variant>

#include "palpate/volume.hpp"

namespace palpate::io {

struct PercentOfRange {
    double percent = 0;
};
/// A plain number is in the data's units.
using Level = std::variant<double, PercentOfRange>;

/// "300" is a level in the data's units, "53%" lies at this part of the data's range. Throws
/// std::invalid_argument.
Level level_from_text(std::string_view text);
/// The level in the data's units.
double level_in(const Volume& volume, const Level& level);
/// Both at once.
double level_from_text(std::string_view text, const Volume& volume);

}  // namespace palpate::io
