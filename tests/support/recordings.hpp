// Texts of recordings, changed as a program of before would have written them.
#pragma once

#include <sstream>
#include <string>

namespace palpate::support {

/// A recording as format 1 had it: without tick numbers and checksums.
inline std::string as_format_1(const std::string& text) {
    std::istringstream lines(text);
    std::string changed, line;
    bool table = false;
    while (std::getline(lines, line)) {
        table = table || line.starts_with("t,");
        if (table && !line.starts_with('#')) {
            line.erase(line.rfind(',', line.rfind(',') - 1));
        } else if (line.starts_with("# palpate recording 6")) {
            line = "# palpate recording 1";
        } else if (line.starts_with("# end ")) {
            line.replace(line.find(",\"crc32\""), std::string::npos, "}");
        }
        changed += line + '\n';
    }
    return changed;
}

/// The start of the table's first row.
inline std::size_t first_row(const std::string& recording) {
    return recording.find('\n', recording.find("\nt,hip") + 1) + 1;
}

}  // namespace palpate::support
