// A look at the first page of a TIFF file: the tags in its directory. "TIFF Revision 6.0", Adobe
// 1992; BigTIFF: https://www.awaresystems.be/imaging/tiff/bigtiff.html.
#include "io/tiff_peek.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <fstream>
#include <string>

namespace palpate::io {
namespace {

class TiffBytes {
  public:
    explicit TiffBytes(std::istream& in) : in_(in) {}

    void set_big_endian(bool big) { big_endian_ = big; }
    /// The next bytes; nothing at the end of the file.
    std::optional<std::uint64_t> number(std::size_t bytes) {
        std::array<char, 8> read{};
        if (!in_.read(read.data(), static_cast<std::streamsize>(bytes))) return std::nullopt;
        std::uint64_t number = 0;
        for (std::size_t i = 0; i < bytes; ++i) {
            const char byte = read[big_endian_ ? i : bytes - 1 - i];
            number = number << 8 | static_cast<unsigned char>(byte);
        }
        return number;
    }
    void go_to(std::uint64_t offset) { in_.seekg(static_cast<std::streamoff>(offset)); }
    void skip(std::size_t bytes) { in_.seekg(static_cast<std::streamoff>(bytes), std::ios::cur); }

  private:
    std::istream& in_;
    bool big_endian_ = false;
};

}  // namespace

std::optional<TiffPeek> peek_tiff(const std::filesystem::path& path) {
    std::error_code error;
    if (!is_tiff_name(path) || !std::filesystem::is_regular_file(path, error)) return std::nullopt;
    std::ifstream in(path, std::ios::binary);
    return peek_tiff_in(in);
}

std::optional<TiffPeek> peek_tiff_in(std::istream& in) {
    TiffBytes bytes(in);
    constexpr std::uint64_t little = 0x4949, big = 0x4D4D, classic = 42, large = 43;
    constexpr std::uint64_t tile_width = 322, sub_directories = 330, most_entries = 4096;
    const auto order = bytes.number(2);
    if (order != little && order != big) return std::nullopt;
    bytes.set_big_endian(order == big);
    const auto version = bytes.number(2);
    if (version != classic && version != large) return std::nullopt;
    if (version == large) bytes.skip(4);
    const auto directory = bytes.number(version == large ? 8 : 4);
    if (!directory || *directory > INT64_MAX) return std::nullopt;
    bytes.go_to(*directory);
    const auto entries = bytes.number(version == large ? 8 : 2);
    TiffPeek peek;
    for (std::uint64_t i = 0; entries && i < std::min(*entries, most_entries); ++i) {
        const auto tag = bytes.number(2);
        if (!tag) break;
        peek.tiled |= tag == tile_width;
        peek.has_levels |= tag == sub_directories;
        bytes.skip(version == large ? 18 : 10);
    }
    return peek;
}

}  // namespace palpate::io
