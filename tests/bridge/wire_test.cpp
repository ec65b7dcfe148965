// Messages as bytes: which are sent, accepted and refused.
#include "bridge/wire.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <functional>

#include "bridge/bytes.hpp"
#include "support/random.hpp"

namespace palpate::bridge {
namespace {

std::vector<Received> read(std::string_view bytes, std::size_t piece = 1 << 20,
                           const WireLimits& limits = {}) {
    Reader reader(limits);
    std::vector<Received> out;
    for (std::size_t at = 0; at < bytes.size(); at += piece) {
        reader.feed(bytes.substr(at, piece), out);
    }
    return out;
}

/// An IMAGE of 2 x 3 x 4 samples of one byte each, whose bytes at `at` a test may change.
std::string image_content(std::uint8_t scalar = 3, std::size_t bytes = 1, bool ras = true,
                          std::uint8_t endian = 2) {
    std::string content;
    put(content, std::uint16_t{1});
    for (const std::uint8_t one : {std::uint8_t{1}, scalar, endian, std::uint8_t(ras ? 1 : 2)}) {
        put(content, one);
    }
    for (const std::uint16_t size : {2, 3, 4}) put(content, size);
    for (const float one : {0.5F, 0.F, 0.F, 0.F, 2.F, 0.F, 0.F, 0.F, 3.F, 10.F, 20.F, 30.F}) {
        put(content, one);
    }
    for (const std::uint16_t none : {0, 0, 0}) put(content, none);
    for (const std::uint16_t size : {2, 3, 4}) put(content, size);
    for (std::size_t i = 0; i < 24 * bytes; ++i) content += static_cast<char>(i % 50);
    return content;
}

TEST(Wire, the_checksum_is_that_of_the_standard) {
    // CRC-64/ECMA-182 of its check string.
    const std::string bytes = message("A", "B", "123456789", 0);
    EXPECT_EQ(number_at<std::uint64_t>(bytes, 50), 0x6C40DF5F0B497347ULL);
}

TEST(Wire, messages_are_read_in_pieces_of_any_size) {
    const std::string bytes = message("STRING", "Command", string_body("isovalue 3"), 12.5) +
                              message("GET_POLYDATA", "", "", 0) +
                              message("IMAGE", "CT", image_content(), 0);
    for (std::size_t piece = 1; piece < 200; ++piece) {
        const auto got = read(bytes, piece);
        ASSERT_EQ(got.size(), 3U) << piece;
        EXPECT_EQ(text_of(got[0]), "isovalue 3");
        EXPECT_EQ(got[1].type, "GET_POLYDATA");
        EXPECT_EQ(got[2].name, "CT");
        EXPECT_EQ(volume_of(got[2]).bytes(), 24U);
    }
}

TEST(Wire, extensions_of_later_versions_are_left_out) {
    std::string body;
    put(body, std::uint16_t{16});  // extended header: 12 and 4 more
    put(body, std::uint16_t{2});
    put(body, std::uint32_t{3});
    put(body, std::uint32_t{77});
    body += "more" + string_body("freeze on") + "hhmmm";
    std::string bytes = message("STRING", "Command", body, 0);
    bytes[1] = 2;
    const auto got = read(bytes);
    ASSERT_EQ(got.size(), 1U);
    EXPECT_EQ(text_of(got[0]), "freeze on");
    std::string lying = message("STRING", "Command", body.substr(0, 20), 0);
    lying[1] = 2;
    EXPECT_THROW(read(lying), WireError);
}

TEST(Wire, a_transform_goes_out_as_slicer_has_it) {
    const Mat3 turn = Eigen::AngleAxisd(0.3, Vec3(1, 2, 3).normalized()).toRotationMatrix();
    const std::string body = transform_body(turn, {1, 2, 3});
    ASSERT_EQ(body.size(), 48U);
    const auto at = [&](std::size_t i) { return number_at<float>(body, 4 * i); };
    EXPECT_EQ(at(9), -1);
    EXPECT_EQ(at(10), -2);
    EXPECT_EQ(at(11), 3);
    for (std::size_t column = 0; column < 3; ++column) {
        EXPECT_FLOAT_EQ(at(3 * column), -float(turn(0, int(column))));
        EXPECT_FLOAT_EQ(at(3 * column + 2), float(turn(2, int(column))));
    }
}

TEST(Wire, an_image_lies_where_slicer_has_it) {
    const Volume volume = volume_of({"IMAGE", "CT", image_content()});
    const Geometry& grid = volume.geometry();
    EXPECT_EQ(grid.size, Index3(2, 3, 4));
    EXPECT_EQ(grid.spacing, Vec3(0.5, 2, 3));
    // The position is the centre's, in RAS.
    EXPECT_EQ(physical_centre(grid), Vec3(-10, -20, 30));
    EXPECT_EQ(grid.direction, Mat3(Vec3(-1, -1, 1).asDiagonal()));
    EXPECT_EQ(volume.sample({1, 2, 3}), 23);
    const Volume lps = volume_of({"IMAGE", "CT", image_content(3, 1, false)});
    EXPECT_EQ(physical_centre(lps.geometry()), Vec3(10, 20, 30));
}

TEST(Wire, an_image_of_any_scalar_type_and_order_is_read) {
    const struct {
        std::uint8_t scalar;
        std::size_t bytes;
        SampleType type;
    } kinds[] = {{2, 1, SampleType::int16},    {3, 1, SampleType::uint8},
                 {4, 2, SampleType::int16},    {5, 2, SampleType::uint16},
                 {6, 4, SampleType::float32},  {7, 4, SampleType::float32},
                 {10, 4, SampleType::float32}, {11, 8, SampleType::float32}};
    for (const auto& kind : kinds) {
        for (const std::uint8_t endian : {1, 2}) {
            const std::string content = image_content(kind.scalar, kind.bytes, true, endian);
            EXPECT_EQ(volume_of({"IMAGE", "", content}).type(), kind.type) << int(kind.scalar);
        }
    }
    const Volume big = volume_of({"IMAGE", "", image_content(5, 2, true, 1)});
    EXPECT_EQ(big.sample({1, 0, 0}), 2 * 256 + 3);
    const Volume little = volume_of({"IMAGE", "", image_content(5, 2, true, 2)});
    EXPECT_EQ(little.sample({1, 0, 0}), 3 * 256 + 2);
}

TEST(Wire, a_header_that_promises_too_much_is_refused_before_anything_comes) {
    std::string bytes = message("IMAGE", "CT", "", 0);
    bytes[42] = 1;  // 2^56 bytes
    EXPECT_THROW(read(bytes), WireError);
    EXPECT_THROW(read(message("STRING", "", std::string(70'000, ' '), 0)), WireError);
    EXPECT_THROW(read(message("IMAGE", "", std::string(200, ' '), 0), 64, {100, 100}), WireError);
}

TEST(Wire, what_is_not_as_it_should_be_is_refused) {
    std::string wrong_sum = message("STRING", "", string_body("x"), 0);
    wrong_sum.back() ^= 1;
    std::string version = message("STRING", "", "", 0);
    version[1] = 9;
    for (const std::string& bytes :
         {wrong_sum, version, message("STR\x1b[31m", "", "", 0), std::string(58, 'x')}) {
        EXPECT_THROW(read(bytes), WireError);
    }
    for (const std::string& content :
         {std::string(), std::string("\0\3\0\5four", 8), string_body("two\nlines"),
          string_body(std::string(5000, 'a'))}) {
        EXPECT_THROW(text_of({"STRING", "", content}), WireError);
    }
    const std::function<void(std::string&)> damages[] = {
        [](std::string& c) { c.resize(71); },
        [](std::string& c) { c.pop_back(); },
        [](std::string& c) { c += 'x'; },
        [](std::string& c) { c[2] = 3; },
        [](std::string& c) { c[3] = 8; },
        [](std::string& c) { c[3] = 99; },
        [](std::string& c) { c[4] = 0; },
        [](std::string& c) { c[5] = 7; },
        [](std::string& c) { c[7] = 0; },
        [](std::string& c) { c[6] = '\xff'; },
        [](std::string& c) { c[61] = 1; },
        [](std::string& c) { c[67] = 1; },
        [](std::string& c) { c.replace(12, 4, 4, 0); },
        [](std::string& c) {
            c[12] = '\x7f';
            c[13] = '\xc0';
        },
        [](std::string& c) { c.replace(24, 4, c.substr(12, 4)); }};
    for (std::size_t i = 0; i < std::size(damages); ++i) {
        std::string content = image_content();
        damages[i](content);
        EXPECT_THROW(volume_of({"IMAGE", "", content}), WireError) << i;
    }
}

TEST(Wire, random_bytes_and_damage_end_in_an_error_or_in_nothing) {
    support::Random random(5);
    for (int round = 0; round < 2000; ++round) {
        std::string content = image_content();
        for (int i = 0; i < 3; ++i) {
            content[std::size_t(random.uniform(0, 72))] = char(random.uniform(-128, 128));
        }
        try {
            const Volume volume = volume_of({"IMAGE", "", content});
            EXPECT_LE(volume.bytes(), 4 * content.size());
        } catch (const WireError&) {
        }
    }
}

TEST(Wire, a_surface_has_its_points_and_triangles) {
    SurfaceMesh mesh;
    mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}};
    mesh.triangles = {{0, 1, 2}};
    const std::string body = polydata_body(mesh);
    ASSERT_EQ(body.size(), 40U + 36 + 16);
    EXPECT_EQ(number_at<std::uint32_t>(body, 0), 3U);
    EXPECT_EQ(number_at<std::uint32_t>(body, 20), 1U);
    EXPECT_EQ(number_at<std::uint32_t>(body, 24), 16U);
    EXPECT_EQ(number_at<float>(body, 40 + 28), -2);
    EXPECT_EQ(number_at<std::uint32_t>(body, 40 + 36 + 12), 2U);
}

}  // namespace
}  // namespace palpate::bridge
