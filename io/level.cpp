// Reads levels: numbers in the data's units, or percent of its range.
#include "palpate/io/level.hpp"

#include <charconv>
#include <cmath>
#include <stdexcept>
#include <string>
#include <system_error>

namespace palpate::io {

double level_from_text(std::string_view text, const Volume& volume) {
    const bool percent = !text.empty() && text.back() == '%';
    const std::string_view digits = text.substr(0, text.size() - (percent ? 1 : 0));
    const char* const last = digits.data() + digits.size();
    double number = 0;
    const auto [end, error] = std::from_chars(digits.data(), last, number);
    const bool good = error == std::errc{} && end == last;
    const double range = volume.maximum() - volume.minimum();
    const double level = percent ? volume.minimum() + number / 100 * range : number;
    if (good && std::isfinite(level)) return level;
    throw std::invalid_argument("'" + std::string(text) +
                                "' is not a level: give a number in the data's units (300) or "
                                "percent of its range (53%)");
}

}  // namespace palpate::io
