// Files read back as they were written: samples, type, spacing, origin and direction, in every
// format.
#include <sys/stat.h>
#include <zlib.h>

#include <thread>
#include <tuple>

#include "palpate/io/written_formats.hpp"
#include "volume_support.hpp"

namespace palpate::io::test {
namespace {

struct Precision {
    double spacing, origin, direction;
};

Precision precision_of(const std::string& extension) {
    if (extension == ".nii" || extension == ".nii.gz") return {1e-6, 1e-4, 1e-6};  // 32-bit floats
    if (extension == ".nrrd" || extension == ".nhdr")
        return {1e-14, 0, 1e-14};  // one vector an axis
    return {0, 0, 0};
}

void expect_same(const Geometry& read, const Geometry& written, const Precision& precision) {
    EXPECT_EQ(read.size, written.size);
    EXPECT_LE((read.spacing - written.spacing).cwiseAbs().maxCoeff(), precision.spacing);
    EXPECT_LE((read.origin - written.origin).cwiseAbs().maxCoeff(), precision.origin);
    EXPECT_LE((read.direction - written.direction).cwiseAbs().maxCoeff(), precision.direction);
}

class RoundTrip : public testing::TestWithParam<std::string> {};

TEST_P(RoundTrip, keeps_every_type_spacing_and_direction) {
    const std::string& extension = GetParam();
    const ScratchFolder folder;
    std::mt19937 random(20240611);
    for (const auto type :
         {SampleType::uint8, SampleType::int16, SampleType::uint16, SampleType::float32}) {
        for (int round = 0; round < 6; ++round) {
            const Volume volume = random_volume(
                random, type, random_geometry(random, round % 2 == 1, round % 3 == 2));
            const auto path = folder / ("volume" + extension);
            WriteOptions options;
            options.compress = round >= 3;
            write_volume(volume, path, options);
            const VolumeFile file = read_volume(path);
            EXPECT_TRUE(same_samples(file.volume, volume)) << name_of(type) << " round " << round;
            expect_same(file.volume.geometry(), volume.geometry(), precision_of(extension));
            EXPECT_EQ(file.notes, std::vector<std::string>{});
            EXPECT_EQ(file.time_steps, 1);
            for (const std::string& name : folder.names()) std::filesystem::remove(folder / name);
        }
    }
}

TEST_P(RoundTrip, goes_through_a_pipe_or_refuses_it_and_never_replaces_it) {
    const std::string& extension = GetParam();
    const ScratchFolder folder;
    std::mt19937 random(9);
    const Volume volume =
        random_volume<std::int16_t>(random, random_geometry(random, false, false));
    const auto pipe = folder / ("pipe" + extension), path = folder / ("volume" + extension);
    ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
    if (extension == ".nhdr" || extension == ".mhd") {
        EXPECT_TRUE(contains(message_of<OutputError>([&] { write_volume(volume, pipe); }),
                             "takes two of them"));
    } else {
        std::thread reader([&] { put_bytes(path, bytes_of(pipe)); });
        write_volume(volume, pipe);
        reader.join();
        EXPECT_TRUE(same_samples(read_volume(path).volume, volume));
        std::filesystem::remove(path);
    }
    EXPECT_EQ(folder.names(), std::vector<std::string>{"pipe" + extension});
    EXPECT_TRUE(std::filesystem::is_fifo(pipe));
}

TEST_P(RoundTrip, keeps_an_axis_aligned_grid_to_the_bit_or_to_32_bits) {
    const std::string& extension = GetParam();
    const ScratchFolder folder;
    std::mt19937 random(7);
    Geometry g = random_geometry(random, false, false);
    g.spacing = Vec3(0.390625, 0.5, 1.25);
    g.origin = Vec3(-12.5, 100.25, 3);
    const auto path = folder / ("volume" + extension);
    write_volume(random_volume<std::int16_t>(random, g), path);
    expect_same(read_volume(path).volume.geometry(), g, {0, 0, 0});
}

TEST_P(RoundTrip, keeps_grids_that_are_one_sample_thick) {
    const std::string& extension = GetParam();
    const ScratchFolder folder;
    std::mt19937 random(8);
    for (const Index3& size : {Index3(7, 5, 1), Index3(1, 6, 4), Index3(1, 1, 1)}) {
        Geometry g = random_geometry(random, false, false);
        g.size = size;
        const Volume volume = random_volume<std::uint16_t>(random, g);
        const auto path = folder / ("volume" + extension);
        write_volume(volume, path);
        const VolumeFile file = read_volume(path);
        EXPECT_TRUE(same_samples(file.volume, volume));
        expect_same(file.volume.geometry(), g, precision_of(extension));
    }
}

TEST_P(RoundTrip, keeps_the_least_and_the_greatest_spacing_and_writes_none_that_is_not_read) {
    const ScratchFolder folder;
    std::mt19937 random(10);
    const auto path = folder / ("volume" + GetParam());
    Geometry g = random_geometry(random, false, false);
    g.origin = Vec3::Zero();
    for (const double spacing : {1e-9, 1e9}) {
        g.spacing = Vec3::Constant(spacing);
        write_volume(random_volume<std::uint8_t>(random, g), path);
        EXPECT_TRUE(read_volume(path).volume.geometry().spacing.isApprox(g.spacing, 1e-6));
    }
    for (const double spacing : {1e-10, 1e10}) {
        g.spacing.x() = spacing;
        const Volume volume = random_volume<std::uint8_t>(random, g);
        const std::string message = message_of<OutputError>([&] { write_volume(volume, path); });
        EXPECT_TRUE(contains(message, "mm is outside 1e-9 to 1e9 mm")) << message;
    }
}

TEST_P(RoundTrip, a_second_write_replaces_the_first_and_leaves_only_the_file) {
    const std::string& extension = GetParam();
    const ScratchFolder folder;
    std::mt19937 random(9);
    const Geometry g = random_geometry(random, false, false);
    const auto path = folder / ("volume" + extension);
    write_volume(random_volume<std::uint8_t>(random, g), path);
    const Volume second = random_volume<std::uint8_t>(random, g);
    write_volume(second, path);
    EXPECT_TRUE(same_samples(read_volume(path).volume, second));
    const bool two_files = extension == ".mhd" || extension == ".nhdr";
    EXPECT_EQ(folder.names().size(), two_files ? 2U : 1U);
}

INSTANTIATE_TEST_SUITE_P(formats, RoundTrip,
                         testing::Values(".nrrd", ".nhdr", ".mha", ".mhd", ".nii", ".nii.gz",
                                         ".vti"));

TEST(write_volume, refuses_a_name_without_a_known_extension) {
    const ScratchFolder folder;
    std::mt19937 random(1);
    const Volume volume =
        random_volume<std::uint8_t>(random, random_geometry(random, false, false));
    for (const char* name : {"volume", "volume.txt", "volume.png", "volume.gz", "volume.MHA"}) {
        const auto path = folder / name;
        const std::string message = message_of<OutputError>([&] { write_volume(volume, path); });
        EXPECT_TRUE(one_line_about(message, path)) << message;
        EXPECT_TRUE(contains(message, ".nrrd")) << message;
    }
    EXPECT_EQ(folder.names(), std::vector<std::string>{});
}

TEST(write_volume, refuses_formats_that_would_lose_where_the_volume_lies) {
    const ScratchFolder folder;
    std::mt19937 random(2);
    Geometry moved, turned;
    moved.size = turned.size = Index3(3, 3, 3);
    moved.origin = Vec3(0, 0, 5);
    turned.direction.col(2) *= -1;
    for (const Geometry& geometry : {moved, turned}) {
        const Volume volume = random_volume<std::uint8_t>(random, geometry);
        for (const char* name : {"a.tif", "a.tiff", "a.raw"}) {
            const auto path = folder / name;
            const auto message = message_of<OutputError>([&] { write_volume(volume, path); });
            EXPECT_TRUE(one_line_about(message, path)) << message;
            EXPECT_TRUE(contains(message, ".nrrd")) << message;
        }
    }
    EXPECT_EQ(folder.names(), std::vector<std::string>{});
}

TEST(write_volume, never_replaces_the_samples_of_another_volume) {
    const ScratchFolder folder;
    std::mt19937 random(3);
    Geometry g;
    g.size = Index3(3, 4, 5);
    const Volume volume = random_volume<std::uint8_t>(random, g);
    const Volume other = random_volume<std::uint8_t>(random, g);
    const auto refused = [&](const char* name, const char* owner) {
        const auto message = message_of<OutputError>([&] { write_volume(other, folder / name); });
        EXPECT_TRUE(contains(message, std::string("belong to ") + owner)) << message;
    };
    write_volume(volume, folder / "a.mhd");
    write_volume(volume, folder / "b.raw");
    refused("a.raw", "a.mhd");
    refused("b.mhd", "b.raw");
    refused("b.nhdr", "b.raw");
    EXPECT_TRUE(same_samples(read_volume(folder / "a.mhd").volume, volume));
    write_volume(other, folder / "a.mhd");  // one volume in its own place
    write_volume(other, folder / "b.raw");
    EXPECT_TRUE(same_samples(read_volume(folder / "a.mhd").volume, other));
}

class TwoFiles : public testing::TestWithParam<std::tuple<std::string, bool>> {
  protected:
    void write(const Volume& volume, const std::string& name) const {
        WriteOptions options;
        options.compress = std::get<1>(GetParam());
        write_volume(volume, folder_ / name, options);
    }
    std::string refusal(const Volume& volume, const std::string& name) const {
        return message_of<OutputError>([&] { write(volume, name); });
    }
    ScratchFolder folder_;
};

TEST_P(TwoFiles, never_replace_samples_of_a_header_with_another_name) {
    const std::string header = std::get<0>(GetParam());
    std::mt19937 random(4);
    Geometry g;
    g.size = Index3(3, 4, 5);
    const Volume volume = random_volume<std::uint8_t>(random, g);
    const Volume other = random_volume<std::uint8_t>(random, g);
    write(volume, "a" + header);
    write(volume, "a" + header);  // its own samples
    const auto names = folder_.names();
    ASSERT_EQ(names.size(), 2U);
    const auto data = data_file_of(folder_ / ("a" + header), std::get<1>(GetParam())).filename();
    EXPECT_TRUE(data == names[0] || data == names[1]) << data;

    std::filesystem::rename(folder_ / ("a" + header), folder_ / ("mine" + header));
    EXPECT_TRUE(contains(refusal(other, "a" + header), "belong to " + data.string()));
    // A header of this name whose samples are elsewhere.
    put_bytes(folder_ / ("a" + header), "NRRD0005\ndata file: b.raw\nElementDataFile = b.raw\n");
    EXPECT_TRUE(contains(refusal(other, "a" + header), "belong to " + data.string()));
    EXPECT_TRUE(same_samples(read_volume(folder_ / ("mine" + header)).volume, volume));
}

TEST_P(TwoFiles, never_replace_samples_that_a_header_of_the_other_format_names) {
    const std::string header = std::get<0>(GetParam());
    const std::string other = header == ".mhd" ? "a.nhdr" : "a.mhd";
    std::mt19937 random(5);
    Geometry g;
    g.size = Index3(3, 4, 5);
    const Volume volume = random_volume<std::uint8_t>(random, g);
    write(volume, "a" + header);
    const auto data = data_file_of(folder_ / ("a" + header), std::get<1>(GetParam())).filename();
    put_bytes(folder_ / other,
              "data file: ./" + data.string() + "\nElementDataFile = " + data.string() + "\n");
    EXPECT_TRUE(contains(refusal(volume, "a" + header), "belong to " + other));
    put_bytes(folder_ / other, "data file: b.raw\nElementDataFile = b.raw\n");
    write(volume, "a" + header);
}

INSTANTIATE_TEST_SUITE_P(
    each, TwoFiles,
    testing::Combine(testing::Values(std::string(".nhdr"), std::string(".mhd")), testing::Bool()));

TEST(write_volume, says_so_if_the_folder_is_missing_or_the_name_is_a_folder) {
    const ScratchFolder folder;
    std::mt19937 random(1);
    const Volume volume =
        random_volume<std::uint8_t>(random, random_geometry(random, false, false));
    const auto missing = folder / "no/such/volume.nrrd";
    EXPECT_TRUE(contains(message_of<OutputError>([&] { write_volume(volume, missing); }),
                         "create it first"));
    EXPECT_TRUE(contains(message_of<OutputError>([&] { write_volume(volume, folder.path()); }),
                         "is a folder"));
}

TEST(write_volume, leaves_the_old_file_and_nothing_else_if_it_cannot_write) {
    const ScratchFolder folder;
    std::mt19937 random(1);
    Geometry g = random_geometry(random, false, false);
    const auto path = folder / "volume.nii";
    put_bytes(path, "as it was");
    g.size = Index3(40000, 1, 1);  // NIfTI's sizes have 16 bits
    const Volume volume = random_volume<std::uint8_t>(random, g);
    EXPECT_TRUE(one_line_about(message_of<OutputError>([&] { write_volume(volume, path); }), path));
    EXPECT_EQ(bytes_of(path), "as it was");
    EXPECT_EQ(folder.names(), std::vector<std::string>{"volume.nii"});
}

TEST(write_volume, full_disk_is_an_error_and_leaves_nothing) {
    if (!std::filesystem::exists("/proc/self/exe")) GTEST_SKIP() << "needs /proc";
    const ScratchFolder folder;
    std::mt19937 random(1);
    Geometry g;
    g.size = Index3(64, 64, 64);
    const Volume volume = random_volume<std::int16_t>(random, g);
    // A helper whose files may have no more than 64 blocks of 1 kB.
    const auto small = folder / "small-disk";
    put_bytes(small, "#!/bin/bash\nulimit -f 64\ntrap '' XFSZ\nexec '" + real_helper().string() +
                         "' \"$@\"\n");
    std::filesystem::permissions(small, std::filesystem::perms::owner_all);
    for (const char* name :
         {"a.nrrd", "a.nhdr", "a.mha", "a.mhd", "a.nii", "a.nii.gz", "a.vti", "a.tif"}) {
        WriteOptions options;
        options.helper = small;
        const auto path = folder / name;
        const std::string message =
            message_of<OutputError>([&] { write_volume(volume, path, options); });
        EXPECT_EQ(message, path.string() + ": was not written whole; is the disk full?");
        EXPECT_EQ(folder.names(), std::vector<std::string>{"small-disk"}) << name;
    }
}

TEST(write_volume, keeps_the_mode_of_a_file_that_it_replaces_and_the_links_to_it) {
    namespace fs = std::filesystem;
    std::mt19937 random(8);
    Geometry geometry;
    geometry.size = Index3(3, 4, 5);
    const Volume volume = random_volume(random, SampleType::uint8, geometry);
    constexpr auto only_owner = fs::perms::owner_read | fs::perms::owner_write;
    for (const std::string_view extension : written_extensions()) {
        const ScratchFolder folder;
        const fs::path file = folder / ("a" + std::string(extension)),
                       link = folder / ("l" + std::string(extension));
        put_bytes(file, "old");
        fs::permissions(file, only_owner);
        write_volume(volume, file, {});
        EXPECT_EQ(fs::status(file).permissions(), only_owner) << extension;
        fs::create_symlink(file.filename(), link);
        const Volume other = random_volume(random, SampleType::uint8, geometry);
        if (extension == ".nhdr" || extension == ".mhd") {
            EXPECT_TRUE(contains(message_of<OutputError>([&] { write_volume(other, link, {}); }),
                                 "is a link"));
            continue;
        }
        write_volume(other, link, {});
        EXPECT_TRUE(fs::is_symlink(link)) << extension;
        ReadOptions options;
        if (extension == ".raw") options.raw = RawLayout{geometry.size, SampleType::uint8};
        EXPECT_TRUE(same_samples(read_volume(file, options).volume, other)) << extension;
    }
}

}  // namespace
}  // namespace palpate::io::test
