// Sources: the filters of samples after reading, and their names.
#include "palpate/run/source.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "palpate/filters/dequantize.hpp"
#include "palpate/io/address.hpp"
#include "palpate/io/error.hpp"
#include "palpate/io/live_file.hpp"
#include "palpate/scenes/volumes.hpp"
#include "tests/support/scratch_folder.hpp"

namespace palpate::run {
namespace {

Source dequantized_source(const std::string& name, int rounds) {
    Source source = source_named(name);
    std::get<SyntheticSource>(source.from).type = SampleType::uint8;
    source.dequantize = rounds;
    return source;
}

Volume dequantized_here(const Volume& volume, int rounds) {
    filters::DequantizeOptions options;
    options.rounds = rounds;
    return filters::dequantized(volume, options);
}

bool same_samples(const Volume& a, const Volume& b) {
    return std::ranges::equal(a.samples<float>(), b.samples<float>());
}

TEST(Source, is_dequantized_and_then_smoothed) {
    const Volume plain = load(dequantized_source("synthetic:sphere:16x16x16", 0)).volume;
    Source source = dequantized_source("synthetic:sphere:16x16x16", 3);
    EXPECT_TRUE(same_samples(load(source).volume, dequantized_here(plain, 3)));
    source.smooth = 2;
    EXPECT_TRUE(same_samples(load(source).volume, smoothed(dequantized_here(plain, 3), 2)));
}

TEST(Source, is_sharpened_after_all_that_and_keeps_it_in_its_names) {
    const Volume plain = load(dequantized_source("synthetic:sphere:16x16x16", 0)).volume;
    Source source = dequantized_source("synthetic:sphere:16x16x16", 3);
    source.smooth = 1;
    source.prefilter = true;
    EXPECT_TRUE(
        same_samples(load(source).volume, sharpened(smoothed(dequantized_here(plain, 3), 1))));
    EXPECT_TRUE(source_from(to_names(source)).prefilter);
    EXPECT_FALSE(source_from(to_names(source_named("synthetic:sphere"))).prefilter);
}

TEST(Source, is_dequantized_frame_by_frame) {
    const LoadedVolume plain = load(dequantized_source("synthetic:beating:12x12x12", 0));
    const LoadedVolume loaded = load(dequantized_source("synthetic:beating:12x12x12", 2));
    EXPECT_EQ(loaded.sequence.type, SampleType::float32);
    for (const int frame : {0, 3}) {
        EXPECT_TRUE(same_samples(io::read_frame(loaded.sequence, frame),
                                 dequantized_here(io::read_frame(plain.sequence, frame), 2)));
    }
}

TEST(Source, tells_the_progress_of_reading_and_of_dequantizing_in_one) {
    double last = 0;
    (void)load(dequantized_source("synthetic:sphere:16x16x16", 3), [&](double part) {
        EXPECT_GE(part, last);
        last = part;
    });
    EXPECT_NEAR(last, 1, 1e-9);
}

TEST(Source, says_that_data_without_levels_have_no_rounding_to_undo) {
    Source source = source_named("synthetic:noise:41x41x41");
    std::get<SyntheticSource>(source.from).type = SampleType::float32;
    source.dequantize = 2;
    const LoadedVolume loaded = load(source);
    ASSERT_EQ(loaded.notes.size(), 1U);
    EXPECT_NE(loaded.notes[0].find("levels"), std::string::npos);
}

TEST(Source, keeps_dequantize_in_its_names) {
    Source source = source_named("head.nrrd");
    EXPECT_FALSE(to_names(source).contains("dequantize"));
    source.dequantize = 60;
    EXPECT_EQ(source_from(to_names(source)).dequantize, 60);
}

TEST(Source, keeps_the_layout_of_a_raw_file_in_its_names) {
    const std::map<std::string, std::string> names{{"volume", "a.raw"},   {"dims", "2x3x4"},
                                                   {"type", "int16"},     {"skip", "5"},
                                                   {"byte-order", "big"}, {"spacing", "1,2,3"}};
    const Source source = source_from(names);
    EXPECT_TRUE(std::get<FileSource>(source.from).raw->big_endian);
    EXPECT_EQ(to_names(source), names);
    EXPECT_THROW(source_from({{"volume", "a.raw"}, {"byte-order", "middle"}}),
                 std::invalid_argument);
    EXPECT_THROW(source_from({{"volume", "synthetic:torus"}, {"byte-order", "big"}}),
                 std::invalid_argument);
}

TEST(Source, is_not_waited_for_when_progress_throws) {
    const support::ScratchFolder folder;
    const std::string path = (folder / "frames.shm").string();
    const io::LiveWriter writer(path, scenes::centred({8, 8, 8}), SampleType::uint8);
    struct Cancelled {};
    const auto cancel = [](double) { throw Cancelled(); };
    EXPECT_THROW((void)load(source_named("live:" + path), cancel), Cancelled);
    for (const std::string name : {"synthetic:noise:512x256x1", "synthetic:beating:512x256x1"}) {
        EXPECT_THROW((void)load(source_named(name), cancel), Cancelled) << name;
    }
}

TEST(Source, is_made_sharpened_and_smoothed_with_progress_that_never_falls) {
    Source source = source_named("synthetic:noise:512x256x8");
    source.smooth = 2;
    source.dequantize = 3;
    source.prefilter = true;
    double last = 0;
    (void)load(source, [&](double part) {
        EXPECT_GE(part, last);
        last = part;
    });
    EXPECT_EQ(last, 1);
}

TEST(Source, refuses_rounds_out_of_range_and_a_live_source) {
    EXPECT_THROW(load(dequantized_source("synthetic:sphere:8x8x8", -1)), std::invalid_argument);
    EXPECT_THROW(load(dequantized_source("synthetic:sphere:8x8x8", 1001)), std::invalid_argument);
    Source live = source_named("live:frames.shm");
    live.dequantize = 1;
    EXPECT_THROW(load(live), std::invalid_argument);
}

TEST(Source, keeps_no_passwords_but_that_there_was_one) {
    const auto names = to_names(
        source_from({{"volume", "https://me:secret@example.org/a.zarr?versionId=3&sig=secret"},
                     {"forbidden-is-missing", "yes"}}));
    EXPECT_EQ(names.at("volume"), "https://example.org/a.zarr?versionId=3");
    EXPECT_EQ(io::address_to_keep("https://h.org/a?sig=b&versionid=4&x=c&Snapshot=5&generation=6"),
              "https://h.org/a?versionid=4&Snapshot=5&generation=6");
    EXPECT_EQ(io::address_to_keep("https://h.org/a?noversionId=secret"), "https://h.org/a");
    EXPECT_EQ(names.at("secrets"), "left out");
    EXPECT_EQ(names.at("forbidden-is-missing"), "yes");
    EXPECT_EQ(to_names(source_from(names)), names);
    EXPECT_FALSE(
        to_names(source_from({{"volume", "https://example.org/a.zarr"}})).contains("secrets"));
    try {
        load(source_from({{"volume", "http://127.0.0.1:9/a.zarr"}, {"secrets", "left out"}}));
        FAIL() << "nothing is there";
    } catch (const io::InputError& e) {
        EXPECT_NE(std::string(e.what()).find("without its password"), std::string::npos)
            << e.what();
    }
}

}  // namespace
}  // namespace palpate::run
