// What the numbers in DICOM files mean, and files that are written in unusual ways: display that is
// inverted, tables of values, lengths of odd types, padding, no preamble, discs with an index.
#include <algorithm>
#include <random>

#include "volume_dicom_changed.hpp"

namespace palpate::io::test {
namespace {

TEST(dicom, inverted_display_leaves_the_values_and_is_said) {
    const ScratchFolder folder;
    const VolumeFile file = read_changed(folder, [](const TestSlice& slice) {
        std::string bytes = dicom_bytes(slice);
        return bytes.replace(bytes.find("MONOCHROME2"), 11, "MONOCHROME1");
    });
    expect_usual(file);
    EXPECT_TRUE(contains(all_notes(file), "MONOCHROME1"));
}

TEST(dicom, a_table_of_values_stands_in_place_of_slope_and_intercept) {
    for (const bool is_signed : {false, true}) {
        for (const int first : {0, 50, is_signed ? -20 : 400}) {
            const ScratchFolder folder;
            const VolumeFile file = read_changed(folder, [&](TestSlice slice) {
                slice.is_signed = is_signed;
                std::string entries;
                for (int i = 0; i < 200; ++i) entries += little<std::uint16_t>(1000 - 3 * i);
                const std::string item =
                    element(0x28, 0x3002, is_signed ? "SS" : "US",
                            little<std::uint16_t>(200) + little<std::int16_t>(first) +
                                little<std::uint16_t>(16)) +
                    element(0x28, 0x3004, "LO", "OD") + long_element(0x28, 0x3006, "OW", entries);
                const std::string items = tag_bytes(0xfffe, 0xe000) +
                                          little(static_cast<std::uint32_t>(item.size())) + item;
                std::string data = dicom_data_set(slice);
                data = without(without(data, 0x28, 0x1052), 0x28, 0x1053);
                return file_of(slice,
                               with(data, 0x7fe0, 0x10, long_element(0x28, 0x3000, "SQ", items)));
            });
            for (int z = 0; z < 4; ++z) {
                const int entry = std::clamp(100 * z + 11 - first, 0, 199);
                EXPECT_EQ(file.volume.sample({3, 2, z}), 1000 - 3 * entry) << first << " " << z;
            }
            EXPECT_EQ(file.values.units, "OD");
            EXPECT_TRUE(contains(all_notes(file), "Modality LUT"));
        }
    }
}

TEST(dicom, lengths_of_another_type_and_one_length_for_both_are_read) {
    const ScratchFolder folder;
    expect_usual(read_changed(folder, [](const TestSlice& slice) {
        std::string data = without(dicom_data_set(slice), 0x28, 0x30);
        return file_of(slice, with(data, 0x28, 0x100, long_element(0x28, 0x30, "UT", "0.5\\0.25")));
    }));
    const VolumeFile one = read_changed(folder, [](TestSlice slice) {
        slice.pixel_spacing = "0.5";
        return dicom_bytes(slice);
    });
    EXPECT_EQ(one.volume.geometry().spacing, Vec3(0.5, 0.5, 2));
    EXPECT_TRUE(contains(all_notes(one), "rows and columns"));
}

TEST(dicom, pixels_of_a_shape_without_a_size_have_this_shape) {
    const ScratchFolder folder;
    const VolumeFile file = read_changed(folder, [](const TestSlice& slice) {
        const std::string data = without(dicom_data_set(slice), 0x28, 0x30);
        return file_of(slice, with(data, 0x28, 0x100, element(0x28, 0x34, "IS", "3\\2")));
    });
    EXPECT_EQ(file.volume.geometry().spacing, Vec3(1, 1.5, 2));
    EXPECT_TRUE(contains(all_notes(file), "1 mm wide and 1.5 mm high")) << all_notes(file);
    // The size counts where there is one.
    expect_usual(read_changed(folder, [](const TestSlice& slice) {
        return file_of(slice,
                       with(dicom_data_set(slice), 0x28, 0x100, element(0x28, 0x34, "IS", "3\\2")));
    }));
}

TEST(dicom, a_slice_that_lacks_the_slope_and_intercept_of_the_others_is_named) {
    const ScratchFolder folder;
    const auto read = [&](const std::string& intercept) {
        return read_changed(folder, [&](TestSlice slice) {
            slice.intercept = intercept;
            const std::string data = dicom_data_set(slice);
            if (slice.number != 2) return file_of(slice, data);
            return file_of(slice, without(without(data, 0x28, 0x1052), 0x28, 0x1053));
        });
    };
    const VolumeFile file = read("-1024");
    EXPECT_EQ(file.volume.sample({0, 0, 1}), -924);
    EXPECT_EQ(file.volume.sample({0, 0, 2}), 200);
    EXPECT_TRUE(contains(all_notes(file), "1 of its 4 slices (the first in '2.dcm') gives no"));
    EXPECT_FALSE(contains(all_notes(read("0")), "of its 4 slices"));
}

TEST(dicom, padding_after_the_last_element_is_passed_over) {
    for (const std::size_t bytes : {1U, 7U, 8U, 512U}) {
        const ScratchFolder folder;
        const VolumeFile file = read_changed(folder, [&](const TestSlice& slice) {
            return dicom_bytes(slice) + std::string(bytes, '\0');
        });
        expect_usual(file);
        EXPECT_TRUE(contains(all_notes(file), "zero bytes after its last element"));
    }
    const ScratchFolder filled;
    const VolumeFile file = read_changed(filled, [&](const TestSlice& slice) {
        return dicom_bytes(slice) + std::string(13, '\xff');
    });
    expect_usual(file);
    EXPECT_TRUE(contains(all_notes(file), "13 bytes of 255 after its last element"));
    const ScratchFolder folder;
    put_bytes(folder / "1.dcm", dicom_bytes(usual_slice(1)) + std::string(64, '\0') + "x");
    EXPECT_TRUE(contains(refusal(folder / "1.dcm"), "damaged"));
    // Elements of no length, in implicit little endian; looked at once, not once for each.
    put_bytes(folder / "1.dcm",
              dicom_start(usual_slice(1), "1.2.840.10008.1.2") + std::string(8 << 20, '\0') + "x");
    EXPECT_TRUE(contains(refusal(folder / "1.dcm"), "cut off"));
}

TEST(dicom, elements_whose_type_is_question_marks_or_zeros_are_read) {
    for (const std::string& type : {std::string("??"), std::string(2, '\0')}) {
        // One, several in a row, a number that is needed, a long length, the samples themselves.
        for (int which = 0; which < 4; ++which) {
            const ScratchFolder folder;
            const VolumeFile file = read_changed(folder, [&](const TestSlice& slice) {
                std::string data = dicom_data_set(slice);
                const auto put = [&](std::uint16_t group, std::uint16_t element) {
                    data.replace(data.find(tag_bytes(group, element)) + 4, 2, type);
                };
                if (which == 0) put(0x20, 0x32);
                if (which == 1) {
                    put(0x28, 0x1052);
                    put(0x28, 0x1053);
                }
                if (which == 2) {
                    data = with(data, 0x20, 0x32,
                                long_element(0x20, 0x31, "UN", std::string(70000, 'x')));
                    put(0x20, 0x31);
                }
                if (which == 3) put(0x7fe0, 0x10);
                return file_of(slice, data);
            });
            SCOPED_TRACE(testing::Message() << which);
            expect_usual(file);
        }
    }
    const ScratchFolder folder;
    std::string data = dicom_data_set(usual_slice(1));
    data.replace(data.find(tag_bytes(0x20, 0x32)) + 4, 4, "??\7\7");
    put_bytes(folder / "1.dcm", file_of(usual_slice(1), data));
    EXPECT_TRUE(contains(refusal(folder / "1.dcm"), "whose length is not sure"));
}

TEST(dicom, overlays_in_unused_bits_are_no_part_of_the_values) {
    const ScratchFolder folder;
    const VolumeFile file = read_changed(folder, [](TestSlice slice) {
        for (int i = 0; i < 12; ++i) {
            slice.pixels.push_back(
                static_cast<std::uint16_t>((100 * slice.number + i) | (i % 3 == 0 ? 0x1000 : 0)));
        }
        std::string data = dicom_data_set(slice);
        const auto set = [&](std::uint16_t which, std::uint16_t value) {
            data.replace(data.find(tag_bytes(0x28, which)) + 8, 2, little(value));
        };
        set(0x101, 12);
        set(0x102, 11);
        const std::string overlay =
            element(0x6000, 0x10, "US", little<std::uint16_t>(3)) +
            element(0x6000, 0x11, "US", little<std::uint16_t>(4)) +
            element(0x6000, 0x40, "CS", "G") +
            element(0x6000, 0x50, "SS", little<std::uint16_t>(1) + little<std::uint16_t>(1)) +
            element(0x6000, 0x100, "US", little<std::uint16_t>(16)) +
            element(0x6000, 0x102, "US", little<std::uint16_t>(12));
        return file_of(slice, with(data, 0x7fe0, 0x10, overlay));
    });
    expect_usual(file);
    EXPECT_TRUE(contains(all_notes(file), "overlays"));
}

TEST(dicom, files_without_preamble_or_meta_information_are_read) {
    const ScratchFolder folder;
    const VolumeFile no_preamble =
        read_changed(folder, [](const TestSlice& slice) { return dicom_bytes(slice).substr(132); });
    expect_usual(no_preamble);
    const VolumeFile only_letters =
        read_changed(folder, [](const TestSlice& slice) { return dicom_bytes(slice).substr(128); });
    expect_usual(only_letters);
    const VolumeFile no_meta =
        read_changed(folder, [](const TestSlice& slice) { return dicom_data_set(slice); });
    expect_usual(no_meta);
    EXPECT_TRUE(contains(all_notes(no_meta), "transfer syntax"));
}

TEST(dicom, a_number_with_a_comma_is_refused_with_its_slice_and_tag) {
    for (const auto& [change, tag] :
         std::initializer_list<std::pair<void (*)(TestSlice&), const char*>>{
             {[](TestSlice& s) { s.position = "1,5\\0\\0"; }, "(0020,0032)"},
             {[](TestSlice& s) { s.pixel_spacing = "0,5\\0,5"; }, "(0028,0030)"},
             {[](TestSlice& s) { s.pixel_spacing = "0.5,0.5"; }, "(0028,0030)"},
             {[](TestSlice& s) { s.slope = "0,5"; }, "(0028,1053)"},
             {[](TestSlice& s) { s.intercept = "-1024,5"; }, "(0028,1052)"},
             {[](TestSlice& s) { s.slope = "1\\2"; }, "RescaleSlope has 2 numbers"},
             {[](TestSlice& s) { s.intercept = "0\\5"; }, "RescaleIntercept has 2 numbers"}}) {
        const ScratchFolder folder;
        for (int i = 0; i < 3; ++i) {
            TestSlice slice = usual_slice(i);
            if (i == 1) change(slice);
            put_slice(folder / (std::to_string(i) + ".dcm"), slice);
        }
        const std::string message = refusal(folder.path());
        EXPECT_TRUE(contains(message, tag)) << message;
        EXPECT_TRUE(contains(message, "'1.dcm'")) << message;
    }
}

TEST(dicom_folder, a_disc_with_an_index_has_its_slices_in_folders_of_folders) {
    const ScratchFolder folder;
    std::filesystem::create_directories(folder / "DICOM/PAT1/SER1");
    for (int i = 0; i < 4; ++i) {
        put_slice(folder / ("DICOM/PAT1/SER1/IM" + std::to_string(i)), usual_slice(i));
    }
    TestSlice index;
    index.kind = "1.2.840.10008.1.3.10";
    put_bytes(folder / "DICOMDIR", dicom_start(index, "1.2.840.10008.1.2.1"));
    put_bytes(folder / "README.TXT", "a disc");
    expect_usual(read_volume(folder.path()));
}

/// A disc of four slices, without its index.
void put_disc(const std::filesystem::path& folder) {
    std::filesystem::create_directories(folder / "DICOM/PAT1");
    for (int i = 0; i < 4; ++i) {
        put_slice(folder / ("DICOM/PAT1/IM" + std::to_string(i)), usual_slice(i));
    }
}

/// The index of this disc. Some programs give its list no length.
std::string index_of_disc(bool has_length) {
    TestSlice index;
    index.kind = "1.2.840.10008.1.3.10";
    std::string records;
    for (int i = 0; i < 4; ++i) {
        const std::string icon = tag_bytes(0x0088, 0x0200) +
                                 std::string("SQ\0\0\xff\xff\xff\xff", 8) +
                                 item_of(element(0x0028, 0x0004, "CS", "MONOCHROME2")) +
                                 tag_bytes(0xfffe, 0xe0dd) + little(0U);
        records += item_of(element(0x0004, 0x1430, "CS", "IMAGE") +
                           element(0x0004, 0x1500, "CS", "DICOM\\PAT1\\IM" + std::to_string(i)) +
                           (has_length ? "" : icon));
    }
    const std::string start =
        dicom_start(index, "1.2.840.10008.1.2.1") + element(0x0004, 0x1130, "CS", "DISC");
    if (has_length) return start + long_element(0x0004, 0x1220, "SQ", records);
    return start + tag_bytes(0x0004, 0x1220) + std::string("SQ\0\0\xff\xff\xff\xff", 8) + records +
           tag_bytes(0xfffe, 0xe0dd) + little(0U);
}

TEST(dicom_folder, a_damaged_index_does_not_keep_the_slices_from_being_read) {
    const ScratchFolder folder;
    put_disc(folder.path());
    const auto notes_with = [&](const std::string& index) {
        put_bytes(folder / "DICOMDIR", index);
        const VolumeFile file = read_volume(folder.path());
        expect_usual(file);
        return all_notes(file);
    };
    for (const bool has_length : {false, true}) {
        const std::string whole = index_of_disc(has_length);
        EXPECT_FALSE(contains(notes_with(whole), "index"));
        for (std::size_t length = 0; length < whole.size(); length += 41) {
            EXPECT_TRUE(
                contains(notes_with(whole.substr(0, length)), "its index could not be read"))
                << length;
        }
        EXPECT_TRUE(contains(notes_with(whole.substr(0, whole.size() - 20)), "is cut off"));
        std::string wrong = whole;
        wrong[whole.find("IMAGE") - 1] = '\x7f';  // the upper half of a length
        EXPECT_TRUE(contains(notes_with(wrong), "its index could not be read"));
    }
    EXPECT_TRUE(contains(notes_with("a list of files"), "'DICOMDIR' is no DICOM file"));
}

/// An index of the four slices, and of a record with these elements.
std::string index_with(const std::string& elements) {
    const std::string whole = index_of_disc(true);
    const std::size_t start = whole.find(tag_bytes(0x0004, 0x1220));
    return whole.substr(0, start) +
           long_element(0x0004, 0x1220, "SQ", whole.substr(start + 12) + item_of(elements));
}

TEST(dicom_folder, an_index_names_its_images_outside_of_sequences_and_in_use) {
    const ScratchFolder folder;
    put_disc(folder.path());
    const auto says_missing = [&](const std::string& elements) {
        put_bytes(folder / "DICOMDIR", index_with(elements));
        const VolumeFile file = read_volume(folder.path());
        expect_usual(file);
        EXPECT_FALSE(contains(all_notes(file), "could not be read")) << all_notes(file);
        return contains(all_notes(file), "lists 1 images that are not in the folder");
    };
    const auto record = [](const std::string& kind, const std::string& name) {
        return element(0x0004, 0x1430, "CS", kind) + element(0x0004, 0x1500, "CS", name);
    };
    const std::string lost = "DICOM\\PAT1\\LOST", there = "DICOM\\PAT1\\IM0";
    const auto in_use = [](int flag) {
        return element(0x0004, 0x1410, "US", little(static_cast<std::uint16_t>(flag)));
    };
    const auto sequence = [&](const std::string& elements) {  // without a length
        return tag_bytes(0x0088, 0x0200) + std::string("SQ\0\0\xff\xff\xff\xff", 8) +
               item_of(elements) + tag_bytes(0xfffe, 0xe0dd) + little(0U);
    };
    EXPECT_TRUE(says_missing(record("IMAGE", lost)));
    EXPECT_TRUE(says_missing(in_use(0xffff) + record("IMAGE", lost)));
    EXPECT_TRUE(says_missing(element(0x0004, 0x1410, "US", "") + record("IMAGE", lost)));
    EXPECT_FALSE(says_missing(in_use(0) + record("IMAGE", lost)));
    EXPECT_FALSE(says_missing(record("PRIVATE", lost)));
    EXPECT_FALSE(says_missing(record("IMAGE", there) + sequence(record("IMAGE", lost))));
    EXPECT_FALSE(says_missing(record("PRIVATE", lost) + sequence(record("IMAGE", lost))));
    EXPECT_TRUE(says_missing(record("IMAGE", lost) + sequence(in_use(0) + record("", there))));
}

TEST(dicom_folder, any_byte_of_an_index_may_be_wrong) {
    const ScratchFolder folder;
    put_disc(folder.path());
    std::mt19937 random(7);
    for (int i = 0; i < 30; ++i) {
        std::string index = index_of_disc(i % 2 == 0);
        index[random() % index.size()] = static_cast<char>(random());
        put_bytes(folder / "DICOMDIR", index);
        expect_usual(read_volume(folder.path()));
    }
}

}  // namespace
}  // namespace palpate::io::test
