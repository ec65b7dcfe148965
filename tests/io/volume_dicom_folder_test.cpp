// Folders of DICOM files as archives and careless copying leave them: very many files, copies,
// several frames in a file, sizes that disagree.
#include <sys/resource.h>

#include <cmath>

#include "support/random.hpp"
#include "volume_dicom_changed.hpp"

namespace palpate::io::test {
namespace {

void put_slices(const ScratchFolder& folder, int count) {
    for (int i = 0; i < count; ++i) {
        put_slice(folder / (std::to_string(i) + ".dcm"), usual_slice(i));
    }
}

/// [s] of processor time of the helper processes so far.
double helpers_time() {
    rusage usage{};
    ::getrusage(RUSAGE_CHILDREN, &usage);
    const auto seconds = [](const timeval& t) {
        return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
    };
    return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

TEST(dicom_folder, of_ten_thousand_slices_takes_time_in_proportion) {
    // Also where careless anonymizing has given all slices one identity.
    for (const bool one_identity : {false, true}) {
        const auto time_of = [&](int count) {
            const ScratchFolder folder;
            for (int i = 0; i < count; ++i) {
                TestSlice slice = usual_slice(i);
                if (one_identity) slice.number = 1;
                put_slice(folder / (std::to_string(i) + ".dcm"), slice);
            }
            const double before = helpers_time();
            const VolumeFile file = read_volume(folder.path());
            EXPECT_EQ(file.volume.geometry().size, Index3(4, 3, count));
            EXPECT_EQ(file.volume.sample({1, 2, count - 1}),
                      one_identity ? 109 : (100 * (count - 1) + 9) % 65536);
            EXPECT_EQ(file.notes, std::vector<std::string>{});
            return helpers_time() - before;
        };
        const int few = 2500 / (support::is_slow_build ? 5 : 1);
        const double time_of_few = time_of(few);
        EXPECT_LT(time_of(4 * few), 8 * time_of_few);  // 16 if it were quadratic
    }
}

TEST(dicom_folder, a_single_slice_among_volumes_is_not_the_volume) {
    const ScratchFolder folder;
    for (const char* name : {"d.nii.gz", "a.nrrd", "c.mha", "b.NRRD", "e.vti"}) {
        put_bytes(folder / name, "a volume");
    }
    EXPECT_TRUE(contains(refusal(folder.path()),
                         "is a folder of volumes: give one of them (a.nrrd, b.NRRD, c.mha and 2 "
                         "more)"));
    put_slices(folder, 1);
    EXPECT_TRUE(contains(refusal(folder.path()), "with a single slice"));
    EXPECT_EQ(read_volume(folder / "0.dcm").volume.geometry().size, Index3(4, 3, 1));
    put_slices(folder, 4);
    EXPECT_EQ(read_volume(folder.path()).volume.geometry().size, Index3(4, 3, 4));
}

TEST(dicom_folder, an_empty_file_without_a_number_in_its_name_is_no_slice) {
    const ScratchFolder folder;
    for (const char* name : {"3FA9", "B120"}) {
        put_slice(folder / name, usual_slice(name[0]));
    }
    put_bytes(folder / "LOCKFILE", "");
    EXPECT_EQ(read_volume(folder.path()).volume.geometry().size[2], 2);
    put_bytes(folder / "C777", "");
    EXPECT_TRUE(contains(refusal(folder.path()), "'C777' is empty"));
}

TEST(dicom_folder, a_slice_that_is_a_dangling_link_is_named) {
    namespace fs = std::filesystem;
    for (const char* target : {"nowhere", "3.dcm"}) {  // the second is a link to itself
        const ScratchFolder folder;
        put_slices(folder, 3);
        fs::create_symlink("gone", folder / "README");
        EXPECT_EQ(read_volume(folder.path()).volume.geometry().size[2], 3);
        fs::create_symlink(target, folder / "3.dcm");
        const std::string message = refusal(folder.path());
        EXPECT_TRUE(contains(message, "'3.dcm' is a link to a file that is not there")) << message;
        for (int i = 0; i < 3; ++i) fs::remove(folder / (std::to_string(i) + ".dcm"));
        EXPECT_TRUE(contains(refusal(folder.path()), "'3.dcm' is a link")) << "alone";
    }
    const ScratchFolder bare;  // slices without an extension
    for (const int i : {1, 2}) put_slice(bare / ("IM" + std::to_string(i)), usual_slice(i));
    fs::create_symlink("gone", bare / "IM3");
    EXPECT_TRUE(contains(refusal(bare.path()), "'IM3' is a link")) << refusal(bare.path());
}

TEST(dicom_folder, a_packed_slice_is_named_as_such_in_a_folder_and_alone) {
    const ScratchFolder folder;
    put_slices(folder, 2);
    put_gzip(folder / "2.dcm.gz", dicom_bytes(usual_slice(2)));
    EXPECT_TRUE(contains(refusal(folder.path()), "'2.dcm.gz' is packed"));
    EXPECT_TRUE(contains(refusal(folder / "2.dcm.gz"), "is packed"));
}

TEST(dicom_folder, with_copies_of_its_slices_is_the_series_without_them_and_that_is_said) {
    const ScratchFolder folder;
    put_slices(folder, 6);
    namespace fs = std::filesystem;
    fs::copy_file(folder / "2.dcm", folder / "2 (copy).dcm");
    fs::copy_file(folder / "4.dcm", folder / "backup.dcm");
    const VolumeFile some = read_volume(folder.path());
    EXPECT_EQ(some.volume.geometry().size, Index3(4, 3, 6));
    EXPECT_EQ(some.time_steps, 1);
    EXPECT_TRUE(contains(all_notes(some), "2 of its 8 files are copies")) << all_notes(some);
    for (int i = 0; i < 6; ++i) put_slice(folder / ("again" + std::to_string(i)), usual_slice(i));
    const VolumeFile all = read_volume(folder.path());
    EXPECT_EQ(all.time_steps, 1);
    EXPECT_EQ(all.volume.geometry().size, Index3(4, 3, 6));
    // The same identity, but not the same slice: the right one cannot be known.
    TestSlice other = usual_slice(2);
    other.pixels.assign(12, 7);
    put_slice(folder / "other.dcm", other);
    EXPECT_TRUE(contains(refusal(folder.path()), "same place"));
}

TEST(dicom_folder, of_tilted_slices_with_gaps_among_others_gives_the_body_in_its_place) {
    // Two series, a tilted one with holes and copies: every irregularity at once is undone and
    // said.
    const ScratchFolder folder;
    const auto body = [](const Vec3& p) { return 20000 + 300 * p[0] + 100 * p[1] + 50 * p[2]; };
    for (int i = 0; i < 12; ++i) {
        if (i == 4 || i == 7) continue;
        TestSlice slice = usual_slice(i);
        slice.columns = 8;
        slice.rows = 12;
        slice.position = "10\\" + std::to_string(20 + i) + "\\" + std::to_string(2 * i);
        for (int y = 0; y < 12; ++y) {
            for (int x = 0; x < 8; ++x) {
                slice.pixels.push_back(static_cast<std::uint16_t>(
                    std::lround(body(Vec3(10 + 0.25 * x, 20 + i + 0.5 * y, 2 * i)))));
            }
        }
        put_slice(folder / ("a" + std::to_string(i)), slice);
        if (i == 5) put_slice(folder / "copy", slice);
        slice.series = "1.2.3.5";
        put_slice(folder / ("b" + std::to_string(i)), slice);
    }
    ReadOptions options;
    options.series = "1.2.3.4";
    const VolumeFile file = read_volume(folder.path(), options);
    for (const char* said : {"gantry tilt of 26.6 degrees", "2 of 12 slices are missing",
                             "1 of its 11 files are copies"}) {
        EXPECT_TRUE(contains(all_notes(file), said)) << all_notes(file);
    }
    const Geometry& g = file.volume.geometry();
    ASSERT_EQ(g.size, Index3(8, 34, 12));  // 11 mm more, 22 rows
    int inside = 0;
    for (int z = 0; z < 12; ++z) {
        if (z == 4 || z == 7) continue;
        for (int y = 2 * z; y < 2 * z + 12; ++y) {
            EXPECT_NEAR(file.volume.sample({3, y, z}), body(physical_from_index(g, Vec3(3, y, z))),
                        1.01);
            ++inside;
        }
    }
    EXPECT_EQ(inside, 120);
}

TEST(dicom_folder, a_stack_of_frames_in_one_file_is_read_in_order) {
    const ScratchFolder folder;
    TestSlice stack = usual_slice(1);
    stack.frames = 5;
    put_slice(folder / "stack.dcm", stack);
    for (const auto& path : {folder / "stack.dcm", folder.path()}) {
        const VolumeFile file = read_volume(path);
        EXPECT_EQ(file.volume.geometry().size, Index3(4, 3, 5));
        for (int i = 0; i < 60; ++i) {
            EXPECT_EQ(file.volume.sample({i % 4, i / 4 % 3, i / 12}), 100 + i);
        }
        EXPECT_EQ(file.volume.geometry().spacing[2], 2.5);
        EXPECT_TRUE(contains(all_notes(file),
                             "5 frames do not say where they lie: taken as slices "
                             "2.5 mm apart"))
            << all_notes(file);
    }
}

TEST(dicom_folder, a_size_that_its_samples_do_not_have_is_refused_or_said) {
    const ScratchFolder folder;
    const auto with_samples = [&](std::size_t count) {
        TestSlice slice = usual_slice(1);
        slice.columns = 64;
        slice.rows = 64;
        std::string bytes = dicom_bytes(slice);
        const std::size_t length = bytes.size() - 2 * 64 * 64 - 4;
        bytes.replace(length, 4, little(static_cast<std::uint32_t>(2 * count)));
        bytes.resize(length + 4);
        bytes += std::string(2 * count, 'x');
        put_bytes(folder / "1.dcm", bytes);
    };
    for (const std::size_t wrong : {64U * 64U - 1, 64U * 64U + 3000, 2 * 64U * 64U}) {
        with_samples(wrong);
        const std::string message = refusal(folder.path());
        EXPECT_TRUE(one_line_about(message, folder.path())) << message;
        EXPECT_TRUE(contains(message, "its header asks for 8192")) << message;
    }
    with_samples(64 * 64 + 5);
    const VolumeFile file = read_volume(folder.path());
    EXPECT_TRUE(contains(all_notes(file), "10 bytes more of samples")) << all_notes(file);
    for (const char* frames : {"0", "-3", "3", "nonsense", "99999999"}) {
        TestSlice slice = usual_slice(1);
        slice.frames = 12345678;  // eight digits to be replaced
        slice.pixels.assign(12, 1);
        slice.columns = 0;  // no samples are made
        std::string bytes = dicom_bytes(slice);
        bytes.replace(bytes.find("12345678"), 8,
                      std::string(frames) + std::string(8 - std::strlen(frames), ' '));
        const auto columns = bytes.find(std::string("\x28\0\x11\0US\2\0", 8));
        bytes[columns + 8] = 4;
        put_bytes(folder / "1.dcm", bytes);
        EXPECT_TRUE(one_line_about(refusal(folder / "1.dcm"), folder / "1.dcm"));
    }
}

}  // namespace
}  // namespace palpate::io::test
