// Reads a PNG with libpng, which shares no code with the writer under test.
#pragma once

#include <gtest/gtest.h>
#include <png.h>

#include <array>
#include <set>
#include <string>
#include <vector>

namespace palpate::support {

using Pixel = std::array<png_byte, 3>;

struct Png {
    std::size_t width = 0, height = 0;
    std::vector<Pixel> pixels;  ///< row by row from the top

    const Pixel& at(std::size_t x, std::size_t y) const { return pixels.at(y * width + x); }
    std::size_t colours() const { return std::set<Pixel>(pixels.begin(), pixels.end()).size(); }
    /// How many pixels `is` holds of.
    template <class Is>
    std::size_t count(Is is) const {
        return static_cast<std::size_t>(std::count_if(pixels.begin(), pixels.end(), is));
    }
};

inline Png png_from(const std::string& bytes) {
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    Png png;
    if (png_image_begin_read_from_memory(&image, bytes.data(), bytes.size()) == 0) {
        ADD_FAILURE() << "not a PNG: " << image.message;
        return png;
    }
    image.format = PNG_FORMAT_RGB;
    png.width = image.width;
    png.height = image.height;
    png.pixels.resize(png.width * png.height);
    if (png_image_finish_read(&image, nullptr, png.pixels.data(), 0, nullptr) == 0) {
        ADD_FAILURE() << "a damaged PNG: " << image.message;
    }
    return png;
}

// What colour something has under light and shadow.
inline bool is_bone(const Pixel& p) {  // brownish, whatever the light
    return p[0] > p[1] && p[1] > p[2] && p[0] > p[2] + 10 && p[0] < p[2] + 90;
}
inline bool is_vermilion(const Pixel& p) {
    return p[0] > 2 * p[2] + 60 && p[0] > p[1] + 40;
}
inline bool is_blue(const Pixel& p) {
    return p[2] > p[0] + 60 && p[2] > p[1] + 30;
}
inline bool is_green(const Pixel& p) {
    return p[1] > p[0] + 60 && p[1] > p[2] + 15;
}

}  // namespace palpate::support
