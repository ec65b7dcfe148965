// Guesses about raw files, and pictures of their slices.
#include <gtest/gtest.h>
#include <fstream>

#include "apps/viewer/model/opening.hpp"
#include "support/scratch_folder.hpp"

namespace palpate::viewer::test {
namespace {

TEST(RawPreview, a_name_tells_size_type_and_byte_order) {
    const auto named = guessed_layout("bonsai_256x255x113_uint16.raw", 0);
    EXPECT_EQ(named.size, Index3(256, 255, 113));
    EXPECT_EQ(named.type, SampleType::uint16);
    EXPECT_FALSE(named.big_endian);
    const auto big = guessed_layout("a/b-int16-12x13x14-be.raw", 0);
    EXPECT_EQ(big.size, Index3(12, 13, 14));
    EXPECT_EQ(big.type, SampleType::int16);
    EXPECT_TRUE(big.big_endian);
}

TEST(RawPreview, without_words_a_cube_that_fits_is_guessed) {
    EXPECT_EQ(guessed_layout("a.raw", 27).size, Index3(3, 3, 3));
    const auto wide = guessed_layout("a.raw", 2 * 512);
    EXPECT_EQ(wide.size, Index3(8, 8, 8));
    EXPECT_EQ(wide.type, SampleType::uint16);
    const auto floats = guessed_layout("a_float32.raw", 4 * 512);
    EXPECT_EQ(floats.size, Index3(8, 8, 8));
    EXPECT_EQ(floats.type, SampleType::float32);
    EXPECT_EQ(guessed_layout("a.raw", 12345).size, Index3(256, 256, 256));
    EXPECT_EQ(guessed_layout("a_99999999999x1x1.raw", 7).size, Index3(256, 256, 256));
}

TEST(RawPreview, only_files_without_header_and_layout_lack_one) {
    const support::ScratchFolder folder;
    std::ofstream(folder.path() / "a.raw") << "x";
    std::ofstream(folder.path() / "a.nrrd") << "x";
    const auto source = [&](const char* name) {
        return run::source_named((folder.path() / name).string());
    };
    EXPECT_TRUE(lacks_layout(source("a.raw")));
    EXPECT_FALSE(lacks_layout(source("a.nrrd")));
    EXPECT_FALSE(lacks_layout(source("missing.raw")));
    EXPECT_FALSE(lacks_layout(run::source_named("synthetic:torus")));
    run::Source known = source("a.raw");
    std::get<run::FileSource>(known.from).raw = io::RawLayout{};
    EXPECT_FALSE(lacks_layout(known));
}

TEST(RawPreview, a_slice_is_shown_from_its_least_to_its_greatest_sample) {
    const support::ScratchFolder folder;
    const auto path = folder.path() / "a.raw";
    // A header of one byte, then two slices of 2 x 1 big-endian samples.
    std::ofstream(path, std::ios::binary) << std::string("h\1\0\0\7\0\5\1\5", 9);
    io::RawLayout layout;
    layout.size = Index3(2, 1, 2);
    layout.type = SampleType::uint16;
    layout.skip = 1;
    layout.big_endian = true;
    EXPECT_EQ(bytes_of(layout), 9);
    const auto first = raw_slice(path, layout, 0), second = raw_slice(path, layout, 1);
    ASSERT_TRUE(first && second);
    EXPECT_EQ(first->width, 2);
    EXPECT_EQ(first->grey, (std::vector<std::uint8_t>{255, 0}));
    EXPECT_EQ(second->grey, (std::vector<std::uint8_t>{0, 255}));
    EXPECT_FALSE(raw_slice(path, layout, 2)) << "beyond the end";
}

}  // namespace
}  // namespace palpate::viewer::test
