// The parts of io/inflate.hpp that need no zlib.
#include <algorithm>
#include <fstream>

#include "io/inflate.hpp"

namespace palpate::io {

std::vector<std::byte> inflate_start(const std::filesystem::path& file, std::size_t bytes) {
    struct Enough {};
    std::vector<std::byte> start;
    const ByteSink keep = [&](std::span<const std::byte> chunk) {
        const std::size_t take = std::min(chunk.size(), bytes - start.size());
        start.insert(start.end(), chunk.begin(), chunk.begin() + static_cast<std::ptrdiff_t>(take));
        if (start.size() == bytes) throw Enough();
    };
    try {
        inflate_checked(file, {}, keep);
    } catch (const Enough&) {  // the rest of the stream is for later
    }
    return start;
}

bool is_gzip(const std::filesystem::path& file) {
    std::ifstream in(file, std::ios::binary);
    unsigned char magic[2] = {};
    in.read(reinterpret_cast<char*>(magic), 2);
    return in.gcount() == 2 && magic[0] == 0x1f && magic[1] == 0x8b;
}

}  // namespace palpate::io
