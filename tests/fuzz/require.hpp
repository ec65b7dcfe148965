// The requirements of fuzz targets on every outcome: one that is not met ends the program, which
// the fuzzer reports with the input.
#pragma once

#include <algorithm>
#include <cstdlib>
#include <string_view>

inline void require(bool promise) {
    if (!promise) std::abort();
}

/// A terminal shows it as it is, in one line. Names in it may be in any script.
inline bool is_one_line(std::string_view text) {
    return std::ranges::none_of(
        text, [](char c) { return static_cast<unsigned char>(c) < ' ' || c == '\x7f'; });
}

inline void require_one_line(std::string_view message, std::string_view beginning = "") {
    require(!message.empty() && message.size() < 1000 && message.starts_with(beginning));
    require(is_one_line(message));
}
