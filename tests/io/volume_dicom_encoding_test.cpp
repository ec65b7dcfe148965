// DICOM files whose bytes are not quite as the standard has them, which other readers accept.
#include <algorithm>

#include "volume_dicom_changed.hpp"

namespace palpate::io::test {
namespace {

const char* const without_types = "1.2.840.10008.1.2";

/// What stands before the data set, in three parts: preamble and letters, group 2.
std::string start_without_types(const TestSlice& slice) {
    const std::string start = dicom_start(slice, without_types);
    return start.substr(0, 132) + implicit_of(start.substr(132));
}

TEST(dicom_encoding, without_types_has_numbers_of_the_width_that_the_dictionary_says) {
    const ScratchFolder folder;
    TestSlice slice = usual_slice(1);
    slice.pixels = {0, 1, 1, 0, 0, 1, 0, 1, 1, 1, 0, 2};
    // Two entries of 16 bits have the length of one of 32.
    const std::string table =
        element(0x28, 0x3002, "US",
                little<std::uint16_t>(2) + little<std::uint16_t>(0) + little<std::uint16_t>(16)) +
        long_element(0x28, 0x3006, "OW", little<std::uint16_t>(100) + little<std::uint16_t>(200));
    const std::string data =
        with(dicom_data_set(slice), 0x7fe0, 0x10, long_element(0x28, 0x3000, "SQ", item_of(table)));
    put_bytes(folder / "1.dcm", dicom_start(slice, without_types) + implicit_of(data));
    const VolumeFile file = read_volume(folder / "1.dcm");
    EXPECT_EQ(file.volume.sample({0, 0, 0}), 100);
    EXPECT_EQ(file.volume.sample({1, 0, 0}), 200);
    EXPECT_EQ(file.volume.sample({3, 2, 0}), 200);
}

TEST(dicom_encoding, of_a_slice_vector_without_types_is_read) {
    const ScratchFolder folder;
    TestSlice slice = usual_slice(1);
    slice.frames = 2;
    std::string data =
        with(dicom_data_set(slice), 0x28, 0x10, element(0x28, 9, "AT", tag_bytes(0x54, 0x80)));
    data = with(data, 0x7fe0, 0x10,
                element(0x54, 0x80, "US", little<std::uint16_t>(2) + little<std::uint16_t>(1)));
    put_bytes(folder / "1.dcm", dicom_start(slice, without_types) + implicit_of(data));
    const VolumeFile file = read_volume(folder / "1.dcm");
    ASSERT_EQ(file.volume.geometry().size, Index3(4, 3, 2));
    EXPECT_EQ(file.volume.sample({0, 0, 0}), 112);
    EXPECT_EQ(file.volume.sample({0, 0, 1}), 100);
}

TEST(dicom_encoding, of_table_entries_in_bytes_is_read) {
    for (const bool in_words : {false, true}) {
        const ScratchFolder folder;
        TestSlice slice = usual_slice(1);
        for (int i = 0; i < 12; ++i) slice.pixels.push_back(static_cast<std::uint16_t>(i));
        std::string entries;
        for (int i = 0; i < 12; ++i) {
            entries += static_cast<char>(200 - i);
            if (in_words) entries += '\0';
        }
        const std::string table =
            element(0x28, 0x3002, "US",
                    little<std::uint16_t>(12) + std::string(2, '\0') + little<std::uint16_t>(8)) +
            long_element(0x28, 0x3006, "OW", entries);
        put_bytes(folder / "1.dcm",
                  file_of(slice, with(dicom_data_set(slice), 0x7fe0, 0x10,
                                      long_element(0x28, 0x3000, "SQ", item_of(table)))));
        const VolumeFile file = read_volume(folder / "1.dcm");
        EXPECT_EQ(file.volume.sample({1, 0, 0}), 199);
        EXPECT_EQ(file.volume.sample({3, 2, 0}), 189);
    }
}

TEST(dicom_encoding, of_the_meta_information_without_types_is_read) {
    const ScratchFolder folder;
    expect_usual(read_changed(folder, [](const TestSlice& slice) {
        return start_without_types(slice) + implicit_of(dicom_data_set(slice));
    }));
}

TEST(dicom_encoding, with_types_that_the_transfer_syntax_denies_is_read_and_said) {
    const ScratchFolder folder;
    const VolumeFile file = read_changed(folder, [](const TestSlice& slice) {
        return dicom_start(slice, without_types) + dicom_data_set(slice);
    });
    expect_usual(file);
    EXPECT_TRUE(contains(all_notes(file), "no types, and they have")) << all_notes(file);
}

TEST(dicom_encoding, with_a_line_end_at_the_end_is_read_and_other_rests_are_damage) {
    const ScratchFolder folder;
    const VolumeFile file =
        read_changed(folder, [](const TestSlice& slice) { return dicom_bytes(slice) + "\r\n"; });
    expect_usual(file);
    EXPECT_TRUE(contains(all_notes(file), "line end after its last element"));
    put_bytes(folder / "1.dcm", dicom_bytes(usual_slice(1)) + "\r\nx");
    EXPECT_TRUE(contains(refusal(folder / "1.dcm"), "is cut off"));
}

TEST(dicom_encoding, of_more_samples_than_declared_is_read_if_the_rest_is_zeros) {
    const auto with_rest = [](const TestSlice& slice, const std::string& rest) {
        std::string data = dicom_data_set(slice);
        data.resize(data.find(tag_bytes(0x7fe0, 0x10)));
        return file_of(slice, data + long_element(0x7fe0, 0x10, "OW", pixel_bytes(slice) + rest));
    };
    const ScratchFolder folder;
    const VolumeFile file = read_changed(folder, [&](const TestSlice& slice) {
        return with_rest(slice, std::string(16, '\0'));  // two rows
    });
    expect_usual(file);
    EXPECT_TRUE(contains(all_notes(file), "16 bytes more of samples")) << all_notes(file);
    for (const std::string& rest : {std::string(24, '\0'), std::string(15, '\0') + "x"}) {
        put_bytes(folder / "1.dcm", with_rest(usual_slice(1), rest));
        EXPECT_TRUE(contains(refusal(folder / "1.dcm"), "its header asks for 24"));
    }
    TestSlice frames =
        usual_slice(1);  // where another number of rows moves every frame but the first
    frames.frames = 3;
    put_bytes(folder / "1.dcm", with_rest(frames, std::string(16, '\0')));
    EXPECT_TRUE(contains(refusal(folder / "1.dcm"), "its header asks for 72"));
}

/// A slice with its samples in fragments (RLE, PS3.5 annex G), and what stands behind these.
std::string in_fragments(const TestSlice& slice, const std::string& behind, bool is_whole = true) {
    const std::string samples = pixel_bytes(slice);
    std::string high, low;
    for (std::size_t i = 0; i < samples.size(); i += 2) {
        low += samples[i];
        high += samples[i + 1];
    }
    const auto run = static_cast<char>(low.size() - 1);  // so many bytes as they are
    std::string frame = little<std::uint32_t>(2) + little<std::uint32_t>(64) +
                        little<std::uint32_t>(static_cast<std::uint32_t>(65 + high.size()));
    frame.resize(64, '\0');
    frame += run + high + run + low;
    if (frame.size() % 2 == 1) frame += '\0';
    std::string data = dicom_data_set(slice);
    data.resize(data.find(tag_bytes(0x7fe0, 0x10)));
    const std::string last = item_of(frame);
    return dicom_start(slice, "1.2.840.10008.1.2.5") + data + tag_bytes(0x7fe0, 0x10) + "OB" +
           std::string(2, '\0') + std::string(4, '\xff') + item_of("") +
           last.substr(0, last.size() - (is_whole ? 0 : 4)) + behind;
}

TEST(dicom_encoding, of_fragments_without_an_end_or_with_an_empty_last_one_is_read) {
    const std::string end = tag_bytes(0xfffe, 0xe0dd) + std::string(4, '\0');
    for (const std::string& behind : {end, std::string(), item_of("") + end}) {
        const ScratchFolder folder;
        const VolumeFile file = read_changed(
            folder, [&](const TestSlice& slice) { return in_fragments(slice, behind); });
        expect_usual(file);
        EXPECT_EQ(contains(all_notes(file), "lacks the mark behind its samples"), behind.empty());
    }
    const ScratchFolder folder;
    put_bytes(folder / "1.dcm", in_fragments(usual_slice(1), "", false));
    EXPECT_TRUE(contains(refusal(folder / "1.dcm"), "cut off"));
    TestSlice two = usual_slice(1);  // of which the second frame is not there
    two.frames = 2;
    std::string bytes = in_fragments(usual_slice(1), "");
    bytes = bytes.insert(bytes.find(tag_bytes(0x28, 0x10)), element(0x28, 8, "IS", "2"));
    put_bytes(folder / "1.dcm", bytes);
    EXPECT_TRUE(contains(refusal(folder / "1.dcm"), "has 1 compressed images"));
}

TEST(dicom_encoding, of_colours_that_two_pixels_share_is_refused_as_colours) {
    const ScratchFolder folder;
    TestSlice slice = usual_slice(1);
    slice.samples_per_pixel = 3;
    std::string data = dicom_data_set(slice);
    data.resize(data.find(tag_bytes(0x7fe0, 0x10)));
    data = with(without(data, 0x28, 4), 0x28, 6, element(0x28, 4, "CS", "YBR_FULL_422"));
    const std::size_t bytes = 4 * 3 * 2 * 2;
    put_bytes(folder / "1.dcm",
              file_of(slice, data + long_element(0x7fe0, 0x10, "OW", std::string(bytes, 'x'))));
    EXPECT_TRUE(contains(refusal(folder / "1.dcm"), "has colours")) << refusal(folder / "1.dcm");
}

}  // namespace
}  // namespace palpate::io::test
