// Writes APNG: the chunks of several PNGs in one file. The first picture's data stay in IDAT
// chunks, the others' go into numbered fdAT chunks.
#include "pictures/animation.hpp"

#include <zlib.h>

#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <string_view>
#include <vector>

namespace palpate::pictures {
namespace {

constexpr std::string_view signature("\x89PNG\r\n\x1a\n", 8);
constexpr std::size_t header_bytes = 13;

std::uint32_t number_at(std::string_view bytes) {
    std::uint32_t number = 0;
    for (int i = 0; i < 4; ++i) number = number << 8 | static_cast<unsigned char>(bytes[i]);
    return number;
}

std::string big_endian(std::uint32_t number, int bytes = 4) {
    std::string text;
    for (int i = bytes; i-- > 0;) text += static_cast<char>(number >> 8 * i & 0xFF);
    return text;
}

void append_chunk(std::string& file, std::string_view kind, std::string_view data) {
    const std::size_t begin = file.size() + 4;
    file += big_endian(static_cast<std::uint32_t>(data.size()));
    file += kind;
    file += data;
    const auto* bytes = reinterpret_cast<const Bytef*>(file.data() + begin);
    file += big_endian(
        static_cast<std::uint32_t>(crc32(0, bytes, static_cast<uInt>(file.size() - begin))));
}

/// The parts of a PNG.
struct Picture {
    std::string_view header;
    std::vector<std::string_view> data;
};

Picture picture_from(std::string_view png) {
    Picture picture;
    if (!png.starts_with(signature)) throw std::invalid_argument("a picture is no PNG");
    png.remove_prefix(signature.size());
    while (png.size() >= 12) {
        const std::size_t size = number_at(png);
        const std::string_view kind = png.substr(4, 4);
        if (size > png.size() - 12) break;
        if (kind == "IHDR") picture.header = png.substr(8, size);
        if (kind == "IDAT") picture.data.push_back(png.substr(8, size));
        if (kind == "PLTE") throw std::invalid_argument("a picture has a palette");
        png.remove_prefix(12 + size);
        if (kind == "IEND" && picture.header.size() == header_bytes && !picture.data.empty()) {
            return picture;
        }
    }
    throw std::invalid_argument("a picture is cut off");
}

std::string frame_control(std::uint32_t number, std::string_view header, double seconds) {
    constexpr std::uint32_t ticks = 1000;  // a second
    const auto delay = static_cast<std::uint32_t>(std::lround(seconds * ticks));
    std::string control = big_endian(number);
    control += header.substr(0, 8);  // width, height
    control += big_endian(0) + big_endian(0) + big_endian(delay, 2) + big_endian(ticks, 2);
    return control + std::string(2, '\0');  // leave it there; put it in place of what was
}

}  // namespace

std::string animation_of(std::span<const std::string> pngs, double seconds) {
    if (pngs.empty()) throw std::invalid_argument("an animation needs a picture");
    if (!(seconds > 0 && seconds <= 60)) {
        throw std::invalid_argument("a picture of an animation is shown for 0 to 60 s");
    }
    std::vector<Picture> pictures;
    for (const std::string& png : pngs) pictures.push_back(picture_from(png));

    const std::string_view header = pictures.front().header;
    std::string file(signature);
    append_chunk(file, "IHDR", header);
    append_chunk(file, "acTL",
                 big_endian(static_cast<std::uint32_t>(pictures.size())) + big_endian(0));
    std::uint32_t number = 0;
    for (const Picture& picture : pictures) {
        if (picture.header != header) {
            throw std::invalid_argument("the pictures of an animation differ in size or kind");
        }
        append_chunk(file, "fcTL", frame_control(number++, header, seconds));
        for (const std::string_view data : picture.data) {
            if (&picture == &pictures.front()) {
                append_chunk(file, "IDAT", data);
            } else {
                append_chunk(file, "fdAT", big_endian(number++) + std::string(data));
            }
        }
    }
    append_chunk(file, "IEND", {});
    return file;
}

}  // namespace palpate::pictures
