// Words of headers, names of files and notes. Header only. Uses the standard library alone.
#pragma once

#include <algorithm>
#include <cstdio>
#include <string>
#include <string_view>
#include <vector>

namespace palpate::io {

/// In lower case, as ASCII has it, whatever the locale.
inline std::string lower(std::string text) {
    for (char& c : text) {
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    }
    return text;
}

/// Without blanks around it.
inline std::string trimmed(std::string_view text) {
    constexpr std::string_view blank = " \t\r\n";
    const auto begin = std::min(text.find_first_not_of(blank), text.size());
    return std::string(text.substr(begin, text.find_last_not_of(blank) + 1 - begin));
}

/// A character below 0x10000 as UTF-8.
inline std::string utf8_letter(unsigned code) {
    const auto byte = [](unsigned value) { return static_cast<char>(value); };
    if (code < 0x80) return {byte(code)};
    if (code < 0x800) return {byte(0xc0 | code >> 6), byte(0x80 | (code & 0x3f))};
    return {byte(0xe0 | code >> 12), byte(0x80 | (code >> 6 & 0x3f)), byte(0x80 | (code & 0x3f))};
}

inline bool is_utf8(std::string_view text) {
    for (std::size_t at = 0; at < text.size();) {
        const auto first = static_cast<unsigned char>(text[at++]);
        const int more = first < 0x80           ? 0
                         : (first >> 5) == 0x6  ? 1
                         : (first >> 4) == 0xe  ? 2
                         : (first >> 3) == 0x1e ? 3
                                                : -1;
        if (more < 0) return false;
        for (int i = 0; i < more; ++i, ++at) {
            if (at == text.size() || (static_cast<unsigned char>(text[at]) >> 6) != 2) return false;
        }
    }
    return true;
}

/// Text of older programs is Latin 1, which hardly ever looks like UTF-8.
inline std::string in_utf8_or_latin_1(std::string text) {
    if (is_utf8(text)) return text;
    std::string all;
    for (const char c : text) all += utf8_letter(static_cast<unsigned char>(c));
    return all;
}

/// A number as people write it.
inline std::string text_of(double number) {
    char text[32];
    std::snprintf(text, sizeof text, "%.6g", number);
    return text;
}

/// Appends a note unless it is there.
inline void add_note(std::vector<std::string>& notes, const std::string& note) {
    if (std::ranges::find(notes, note) == notes.end()) notes.push_back(note);
}

}  // namespace palpate::io
