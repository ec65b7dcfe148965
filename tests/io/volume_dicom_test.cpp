// DICOM: slices in their place, the right series, and everything irregular said.
#include <algorithm>
#include <cmath>

#include "volume_dicom_slice.hpp"

namespace palpate::io::test {
namespace {

std::string three(double x, double y, double z) {
    char text[64];
    std::snprintf(text, sizeof text, "%.6g\\%.6g\\%.6g", x, y, z);
    return text;
}

/// A slice at height z; its samples are number * 100 + index.
TestSlice slice_at(int number, double z) {
    TestSlice slice;
    slice.number = number;
    slice.position = three(10, 20, z);
    return slice;
}

std::string name_of_slice(int number) {
    return std::to_string(number) + ".dcm";
}

TEST(dicom, slices_are_sorted_by_position_and_placed) {
    const ScratchFolder folder;
    const int order[] = {4, 2, 5, 1, 3};  // names say nothing, numbers run against positions
    for (int i = 0; i < 5; ++i) {
        put_slice(folder / name_of_slice(order[i]), slice_at(10 - i, -30 + 2.5 * i));
    }
    const VolumeFile file = read_volume(folder.path());
    const Geometry& g = file.volume.geometry();
    EXPECT_EQ(file.format, "DICOM series");
    EXPECT_EQ(g.size, Index3(4, 3, 5));
    EXPECT_EQ(g.spacing, Vec3(0.25, 0.5, 2.5));
    EXPECT_EQ(g.origin, Vec3(10, 20, -30));
    EXPECT_EQ(g.direction, Mat3(Mat3::Identity()));
    EXPECT_EQ(file.volume.type(), SampleType::uint16);
    for (int z = 0; z < 5; ++z) {
        EXPECT_EQ(file.volume.sample({0, 0, z}), 100 * (10 - z));
        EXPECT_EQ(file.volume.sample({3, 2, z}), 100 * (10 - z) + 11);
    }
    EXPECT_EQ(file.notes, std::vector<std::string>{});
}

TEST(dicom, oblique_slices_keep_their_directions) {
    const ScratchFolder folder;
    const double c = std::cos(0.4), s = std::sin(0.4);
    for (int i = 0; i < 4; ++i) {
        TestSlice slice = slice_at(i, 0);
        slice.orientation = three(c, s, 0) + "\\" + three(0, 0, -1);
        slice.position = three(-s * 3 * i, c * 3 * i, 7);
        put_slice(folder / name_of_slice(i), slice);
    }
    const Geometry g = read_volume(folder.path()).volume.geometry();
    Mat3 expected;
    expected << c, 0, -s, s, 0, c, 0, -1, 0;
    EXPECT_LT((g.direction - expected).cwiseAbs().maxCoeff(), 2e-6);
    EXPECT_NEAR(g.spacing[2], 3, 1e-5);
}

TEST(dicom, hounsfield_units_are_int16_and_others_become_float_with_a_word) {
    const ScratchFolder folder;
    const auto read_with = [&](const std::string& slope, const std::string& intercept,
                               bool is_signed) {
        TestSlice slice = slice_at(1, 0);
        slice.slope = slope;
        slice.intercept = intercept;
        slice.is_signed = is_signed;
        put_slice(folder / "1.dcm", slice);
        return read_volume(folder / "1.dcm");
    };
    for (const bool is_signed : {false, true}) {
        const VolumeFile hounsfield = read_with("1", "-1024", is_signed);
        EXPECT_EQ(hounsfield.volume.type(), SampleType::int16);
        EXPECT_EQ(hounsfield.volume.minimum(), 100 - 1024);
        EXPECT_EQ(hounsfield.volume.maximum(), 111 - 1024);
        EXPECT_EQ(hounsfield.notes, std::vector<std::string>{});
    }
    const VolumeFile fraction = read_with("0.5", "0.25", false);
    EXPECT_EQ(fraction.volume.type(), SampleType::float32);
    EXPECT_EQ(fraction.volume.minimum(), 50.25);
    EXPECT_TRUE(contains(all_notes(fraction), "slope"));
    const VolumeFile large = read_with("1000", "-1024", false);
    EXPECT_EQ(large.volume.type(), SampleType::float32);
    EXPECT_EQ(large.volume.maximum(), 111000 - 1024);
}

TEST(dicom, one_file_is_a_volume_of_one_slice) {
    const ScratchFolder folder;
    put_slice(folder / "no-extension", slice_at(1, 5));
    const VolumeFile file = read_volume(folder / "no-extension");
    EXPECT_EQ(file.volume.geometry().size, Index3(4, 3, 1));
    EXPECT_EQ(file.volume.geometry().spacing, Vec3(0.25, 0.5, 2.5));  // the slice's thickness
    EXPECT_EQ(file.volume.geometry().origin, Vec3(10, 20, 5));
}

TEST(dicom, several_series_are_listed_and_one_is_chosen_by_number_or_uid) {
    const ScratchFolder folder;
    for (int i = 0; i < 7; ++i) {
        TestSlice slice = slice_at(i, i);
        slice.series = i < 3 ? "1.2.3.1" : "1.2.3.2";
        slice.description = i < 3 ? "HEAD" : "CHEST";
        put_slice(folder / name_of_slice(i), slice);
    }
    const std::string message = refusal(folder.path());
    EXPECT_TRUE(one_line_about(message, folder.path())) << message;
    EXPECT_TRUE(contains(message, "has 2 DICOM series; choose one by its number")) << message;
    const std::vector<SeriesInfo> all = choice_in(folder.path());
    ASSERT_EQ(all.size(), 2U);
    EXPECT_EQ(text_of(all[0]), "3 slices of 4x3  CT 'HEAD'  0.25 x 0.5 x 1 mm  1.2.3.1");
    EXPECT_EQ(text_of(all[1]), "4 slices of 4x3  CT 'CHEST'  0.25 x 0.5 x 1 mm  1.2.3.2");
    EXPECT_TRUE(all[0].picture.grey.empty());
    const auto slices_of = [&](const std::string& series) {
        ReadOptions options;
        options.series = series;
        return read_volume(folder.path(), options).volume.geometry().size[2];
    };
    EXPECT_EQ(slices_of("1"), 3);
    EXPECT_EQ(slices_of("2"), 4);
    EXPECT_EQ(slices_of("1.2.3.2"), 4);
    ReadOptions options;
    options.series = "7";
    EXPECT_TRUE(contains(refusal(folder.path(), options), "has no DICOM series '7'"));
}

TEST(dicom, series_to_choose_from_have_pictures_if_asked_for) {
    const ScratchFolder folder;
    for (int i = 0; i < 6; ++i) {
        TestSlice slice = slice_at(i, i);
        slice.series = i < 5 ? "1.2.3.1" : "1.2.3.2";
        slice.columns = 150;
        slice.rows = 100;
        for (int k = 0; k < 150 * 100; ++k) {
            slice.pixels.push_back(i == 2 ? static_cast<std::uint16_t>(100 * (k % 150)) : 5);
        }
        put_slice(folder / name_of_slice(i), slice);
    }
    ReadOptions options;
    options.series_pictures = true;
    const std::vector<SeriesInfo> all = choice_in(folder.path(), options);
    ASSERT_EQ(all.size(), 2U);
    const Thumbnail& picture = all[0].picture;  // of the third of five
    EXPECT_EQ(picture.width, 50);
    EXPECT_EQ(picture.height, 33);
    ASSERT_EQ(picture.grey.size(), 50U * 33U);
    for (const int x : {0, 10, 49}) EXPECT_NEAR(picture.grey[x], 255.0 * 3 * x / 149, 1) << x;
    EXPECT_EQ(all[1].picture.grey, std::vector<std::uint8_t>(50 * 33, 0));  // all the same
}

TEST(dicom, a_scout_image_in_the_series_is_a_series_of_its_own) {
    const ScratchFolder folder;
    for (int i = 0; i < 4; ++i) put_slice(folder / name_of_slice(i), slice_at(i, i));
    TestSlice scout = slice_at(9, 0);
    scout.orientation = "1\\0\\0\\0\\0\\-1";
    put_slice(folder / "scout.dcm", scout);
    EXPECT_TRUE(contains(refusal(folder.path()), "has 2 DICOM series"));
}

TEST(dicom, a_missing_slice_is_filled_in_place_and_said) {
    const ScratchFolder folder;
    for (const int i : {0, 1, 2, 5, 6, 7})
        put_slice(folder / name_of_slice(i), slice_at(i, 2.0 * i));
    const VolumeFile file = read_volume(folder.path());
    EXPECT_EQ(file.volume.geometry().size[2], 8);
    EXPECT_EQ(file.volume.geometry().spacing[2], 2);
    EXPECT_TRUE(contains(all_notes(file), "2 of 8 slices are missing")) << all_notes(file);
    for (int z = 0; z < 8; ++z) EXPECT_EQ(file.volume.sample({1, 2, z}), 100 * z + 9);
}

TEST(dicom, uneven_slices_are_interpolated_in_place_and_said) {
    const ScratchFolder folder;
    const double heights[] = {0, 1, 2.4, 3, 4.3, 5};
    for (int i = 0; i < 6; ++i) {
        TestSlice slice = slice_at(i, heights[i]);
        slice.pixels.assign(12, static_cast<std::uint16_t>(std::lround(1000 * heights[i])));
        put_slice(folder / name_of_slice(i), slice);
    }
    const VolumeFile file = read_volume(folder.path());
    const Geometry& g = file.volume.geometry();
    EXPECT_TRUE(contains(all_notes(file), "not evenly spaced")) << all_notes(file);
    for (int z = 0; z < g.size[2]; ++z) {  // the samples are a linear ramp: exact but for rounding
        EXPECT_NEAR(file.volume.sample({0, 0, z}), 1000 * z * g.spacing[2], 0.51);
    }
    EXPECT_NEAR((g.size[2] - 1) * g.spacing[2], 5, 1e-9);
}

TEST(dicom, slices_spread_beyond_sense_are_refused) {
    const ScratchFolder folder;
    const double heights[] = {0, 1, 2, 500};
    for (int i = 0; i < 4; ++i) put_slice(folder / name_of_slice(i), slice_at(i, heights[i]));
    EXPECT_TRUE(contains(refusal(folder.path()), "1 to 498 mm, which is no stack"));
}

TEST(dicom, gantry_tilt_is_straightened_and_said) {
    // A body that is a function of physical space, sampled by slices that shift along y: after
    // reading, every sample must be that function at its own place.
    const ScratchFolder folder;
    const auto body = [](const Vec3& p) { return 20000 + 300 * p[0] + 100 * p[1] + 50 * p[2]; };
    const double shift = 0.8;  // [mm] a slice, 2 mm apart: 21.8 degrees
    for (int i = 0; i < 6; ++i) {
        TestSlice slice = slice_at(i, 2.0 * i);
        slice.columns = 8;
        slice.rows = 12;
        slice.position = three(10, 20 + shift * i, 2.0 * i);
        for (int y = 0; y < 12; ++y) {
            for (int x = 0; x < 8; ++x) {
                const Vec3 p(10 + 0.25 * x, 20 + shift * i + 0.5 * y, 2.0 * i);
                slice.pixels.push_back(static_cast<std::uint16_t>(std::lround(body(p))));
            }
        }
        put_slice(folder / name_of_slice(i), slice);
    }
    const VolumeFile file = read_volume(folder.path());
    const Geometry& g = file.volume.geometry();
    EXPECT_TRUE(contains(all_notes(file), "gantry tilt of 21.8 degrees")) << all_notes(file);
    EXPECT_EQ(g.size, Index3(8, 20, 6));  // 4 mm more, 8 rows
    int inside = 0, outside = 0;
    for (int z = 0; z < 6; ++z) {
        for (int y = 0; y < 20; ++y) {
            const double row = y - shift * z / 0.5;  // within that slice
            const double value = file.volume.sample({3, y, z});
            if (row >= 0 && row <= 11) {
                EXPECT_NEAR(value, body(physical_from_index(g, Vec3(3, y, z))), 1.01);
                ++inside;
            } else if (row <= -1 || row >= 12) {
                EXPECT_EQ(value, file.volume.minimum());
                ++outside;
            }
        }
    }
    EXPECT_GT(inside, 60);
    EXPECT_GT(outside, 20);
}

TEST(dicom, several_slices_at_each_place_are_time_steps) {
    const ScratchFolder folder;
    for (int i = 0; i < 12; ++i) {
        TestSlice slice = slice_at(i, 2.0 * (i % 4));
        slice.acquisition = 1 + i / 4;
        put_slice(folder / name_of_slice(i), slice);
    }
    for (int step = 0; step < 3; ++step) {
        ReadOptions options;
        options.time_step = step;
        const VolumeFile file = read_volume(folder.path(), options);
        EXPECT_EQ(file.time_steps, 3);
        EXPECT_EQ(file.volume.geometry().size[2], 4);
        EXPECT_EQ(file.volume.sample({0, 0, 2}), 100 * (4 * step + 2));
    }
    std::filesystem::remove(folder / name_of_slice(4));  // the first one of the second step
    EXPECT_TRUE(contains(refusal(folder.path()), "has 3 DICOM series"));
    TestSlice first_of_second = slice_at(4, 0);
    first_of_second.acquisition = 2;
    put_slice(folder / name_of_slice(4), first_of_second);
    std::filesystem::remove(folder / name_of_slice(5));
    EXPECT_TRUE(contains(refusal(folder.path()), "same place"));
}

TEST(dicom, slices_without_a_position_are_piled_up_by_number_and_that_is_said) {
    const ScratchFolder folder;
    for (int i = 0; i < 3; ++i) {
        TestSlice slice = slice_at(9 - i, 0);
        slice.position.clear();
        slice.pixel_spacing.clear();
        put_slice(folder / name_of_slice(i), slice);
    }
    const VolumeFile file = read_volume(folder.path());
    EXPECT_EQ(file.volume.geometry().spacing, Vec3(1, 1, 2.5));
    EXPECT_EQ(file.volume.sample({0, 0, 0}), 700);
    EXPECT_TRUE(contains(all_notes(file), "piled up"));
    EXPECT_TRUE(contains(all_notes(file), "pixel spacing"));
}

TEST(dicom, a_bad_slice_location_matters_only_without_a_position) {
    for (const char* location : {"none", "1e30"}) {
        const ScratchFolder folder;
        TestSlice slice = slice_at(1, 0);
        slice.location = location;
        put_slice(folder / "1.dcm", slice);
        EXPECT_EQ(read_volume(folder / "1.dcm").volume.sample({0, 0, 0}), 100);
        slice.position.clear();
        put_slice(folder / "1.dcm", slice);
        EXPECT_TRUE(one_line_about(refusal(folder / "1.dcm"), folder / "1.dcm"));
    }
}

TEST(dicom, a_mosaic_of_slices_is_refused_with_what_to_do) {
    const ScratchFolder folder;
    TestSlice slice = slice_at(1, 0);
    slice.image_type = "ORIGINAL\\PRIMARY\\M\\MOSAIC";
    put_slice(folder / "1.dcm", slice);
    EXPECT_TRUE(one_line_about(refusal(folder / "1.dcm"), folder / "1.dcm"));
    EXPECT_TRUE(contains(refusal(folder / "1.dcm"), "convert it to NIfTI"));
}

TEST(dicom, colours_and_bad_spacings_are_refused) {
    const ScratchFolder folder;
    TestSlice slice = slice_at(1, 0);
    slice.samples_per_pixel = 3;
    put_slice(folder / "1.dcm", slice);
    EXPECT_TRUE(contains(refusal(folder / "1.dcm"), "colours"));
    slice.samples_per_pixel = 1;
    for (const char* spacing : {"0\\1", "-1\\1", "1\\nan"}) {
        slice.pixel_spacing = spacing;
        put_slice(folder / "1.dcm", slice);
        EXPECT_TRUE(one_line_about(refusal(folder / "1.dcm"), folder / "1.dcm"));
    }
}

TEST(dicom, a_truncated_slice_is_refused_whatever_its_length) {
    const ScratchFolder folder;
    for (int i = 0; i < 3; ++i) put_slice(folder / name_of_slice(i), slice_at(i, i));
    const std::string whole = bytes_of(folder / "1.dcm");
    std::mt19937 random(41);
    for (int i = 0; i < 24; ++i) {
        const std::size_t length = i < 12 ? whole.size() - 1 - static_cast<std::size_t>(i) * 2
                                          : 132 + random() % (whole.size() - 132);
        put_bytes(folder / "1.dcm", whole.substr(0, length));
        const std::string message = refusal(folder.path());
        EXPECT_TRUE(one_line_about(message.substr(0, message.find('\n')), folder.path()))
            << length << ": " << message;
    }
}

TEST(dicom, a_damaged_slice_of_a_series_is_named) {
    const ScratchFolder folder;
    for (int i = 0; i < 3; ++i) put_slice(folder / name_of_slice(i), slice_at(i, i));
    const std::string whole = bytes_of(folder / "1.dcm");
    put_bytes(folder / "1.dcm", whole.substr(0, whole.size() - 4));
    EXPECT_TRUE(contains(refusal(folder.path()), "'1.dcm' is cut off"));
}

TEST(dicom, flipped_bytes_are_refused_or_give_a_valid_volume) {
    const ScratchFolder folder;
    std::mt19937 random(42);
    const std::string whole = dicom_bytes(slice_at(1, 0));
    int refused = 0;
    for (int i = 0; i < 200; ++i) {
        std::string damaged = whole;
        for (int flips = 0; flips <= i % 3; ++flips) {
            const std::size_t at = 128 + random() % (whole.size() - 128);
            damaged[at] = static_cast<char>(damaged[at] ^ (1 << random() % 8));
        }
        put_bytes(folder / "1.dcm", damaged);
        try {
            check(read_volume(folder / "1.dcm").volume.geometry());
        } catch (const InputError& e) {
            EXPECT_TRUE(one_line_about(e.what(), folder / "1.dcm")) << e.what();
            ++refused;
        }
    }
    EXPECT_GT(refused, 20);
}

TEST(dicom, a_folder_of_reports_without_an_image_is_refused) {
    const ScratchFolder folder;
    TestSlice slice = slice_at(1, 0);
    slice.rows = 0;
    put_slice(folder / "1.dcm", slice);
    EXPECT_TRUE(contains(refusal(folder.path()), "no size of its image"));
    slice.kind = "1.2.840.10008.5.1.4.1.1.88.11";
    put_slice(folder / "1.dcm", slice);
    EXPECT_TRUE(contains(refusal(folder.path()), "none with an image"));
    EXPECT_TRUE(contains(refusal(folder / "1.dcm"), "without an image"));
    put_bytes(folder / "1.dcm", "not DICOM at all");
    EXPECT_TRUE(one_line_about(refusal(folder / "1.dcm"), folder / "1.dcm"));
}

}  // namespace
}  // namespace palpate::io::test
