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
