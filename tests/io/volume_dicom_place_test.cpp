// The places of DICOM slices whose headers give them oddly, only in part, or for several bodies.
#include <algorithm>
#include <array>
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

/// Two moments, or stations, of four slices each, the second one `shift` mm further within its
/// plane.
void put_two(const ScratchFolder& folder, double shift) {
    for (int i = 0; i < 8; ++i) {
        TestSlice slice = usual_slice(i);
        slice.acquisition = 1 + i / 4;
        slice.position =
            "10\\" + std::to_string(20 + shift * (i / 4)) + "\\" + std::to_string(2 * (i % 4));
        put_number(folder, slice);
    }
}

TEST(dicom_place, of_stations_side_by_side_is_that_of_two_series_and_no_times) {
    for (const double shift : {-300.0, 0.8}) {
        const ScratchFolder folder;
        put_two(folder, shift);
        const std::string message = refusal(folder.path());
        EXPECT_TRUE(contains(message, "has 2 DICOM series")) << message;
        for (const double station : {0.0, shift}) {
            ReadOptions options;
            options.series = (station == 0) == (shift > 0) ? "1" : "2";
            const VolumeFile file = read_volume(folder.path(), options);
            EXPECT_EQ(file.time_steps, 1);
            EXPECT_EQ(file.volume.geometry().size, Index3(4, 3, 4));
            EXPECT_TRUE(file.volume.geometry().origin.isApprox(Vec3(10, 20 + station, 0)))
                << file.volume.geometry().origin.transpose();
            EXPECT_EQ(file.volume.sample({0, 0, 1}), station == 0 ? 100 : 500);
        }
    }
}

TEST(dicom_place, of_times_less_than_half_a_pixel_apart_is_noted) {
    for (const double shift : {0.1, 0.001}) {
        const ScratchFolder folder;
        put_two(folder, shift);
        const VolumeFile file = read_volume(folder.path());
        EXPECT_EQ(file.time_steps, 2);
        EXPECT_EQ(contains(all_notes(file), "shifted against each other within their plane"),
                  shift == 0.1)
            << all_notes(file);
    }
}

TEST(dicom_place, of_tilted_stations_is_that_of_two_series) {
    const ScratchFolder folder;
    for (int i = 0; i < 8; ++i) {
        TestSlice slice = usual_slice(i);
        const int k = i % 4;
        slice.position =
            "10\\" + std::to_string(20 + k + 300 * (i / 4)) + "\\" + std::to_string(2 * k);
        put_number(folder, slice);
    }
    ReadOptions options;
    options.series = "2";
    const VolumeFile file = read_volume(folder.path(), options);
    EXPECT_EQ(file.volume.geometry().origin.y(), 320);
    EXPECT_TRUE(contains(all_notes(file), "gantry tilt")) << all_notes(file);
}

/// The values of the first of two moments, whose times are these elements of the header.
double first_of(const std::string& earlier, const std::string& later) {
    const ScratchFolder folder;
    for (int i = 0; i < 4; ++i) {
        TestSlice slice = usual_slice(i);
        slice.position = "10\\20\\" + std::to_string(2 * (i % 2));
        // Numbers run against time.
        slice.pixels.assign(12, i < 2 ? std::uint16_t{2} : std::uint16_t{1});
        const std::string data = with(dicom_data_set(slice), 0x8, 0x60, i < 2 ? later : earlier);
        put_bytes(folder / (std::to_string(i) + ".dcm"), file_of(slice, data));
    }
    const VolumeFile file = read_volume(folder.path());
    EXPECT_EQ(file.time_steps, 2);
    return file.volume.sample({0, 0, 0});
}

TEST(dicom_place, of_two_times_has_them_in_the_order_of_utc) {
    const auto whole = [](const char* moment) { return element(0x8, 0x2a, "DT", moment); };
    EXPECT_EQ(first_of(whole("20201025025930+0200"), whole("20201025020010+0100")), 1);
    EXPECT_EQ(first_of(whole("20200501001000+0100"), whole("20200430233000+0000")), 1);
    EXPECT_EQ(first_of(whole("20201025010000-0300"), whole("20201025010000.5-0330")), 1);
    const auto time = [](const char* moment, const char* zone) {
        return element(0x8, 0x22, "DA", "20201025") + element(0x8, 0x32, "TM", moment) +
               (zone ? element(0x8, 0x201, "SH", zone) : std::string());
    };
    EXPECT_EQ(first_of(time("025930", "+0200"), time("020010", "+0100")), 1);
    EXPECT_EQ(first_of(time("93015.5", nullptr), time("101500", nullptr)), 1);
}

/// Two slices at each of four places, with these elements of 0018, which change their order half
/// way, in the files that folder / "N.dcm" are.
void put_in_turn(const ScratchFolder& folder, std::uint16_t group_element,
                 const std::array<const char*, 2>& values) {
    for (int i = 0; i < 8; ++i) {
        TestSlice slice = usual_slice(i);
        const int place = i / 2, which = (i % 2) ^ (place / 2);
        slice.position = "10\\20\\" + std::to_string(2 * place);
        slice.pixels.assign(12, static_cast<std::uint16_t>(1 + which));
        const std::string value =
            element(0x18, group_element, "LO", values[static_cast<std::size_t>(which)]);
        put_bytes(folder / (std::to_string(i) + ".dcm"),
                  file_of(slice, with(dicom_data_set(slice), 0x20, 0xd, value)));
    }
}

void expect_all(const VolumeFile& file, double value) {
    ASSERT_EQ(file.volume.geometry().size, Index3(4, 3, 4));
    EXPECT_EQ(file.volume.minimum(), value);
    EXPECT_EQ(file.volume.maximum(), value);
}

TEST(dicom_place, of_two_inversion_times_or_flip_angles_has_one_in_each_step) {
    for (const std::uint16_t element : {std::uint16_t{0x82}, std::uint16_t{0x1314}}) {
        const ScratchFolder folder;
        put_in_turn(folder, element, {"100", "900"});
        for (int step = 0; step < 2; ++step) {
            ReadOptions options;
            options.time_step = step;
            expect_all(read_volume(folder.path(), options), 1 + step);
        }
    }
}

TEST(dicom_place, of_two_energies_or_kernels_is_that_of_two_series) {
    for (const bool is_kernel : {false, true}) {
        const ScratchFolder folder;
        put_in_turn(folder, is_kernel ? 0x1210 : 0x60, {"100", "140"});
        ReadOptions options;
        for (int series = 1; series <= 2; ++series) {
            options.series = std::to_string(series);
            const VolumeFile file = read_volume(folder.path(), options);
            EXPECT_EQ(file.time_steps, 1);
            expect_all(file, series);
        }
    }
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
