// Animated PNGs, read by libpng and chunk by chunk.
#include "pictures/animation.hpp"

#include <gtest/gtest.h>
#include <png.h>
#include <zlib.h>

#include <array>
#include <stdexcept>
#include <string>
#include <vector>

#include "support/png.hpp"

namespace palpate {
namespace {

/// A picture of one colour.
std::string plain_png(unsigned width, unsigned height, unsigned char red) {
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    image.width = width;
    image.height = height;
    image.format = PNG_FORMAT_RGB;
    const std::vector<png_byte> pixels(std::size_t{3} * width * height, red);
    png_alloc_size_t size = 0;
    png_image_write_to_memory(&image, nullptr, &size, 0, pixels.data(), 0, nullptr);
    std::string bytes(size, '\0');
    png_image_write_to_memory(&image, bytes.data(), &size, 0, pixels.data(), 0, nullptr);
    return bytes;
}

struct Chunk {
    std::string kind, data;
};

std::uint32_t number_in(const std::string& bytes, std::size_t at) {
    std::uint32_t number = 0;
    for (std::size_t i = at; i < at + 4; ++i) {
        number = number << 8 | static_cast<unsigned char>(bytes.at(i));
    }
    return number;
}

std::vector<Chunk> chunks_of(const std::string& file) {
    std::vector<Chunk> chunks;
    for (std::size_t at = 8; at < file.size();) {
        const std::size_t size = number_in(file, at);
        const std::string covered = file.substr(at + 4, 4 + size);
        EXPECT_EQ(crc32(0, reinterpret_cast<const Bytef*>(covered.data()),
                        static_cast<uInt>(covered.size())),
                  number_in(file, at + 8 + size));
        chunks.push_back({covered.substr(0, 4), covered.substr(4)});
        at += 12 + size;
    }
    return chunks;
}

TEST(Animation, is_a_png_that_shows_its_first_picture_to_programs_without_animation) {
    const std::vector<std::string> pictures{plain_png(20, 10, 200), plain_png(20, 10, 100)};
    const support::Png png = support::png_from(pictures::animation_of(pictures, 0.05));
    EXPECT_EQ(png.width, 20U);
    EXPECT_EQ(png.height, 10U);
    EXPECT_EQ(png.at(3, 3), (support::Pixel{200, 200, 200}));
}

TEST(Animation, its_frames_are_the_pictures_data_in_order_and_numbered) {
    const std::vector<std::string> pictures{plain_png(20, 10, 1), plain_png(20, 10, 2),
                                            plain_png(20, 10, 3)};
    std::vector<std::string> data;
    std::uint32_t number = 0;
    for (const Chunk& chunk : chunks_of(pictures::animation_of(pictures, 0.05))) {
        if (chunk.kind == "acTL") {
            EXPECT_EQ(number_in(chunk.data, 0), 3U);
        }
        if (chunk.kind == "fcTL") {
            EXPECT_EQ(number_in(chunk.data, 0), number++);
            EXPECT_EQ(number_in(chunk.data, 4), 20U);
            EXPECT_EQ(number_in(chunk.data, 20), 50U << 16 | 1000U);  // 50 / 1000 s
        }
        if (chunk.kind == "IDAT") data.push_back(chunk.data);
        if (chunk.kind == "fdAT") {
            EXPECT_EQ(number_in(chunk.data, 0), number++);
            data.push_back(chunk.data.substr(4));
        }
    }
    ASSERT_EQ(data.size(), 3U);
    for (std::size_t i = 0; i < 3; ++i) {
        for (const Chunk& chunk : chunks_of(pictures[i])) {
            if (chunk.kind == "IDAT") {
                EXPECT_EQ(chunk.data, data[i]);
            }
        }
    }
}

TEST(Animation, refuses_pictures_that_make_no_animation) {
    const std::string good = plain_png(20, 10, 1);
    const auto refused = [](const std::vector<std::string>& pictures, double seconds) {
        EXPECT_THROW(pictures::animation_of(pictures, seconds), std::invalid_argument);
    };
    refused({}, 0.1);
    refused({good}, 0);
    refused({good, plain_png(21, 10, 1)}, 0.1);
    refused({good, "text"}, 0.1);
    for (std::size_t length = 0; length < good.size(); ++length) {
        refused({good.substr(0, length)}, 0.1);
    }
}

}  // namespace
}  // namespace palpate
