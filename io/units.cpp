// Units are a prefix of the metric system before metre or second, or one of a few others.
#include "io/units.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <span>
#include <string_view>
#include <utility>

#include "io/words.hpp"

namespace palpate::io {
namespace {

struct Prefix {
    std::string_view letter, name;
    int exponent;  ///< of 10
};
constexpr std::array<Prefix, 12> prefixes = {{{"", "", 0},
                                              {"a", "atto", -18},
                                              {"f", "femto", -15},
                                              {"p", "pico", -12},
                                              {"n", "nano", -9},
                                              {"u", "micro", -6},
                                              {"m", "milli", -3},
                                              {"c", "centi", -2},
                                              {"d", "deci", -1},
                                              {"da", "deca", 1},
                                              {"h", "hecto", 2},
                                              {"k", "kilo", 3}}};

using Named = std::pair<std::string_view, double>;

/// Characters that are escaped as Java does ("\\u00b5", small letters), as UTF-8.
void unescape(std::string& text) {
    constexpr std::size_t length = 6;
    for (std::size_t at = 0; (at = text.find("\\u", at)) != std::string::npos; ++at) {
        unsigned code = 0;
        const char* const digits = text.data() + at + 2;
        const char* const end = text.data() + std::min(at + length, text.size());
        const auto read = std::from_chars(digits, end, code, 16);
        if (read.ptr == digits + 4) text.replace(at, length, utf8_letter(code));
    }
}

/// Small letters without blanks around them; every way to write the letter for "micro" is a u.
std::string plain(std::string text) {
    text = in_utf8_or_latin_1(lower(std::move(text)));
    unescape(text);
    for (const std::string_view micro : {"\xc2\xb5", "\xce\xbc"}) {  // the sign, the Greek letter
        if (const auto at = text.find(micro); at != std::string::npos) {
            text.replace(at, micro.size(), "u");
        }
    }
    return trimmed(text);
}

/// `exponent`: that of the unit without a prefix.
std::optional<double> factor_of(const std::string& unit, std::string_view letter,
                                std::span<const std::string_view> names, int exponent,
                                std::span<const Named> others) {
    for (const Named& other : others) {
        if (unit == other.first) return other.second;
    }
    for (const Prefix& prefix : prefixes) {
        bool same = unit == std::string(prefix.letter).append(letter);
        for (const std::string_view name : names) {
            same = same || unit == std::string(prefix.name).append(name);
        }
        if (!same) continue;
        const int power = prefix.exponent + exponent;
        return power < 0 ? 1 / std::pow(10.0, -power) : std::pow(10.0, power);  // rounded once
    }
    return std::nullopt;
}

/// By its name, or by its name in the plural.
template <class F>
std::optional<double> singular_or_plural(const std::string& given, F&& factor) {
    const std::string unit = plain(given);
    auto found = factor(unit);
    if (!found && unit.size() > 3 && unit.back() == 's') {
        found = factor(unit.substr(0, unit.size() - 1));
    }
    return found;
}

}  // namespace

std::optional<double> millimetres_in(const std::string& unit) {
    static constexpr std::array<std::string_view, 2> names = {"meter", "metre"};
    static constexpr std::array<Named, 17> others = {{{"micron", 1e-3},
                                                      {"angstrom", 1e-7},
                                                      {"\xc3\x85", 1e-7},
                                                      {"\xe2\x84\xab", 1e-7},
                                                      {"in", 25.4},
                                                      {"inch", 25.4},
                                                      {"inches", 25.4},
                                                      {"ft", 304.8},
                                                      {"foot", 304.8},
                                                      {"feet", 304.8},
                                                      {"yd", 914.4},
                                                      {"yard", 914.4},
                                                      {"mile", 1609344},
                                                      {"thou", 0.0254},
                                                      {"mil", 0.0254},
                                                      {"li", 25.4 / 12},
                                                      {"pt", 25.4 / 72}}};
    return singular_or_plural(
        unit, [](const std::string& name) { return factor_of(name, "m", names, 3, others); });
}

std::optional<double> seconds_in(const std::string& unit) {
    static constexpr std::array<std::string_view, 2> names = {"second", "sec"};
    static constexpr std::array<Named, 9> others = {{{"msec", 1e-3},
                                                     {"usec", 1e-6},
                                                     {"min", 60},
                                                     {"minute", 60},
                                                     {"h", 3600},
                                                     {"hr", 3600},
                                                     {"hour", 3600},
                                                     {"d", 86400},
                                                     {"day", 86400}}};
    return singular_or_plural(
        unit, [](const std::string& name) { return factor_of(name, "s", names, 0, others); });
}

}  // namespace palpate::io
