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

/// As std::from_chars, but the number may begin with one plus sign.
template <class T>
std::from_chars_result read_number(const char* at, const char* end, T& value) {
    if (end - at > 1 && at[0] == '+' && at[1] != '-') ++at;
    return std::from_chars(at, end, value);
}

/// The whole text as a number, or nothing. "nan" and "inf" are numbers here.
template <class T>
std::optional<T> number_from(std::string_view text) {
    T value{};
    const auto [end, error] = read_number(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
    return value;
}

}  // namespace palpate::io
