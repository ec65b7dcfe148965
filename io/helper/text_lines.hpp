// Lines of texts that other systems wrote.
#pragma once

#include <algorithm>
#include <istream>
#include <string>

namespace palpate::io {

/// Without a byte order mark, every line with a line feed at its end.
inline std::string plain_text(const std::string& bytes) {
    std::string text;
    for (std::size_t i = bytes.starts_with("\xef\xbb\xbf") ? 3 : 0; i < bytes.size(); ++i) {
        if (bytes[i] != '\r') {
            text += bytes[i];
        } else if (i + 1 == bytes.size() || bytes[i + 1] != '\n') {
            text += '\n';
        }
    }
    return text;
}

/// The next line without its comment, which goes into `comment`. False at the end.
inline bool next_line(std::istream& in, std::string& line, std::string* comment = nullptr) {
    if (!std::getline(in, line)) return false;
    const std::size_t end = std::min(line.find('#'), line.size());
    if (comment) *comment = line.substr(end);
    line.resize(end);
    return true;
}

}  // namespace palpate::io
