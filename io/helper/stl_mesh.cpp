// Reads STL. VTK's reader stops at byte order marks, comments and line ends of other systems, and
// takes the triangles of a file that is cut off.
#include "io/helper/stl_mesh.hpp"

#include <algorithm>
#include <cstdint>
#include <span>
#include <sstream>

#include "io/byte_order.hpp"
#include "io/helper/decode.hpp"
#include "io/helper/text_lines.hpp"
#include "io/system/number.hpp"
#include "io/words.hpp"

namespace palpate::io {
namespace {

using Corner = std::array<double, 3>;

/// Where "solid" begins a line of the text, after comments. The text's size if nowhere.
std::size_t begin_of_solid(const std::string& text) {
    std::size_t at = 0;
    while (at < text.size()) {
        const std::size_t end = std::min(text.find('\n', at), text.size());
        if (lower(trimmed(text.substr(at, end - at))).starts_with("solid")) break;
        at = end + 1;
    }
    return std::min(at, text.size());
}

[[noreturn]] void fail_stl(const std::string& what) {
    throw Failure("is damaged or not what its name says (" + what + "); export it again");
}

/// Three corners for each triangle of a text, from its "solid" on. Some programs leave out
/// "endsolid", so only a facet that is cut off shows that the file is.
std::vector<Corner> corners_in_text(const std::string& text, std::size_t begin) {
    std::istringstream in(text.substr(begin));
    std::vector<Corner> corners;
    bool is_open = true;
    for (std::string line; next_line(in, line);) {
        std::istringstream words(lower(line));
        bool in_name = false;
        for (std::string before, word; before = word, words >> word;) {
            if (in_name && !(before == "facet" && word == "normal")) continue;
            in_name = word.starts_with("solid") || word == "endsolid";
            if (in_name) {
                is_open = word != "endsolid";
            } else if (word == "normal") {
                words >> word >> word >> word;  // it follows from the corners
            } else if (word == "vertex") {
                Corner& corner = corners.emplace_back();
                for (double& coordinate : corner) {
                    word.clear();
                    words >> word;
                    const auto number = number_from<double>(word);
                    if (!number) fail_stl("'" + word.substr(0, 40) + "' is not a number");
                    coordinate = *number;
                }
            } else if (word == "endloop") {
                if (corners.size() % 3 != 0) fail_stl("a facet has not three corners");
            } else if (word == "facet" || word == "endfacet") {
                is_open = word == "facet";
            } else if (word != "outer" && word != "loop") {
                fail_stl("'" + word.substr(0, 40) + "' is no word of STL");
            }
        }
    }
    if (is_open || corners.size() % 3 != 0) fail_stl("it is cut off");
    return corners;
}

/// The same for a binary file. It gives its number of triangles, but some programs count too few.
std::vector<Corner> corners_in_binary(const std::string& bytes) {
    constexpr std::size_t head = 84, triangle = 50, normal = 12;
    if (bytes.size() < head) throw Failure("is too short for an STL file; copy it again");
    const auto raw = std::as_bytes(std::span(bytes));
    std::size_t count = little_endian<std::uint32_t>(raw.subspan(head - 4));
    if (bytes.size() < head + triangle * count) {
        throw Failure("it is cut off: its " + std::to_string(count) +
                      " triangles need more bytes; copy it again");
    }
    const bool is_padded = bytes.find_first_not_of('\0', head + triangle * count) == bytes.npos;
    const std::size_t behind = bytes.size() - head;
    if (!is_padded && behind % triangle == 0) count = behind / triangle;
    std::vector<Corner> corners(3 * count);
    for (std::size_t i = 0; i < corners.size(); ++i) {
        for (std::size_t a = 0; a < 3; ++a) {
            const std::size_t at = head + i / 3 * triangle + normal + (i % 3 * 3 + a) * 4;
            corners[i][a] = little_endian<float>(raw.subspan(at));
        }
    }
    return corners;
}

}  // namespace

std::vector<Corner> stl_corners(const std::string& bytes) {
    // The free header of some binary files begins with "solid", too.
    const bool may_be_text = bytes.find('\0') >= std::min<std::size_t>(bytes.size(), 84);
    const std::string text = may_be_text ? plain_text(bytes) : "";
    const std::size_t begin = begin_of_solid(text);
    return begin < text.size() ? corners_in_text(text, begin) : corners_in_binary(bytes);
}

}  // namespace palpate::io
