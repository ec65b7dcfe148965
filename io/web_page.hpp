// Recognizes a web page that was saved in place of a file. Header only. Private to io/.
#pragma once

#include <string>

#include "io/words.hpp"

namespace palpate::io {

/// So many bytes of a file are enough for is_web_page().
inline constexpr std::size_t web_page_start = 1024;

inline constexpr const char* web_page_message =
    "is a web page (perhaps the login or error page of a server), not the file; download it again";

/// Whether a file begins as a web page: HTML after a byte order mark, blanks, comments or an XML
/// declaration. `start`: its first bytes.
inline bool is_web_page(std::string start) {
    if (start.starts_with("\xef\xbb\xbf")) start.erase(0, 3);
    start = lower(trimmed(start));
    for (const std::string begin : {"<?xml", "<!--"}) {
        if (!start.starts_with(begin)) continue;
        const std::size_t end = start.find(begin == "<!--" ? "-->" : "?>");
        start = end == start.npos ? "" : trimmed(start.substr(start.find('>', end) + 1));
    }
    return start.starts_with("<!doctype html") || start.starts_with("<html");
}

}  // namespace palpate::io
