// Reads a whole text from a file, with limits on its length. Windows.
#include <algorithm>
#include <cstdint>
#include <fstream>
#include <system_error>

#include "palpate/io/csv.hpp"

namespace palpate::io {
namespace {

constexpr std::size_t block_bytes = std::size_t{1} << 20;
constexpr std::size_t longest_line = std::size_t{16} << 20;
constexpr std::uint64_t largest_file = std::uint64_t{4} << 30;

[[noreturn]] void fail(const std::filesystem::path& path, const std::string& problem) {
    throw InputError(path.string() + ": " + problem);
}

void check_lines(const std::filesystem::path& path, const std::string& text) {
    std::size_t number = 1;
    for (std::size_t begin = 0; begin < text.size(); ++number) {
        const std::size_t end = std::min(text.find('\n', begin), text.size());
        if (end - begin > longest_line) {
            fail(path,
                 "line " + std::to_string(number) +
                     " is longer than 16 MiB: this is no table, or its line ends are missing");
        }
        begin = end + 1;
    }
}

}  // namespace

std::string read_text(const std::filesystem::path& path, const OnProgress& progress) {
    std::error_code error;
    if (std::filesystem::is_directory(path, error)) fail(path, "is a folder: name a file in it");
    std::ifstream in(path, std::ios::binary);
    if (!in) fail(path, "cannot be opened: check the name and your permission to read it");
    std::string text;
    while (in) {
        if (progress) progress(0);
        const std::size_t before = text.size();
        if (before > largest_file) {
            fail(path, "has more than the 4 GiB of text that are read: cut it into parts");
        }
        text.resize(before + block_bytes);
        in.read(text.data() + before, block_bytes);
        text.resize(before + static_cast<std::size_t>(in.gcount()));
        if (text.find('\0', before) != std::string::npos) {
            fail(path, "is not a text file: check its name");
        }
    }
    if (in.bad()) fail(path, "cannot be read: check the disk it is on");
    check_lines(path, text);
    if (text.starts_with("\xEF\xBB\xBF")) text.erase(0, 3);
    return text;
}

}  // namespace palpate::io
