// The places of DICOM slices whose headers give them oddly, only in part, or for several bodies.
#include <algorithm>
#include <cmath>

#include "volume_dicom_changed.hpp"

namespace palpate::io::test {
namespace {

void put_number(const ScratchFolder& folder, const TestSlice& slice) {
    put_slice(folder / (std::to_string(slice.number) + ".dcm"), slice);
}

TEST(dicom_place, by_slice_location_has_no_orientation_because_its_sign_is_open) {
    for (const bool has_position : {true, false}) {
        const ScratchFolder folder;
        for (int i = 0; i < 4; ++i) {
            TestSlice slice = usual_slice(i);
            slice.location = std::to_string(40 - 3 * i);
            slice.position = "0\\-40\\50";
            std::string data = dicom_data_set(slice);
            if (!has_position) data = without(data, 0x20, 0x32);
            put_bytes(folder / (std::to_string(i) + ".dcm"), file_of(slice, data));
        }
        const VolumeFile file = read_volume(folder.path());
        EXPECT_EQ(file.volume.geometry().spacing[2], 3);
        EXPECT_FALSE(file.volume.geometry().oriented);
        EXPECT_TRUE(contains(all_notes(file), "placed by their SliceLocation"));
        EXPECT_TRUE(contains(all_notes(file), "may be mirrored")) << all_notes(file);
    }
}

TEST(dicom_place, with_zero_bytes_around_each_number_is_read) {
    const ScratchFolder folder;
    const std::string zero(1, '\0');
    for (int i = 0; i < 4; ++i) {
        TestSlice slice = usual_slice(i);
        slice.position = "10" + zero + "\\20 " + zero + "\\" + std::to_string(2 * i);
        slice.orientation = "1" + zero + "\\0\\0\\0\\1\\0" + zero;
        slice.pixel_spacing = "0.5" + zero + "\\0.25" + zero;
        put_number(folder, slice);
    }
    const VolumeFile file = read_volume(folder.path());
    expect_usual(file);
    EXPECT_TRUE(file.volume.geometry().oriented);
    EXPECT_EQ(all_notes(file), "");
}

TEST(dicom_place, of_another_count_of_numbers_is_refused) {
    for (const char* position : {"10\\20", "10\\20\\\\", "10\\20\\30\\40"}) {
        const ScratchFolder folder;
        TestSlice slice = usual_slice(1);
        slice.position = position;
        put_number(folder, slice);
        const std::string message = refusal(folder / "1.dcm");
        EXPECT_TRUE(contains(message, "ImagePositionPatient has ")) << message;
        EXPECT_TRUE(contains(message, "numbers instead of 3")) << message;
    }
    const ScratchFolder folder;
    TestSlice slice = usual_slice(1);
    slice.orientation = "1\\0\\0";
    put_number(folder, slice);
    EXPECT_TRUE(contains(refusal(folder / "1.dcm"), "ImageOrientationPatient has 3 numbers"));
}

TEST(dicom_place, of_several_bodies_under_one_series_is_that_of_several_series) {
    struct Whose {
        std::uint16_t group, element;
        const char *vr, *name;
    };
    for (const auto& [group, tag, vr, name] :
         {Whose{0x10, 0x20, "LO", "patient 7.1"}, Whose{0x20, 0xd, "UI", "study 7.1"},
          Whose{0x20, 0x52, "UI", "frame of reference 7.1"}}) {
        const ScratchFolder folder;
        for (int i = 0; i < 6; ++i) {
            const TestSlice slice = usual_slice(i);
            std::string data = dicom_data_set(slice);
            if (group == 0x20 && tag == 0xd) data = without(data, group, tag);
            const std::string own = element(group, tag, vr, i < 3 ? "7.1 " : "7.20");
            // Elements are in order.
            data = tag == 0x52   ? with(data, 0x28, 2, own)
                   : tag == 0x20 ? with(data, 0x18, 0x50, own)
                                 : with(data, 0x20, 0xe, own);
            put_bytes(folder / (std::to_string(i) + ".dcm"), file_of(slice, data));
        }
        const std::vector<SeriesInfo> all = choice_in(folder.path());
        ASSERT_EQ(all.size(), 2U) << name;
        EXPECT_EQ(all[0].slices, 3);
        EXPECT_TRUE(contains(all[0].description, name)) << all[0].description;
        ReadOptions second;
        second.series = "2";
        const VolumeFile file = read_volume(folder.path(), second);
        EXPECT_EQ(file.volume.geometry().size[2], 3);
        EXPECT_EQ(file.volume.geometry().origin[2], 6);
    }
}

TEST(dicom_place, is_kept_where_an_anonymiser_gave_each_file_a_frame_of_reference) {
    const ScratchFolder folder;
    for (int i = 0; i < 6; ++i) {
        const TestSlice slice = usual_slice(i);
        const std::string own = element(0x20, 0x52, "UI", "7." + std::to_string(10 + i));
        put_bytes(folder / (std::to_string(i) + ".dcm"),
                  file_of(slice, with(dicom_data_set(slice), 0x28, 2, own)));
    }
    EXPECT_EQ(read_volume(folder.path()).volume.geometry().size[2], 6);
}

TEST(dicom_place, is_kept_where_small_differences_of_distances_add_up) {
    const ScratchFolder folder;
    std::vector<double> heights;
    for (int i = 0; i < 61; ++i) heights.push_back(i <= 30 ? i : 30 + 1.019 * (i - 30));
    for (int i = 0; i < 61; ++i) {
        TestSlice slice = usual_slice(i);
        const double z = heights[static_cast<std::size_t>(i)];
        slice.position = "10\\20\\" + std::to_string(z);
        slice.pixels.assign(12, static_cast<std::uint16_t>(std::lround(1000 * z)));
        put_number(folder, slice);
    }
    const VolumeFile file = read_volume(folder.path());
    const Geometry& g = file.volume.geometry();
    EXPECT_TRUE(contains(all_notes(file), "not evenly spaced")) << all_notes(file);
    for (int z = 0; z < g.size[2]; ++z) {
        EXPECT_NEAR(file.volume.sample({0, 0, z}), 1000 * z * g.spacing[2], 25) << z;
    }
}

TEST(dicom_place, of_slices_a_tenth_uneven_is_interpolated_and_none_counts_as_missing) {
    const ScratchFolder folder;
    const double heights[] = {0, 1, 2.07, 3, 4.06, 5};
    for (int i = 0; i < 6; ++i) {
        TestSlice slice = usual_slice(i);
        slice.position = "10\\20\\" + std::to_string(heights[i]);
        put_number(folder, slice);
    }
    const std::string notes = all_notes(read_volume(folder.path()));
    EXPECT_TRUE(contains(notes, "not evenly spaced")) << notes;
    EXPECT_FALSE(contains(notes, "missing")) << notes;
}

TEST(dicom_place, that_a_slice_lacks_among_others_is_asked_for) {
    const ScratchFolder folder;
    for (int i = 0; i < 4; ++i) {
        TestSlice slice = usual_slice(i);
        put_bytes(folder / (std::to_string(i) + ".dcm"),
                  file_of(slice, i == 2 ? without(dicom_data_set(slice), 0x20, 0x32)
                                        : dicom_data_set(slice)));
    }
    const std::string message = refusal(folder.path());
    EXPECT_TRUE(contains(message, "no place, the first in '2.dcm'")) << message;
}

TEST(dicom_place, of_two_acquisitions_nearly_at_one_place_is_no_stack) {
    const ScratchFolder folder;
    for (int i = 0; i < 6; ++i) {
        TestSlice slice = usual_slice(i);
        slice.position = "10\\20\\" + std::to_string(2 * (i / 2) + 0.06 * (i % 2));
        put_number(folder, slice);
    }
    const std::string message = refusal(folder.path());
    EXPECT_TRUE(contains(message, "0.06 to 1.94 mm, which is no stack")) << message;
    EXPECT_TRUE(contains(message, "acquisitions are mixed")) << message;
}

}  // namespace
}  // namespace palpate::io::test
