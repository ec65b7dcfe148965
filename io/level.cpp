// Levels: numbers in the data's units, or percent of its range.
#include "palpate/io/level.hpp"

#include <cmath>
#include <stdexcept>
#include <string>

#include "io/system/number.hpp"

namespace palpate::io {
namespace {

[[noreturn]] void refuse_level(std::string_view text) {
    throw std::invalid_argument("'" + std::string(text) +
                                "' is not a level: give a number in the data's units (300) or "
                                "percent of its range (53%)");
}

}  // namespace

Level level_from_text(std::string_view text) {
    const bool percent = !text.empty() && text.back() == '%';
    const std::string_view digits = text.substr(0, text.size() - (percent ? 1 : 0));
    const auto number = number_from<double>(digits);
    if (!number || !std::isfinite(*number)) refuse_level(text);
    if (percent) return PercentOfRange{*number};
    return *number;
}

double level_in(const Volume& volume, const Level& level) {
    if (const double* value = std::get_if<double>(&level)) return *value;
    const double range = volume.maximum() - volume.minimum();
    return volume.minimum() + std::get<PercentOfRange>(level).percent / 100 * range;
}

double level_from_text(std::string_view text, const Volume& volume) {
    const double level = level_in(volume, level_from_text(text));
    if (!std::isfinite(level)) refuse_level(text);
    return level;
}

}  // namespace palpate::io
