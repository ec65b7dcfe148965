// Numbers as text, independent of the locale: the shortest digits that read back as the same
// double. Header only.
#pragma once

#include <charconv>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace palpate::io {

inline void append_number(std::string& text, double value) {
    char digits[32];  // the longest double has 24
    const auto [end, error] = std::to_chars(digits, digits + sizeof digits, value);
    text.append(digits, end);
}

inline void append_number(std::string& text, std::int64_t value) {
    char digits[32];
    const auto [end, error] = std::to_chars(digits, digits + sizeof digits, value);
    text.append(digits, end);
}

/// The whole text as a number (a leading + is allowed), or nothing. "nan" and "inf" are numbers
/// here.
template <class T>
std::optional<T> number_from(std::string_view text) {
    if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
    T value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
    return value;
}

}  // namespace palpate::io
