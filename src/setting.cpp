// Texts for numbers that are out of range.
#include "palpate/setting.hpp"

#include <array>
#include <cstdio>
#include <stdexcept>

namespace palpate {

std::string number_text(double value) {
    std::array<char, 32> text;
    std::snprintf(text.data(), text.size(), "%.6g", value);
    return text.data();
}

void refuse_number(const std::string& title, double value, const std::string& words) {
    throw std::invalid_argument(title + " = " + number_text(value) + ": must be " + words);
}

}  // namespace palpate
