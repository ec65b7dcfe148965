// Plain files read by the box: the same samples as reading them whole, whatever their size.
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <limits>

#include "io/real_volumes.hpp"
#include "io/volume_nifti_bytes.hpp"
#include "io/volume_support.hpp"
#include "palpate/io/output.hpp"
#include "stream/store_support.hpp"

namespace palpate::stream::test {
namespace {

using io::test::little;
using io::test::random_geometry;
using io::test::random_volume;
using io::test::real_volume;
using support::bytes_of;
using support::contains;
using support::message_of;
using support::put_bytes;
using support::ScratchFolder;

TEST(PlainFile, boxes_are_those_of_the_volume_read_whole_for_every_format_and_type) {
    const ScratchFolder folder;
    std::mt19937 random(1);
    for (const char* name : {"v.nrrd", "v.nhdr", "v.mha", "w.mhd", "v.nii"}) {
        for (const SampleType type :
             {SampleType::uint8, SampleType::int16, SampleType::uint16, SampleType::float32}) {
            SCOPED_TRACE(std::string(name) + " " + std::string(name_of(type)));
            const std::string path = folder / name;
            io::write_volume(random_volume(random, type, random_geometry(random, true, true)),
                             path);
            ASSERT_TRUE(is_store(path));
            const auto whole = io::read_volume(path);
            const auto store = open_store(path);
            EXPECT_EQ(store->info().levels.at(0).geometry, whole.volume.geometry());
            EXPECT_EQ(store->info().format, whole.format);
            expect_same_boxes(*store, whole.volume, 2);
        }
    }
}

TEST(PlainFile, a_raw_file_is_read_in_either_byte_order_and_after_a_skip) {
    const ScratchFolder folder;
    std::mt19937 random(3);
    for (const bool big : {false, true}) {
        for (const SampleType type : {SampleType::uint8, SampleType::uint16, SampleType::float32}) {
            const Volume volume =
                random_volume(random, type, random_geometry(random, false, false));
            std::string bytes(static_cast<const char*>(volume.data()), volume.bytes());
            const std::size_t each = size_of(type);
            for (std::size_t at = 0; big && at < bytes.size(); at += each) {
                std::reverse(bytes.begin() + std::ptrdiff_t(at),
                             bytes.begin() + std::ptrdiff_t(at + each));
            }
            put_bytes(folder / "v.raw", std::string(7, 'x') + bytes);
            StoreOptions options;
            options.raw = {volume.geometry().size, type, {1, 2, 3}, 7, big};
            options.spacing = Vec3(0.5, 2, 3);
            ASSERT_TRUE(is_store(folder / "v.raw", options));
            const auto store = open_store(folder / "v.raw", options);
            EXPECT_EQ(store->info().levels.at(0).geometry.spacing, Vec3(0.5, 2, 3));
            expect_same_boxes(*store, volume, 4);
        }
    }
}

TEST(PlainFile, wider_types_become_those_of_a_volume_and_slope_and_intercept_are_applied) {
    const ScratchFolder folder;
    const auto expect_as_whole = [&](const std::string& path) {
        const auto whole = io::read_volume(path);
        const auto store = open_store(path);
        EXPECT_FALSE(store->info().notes.empty());
        expect_same_boxes(*store, whole.volume, 5);
    };
    const std::string head = "NRRD0004\ndimension: 3\nsizes: 3 2 2\nendian: big\nencoding: raw\n";
    std::mt19937 random(6);
    std::string bytes(12 * 8, '\0');
    for (char& c : bytes) c = static_cast<char>(random());
    put_bytes(folder / "a.nrrd", head + "type: int8\n\n" + bytes.substr(0, 12));
    expect_as_whole(folder / "a.nrrd");
    put_bytes(folder / "b.nrrd", head + "type: uint32\n\n" + bytes.substr(0, 48));
    expect_as_whole(folder / "b.nrrd");
    put_bytes(folder / "c.nrrd", head + "type: int64\n\n" + bytes);
    expect_as_whole(folder / "c.nrrd");
    for (const SampleType type : {SampleType::int16, SampleType::float32}) {
        io::write_volume(random_volume(random, type, random_geometry(random, false, false)),
                         folder / "d.nii");
        std::string nifti = bytes_of(folder / "d.nii");
        nifti.replace(112, 8, little(0.37F) + little(-12.5F));
        put_bytes(folder / "d.nii", nifti);
        expect_as_whole(folder / "d.nii");
    }
}

TEST(PlainFile, a_file_that_is_written_anew_in_its_place_is_refused_as_those_of_chunks_are) {
    const ScratchFolder folder;
    const std::filesystem::path file = folder / "v.raw";
    StoreOptions options;
    options.raw = {{4, 4, 4}, SampleType::uint8, {1, 1, 1}, 0, false};
    put_bytes(file, std::string(64, 'a'));
    const auto store = open_store(file, options);
    const SampleBox box{{0, 0, 0}, {3, 3, 1}};
    EXPECT_EQ(read_box(*store, 0, box)[0], std::byte{'a'});
    const auto before = std::filesystem::last_write_time(file);
    std::fstream(file, std::ios::in | std::ios::out | std::ios::binary) << std::string(64, 'b');
    std::filesystem::last_write_time(file, before + std::chrono::seconds(1));
    const std::string message = message_of<io::InputError>([&] { read_box(*store, 0, box); });
    EXPECT_TRUE(contains(message, "v.raw: was written anew since it was opened")) << message;
    // Another file of that name is not this one.
    put_bytes(folder / "w.raw", std::string(64, 'c'));
    std::filesystem::rename(folder / "w.raw", file);
    EXPECT_EQ(read_box(*open_store(file, options), 0, box)[0], std::byte{'c'});
}

TEST(PlainFile, each_time_of_a_file_with_several_is_read) {
    const ScratchFolder folder;
    std::string bytes(2 * 2 * 2 * 3, '\0');
    for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<char>(i);
    put_bytes(folder / "t.nrrd",
              "NRRD0004\ntype: uint8\ndimension: 4\nsizes: 2 2 2 3\nencoding: raw\n"
              "spacings: 1 1 1 0.5\nunits: \"mm\" \"mm\" \"mm\" \"s\"\n\n" +
                  bytes);
    for (int time = 0; time < 3; ++time) {
        StoreOptions options;
        options.time = time;
        const auto store = open_store(folder / "t.nrrd", options);
        EXPECT_EQ(store->info().times, 3);
        EXPECT_EQ(store->info().frame_interval, 0.5);
        io::ReadOptions read;
        read.time_step = time;
        expect_same_boxes(*store, io::read_volume(folder / "t.nrrd", read).volume, 7);
    }
    StoreOptions beyond;
    beyond.time = 3;
    EXPECT_TRUE(contains(refusal(folder / "t.nrrd", beyond), "it has 3, numbered from 0"));
}

TEST(PlainFile, samples_that_are_not_finite_become_the_least_finite_one_of_the_file) {
    const ScratchFolder folder;
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const float infinity = std::numeric_limits<float>::infinity();
    put_bytes(folder / "v.raw", little(1.5F) + little(nan) + little(-infinity) + little(2.0F) +
                                    little(-7.0F) + little(3.0F));
    StoreOptions options;
    options.raw = {Index3(2, 3, 1), SampleType::float32};
    const auto store = open_store(folder / "v.raw", options);
    // The least one, -7, lies outside of the box.
    const auto bytes = read_box(*store, 0, {Index3::Zero(), Index3(1, 1, 0)});
    std::array<float, 4> values{};
    std::memcpy(values.data(), bytes.data(), sizeof values);
    EXPECT_EQ(values, (std::array{1.5F, -7.0F, -7.0F, 2.0F}));
    EXPECT_TRUE(contains(store->info().notes.at(0), "not finite"));
    io::ReadOptions read;
    read.raw = options.raw;
    expect_same_boxes(*store, io::read_volume(folder / "v.raw", read).volume, 3);
    put_bytes(folder / "v.raw", little(nan) + little(nan));
    options.raw = {Index3(2, 1, 1), SampleType::float32};
    const std::string message = message_of<io::InputError>([&] {
        (void)read_box(*open_store(folder / "v.raw", options), 0,
                       {Index3::Zero(), Index3(1, 0, 0)});
    });
    EXPECT_TRUE(contains(message, "finite")) << message;
}

TEST(PlainFile, nifti_slopes_units_and_times_are_as_in_the_file_read_whole) {
    const ScratchFolder folder;
    const float nan = std::numeric_limits<float>::quiet_NaN();
    for (const float slope : {0.0F, nan, 1.0F, -0.37F}) {
        for (const float intercept : {0.0F, 7.0F}) {
            put_bytes(folder / "a.nii", io::test::nifti(
                                            [&](std::string& h) {
                                                io::test::put_at(h, 112,
                                                                 little(slope) + little(intercept));
                                                io::test::put_at(h, 123, "\x03");
                                                io::test::put_at(h, 268, little(500.0F));
                                            },
                                            2));
            StoreOptions options;
            options.time = 1;
            io::ReadOptions read;
            read.time_step = 1;
            const auto store = open_store(folder / "a.nii", options);
            const auto whole = io::read_volume(folder / "a.nii", read);
            EXPECT_EQ(store->info().type, whole.volume.type());
            EXPECT_EQ(store->info().levels.at(0).geometry, whole.volume.geometry());
            EXPECT_EQ(whole.volume.geometry().origin[0], -0.5);
            expect_same_boxes(*store, whole.volume, 2);
        }
    }
}

/// Bytes that this process has read so far, from files and otherwise.
std::uint64_t bytes_read() {
    std::ifstream io("/proc/self/io");
    std::string name;
    std::uint64_t bytes = 0;
    io >> name >> bytes;
    EXPECT_EQ(name, "rchar:");
    return bytes;
}

TEST(PlainFile, of_twenty_gigabytes_only_the_header_and_what_is_asked_for_are_read) {
    const ScratchFolder folder;
    const std::uint64_t bytes = std::uint64_t{2500} * 2000 * 4000;
    put_bytes(folder / "big.nhdr",
              "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 2500 2000 4000\nencoding: raw\n"
              "spacings: 1 1 1\ndata file: big.raw\n\n");
    {
        std::ofstream data(folder / "big.raw", std::ios::binary);
        data.seekp(static_cast<std::streamoff>(bytes - 1));
        data.put('\x7f');
    }
    StoreOptions options;
    const std::uint64_t before = bytes_read();
    const auto store = open_store(folder / "big.nhdr", options);
    const Index3 last(2499, 1999, 3999);
    const auto corner = read_box(*store, 0, {last - Index3::Constant(63), last});
    const std::uint64_t read = bytes_read() - before;
    EXPECT_EQ(corner.back(), std::byte{0x7f});
    EXPECT_EQ(corner.front(), std::byte{0});
    EXPECT_EQ(store->traffic().bytes, 64 * 64 * 64);
    EXPECT_GE(read, 64U * 64 * 64);
    EXPECT_LT(read, 1'000'000U);
}

TEST(PlainFile, what_cannot_be_read_by_the_box_says_so_in_one_line) {
    const ScratchFolder folder;
    io::WriteOptions compressed;
    compressed.compress = true;
    std::mt19937 random(8);
    const Volume volume =
        random_volume(random, SampleType::uint8, random_geometry(random, false, false));
    io::write_volume(volume, folder / "c.nrrd", compressed);
    io::write_volume(volume, folder / "c.mha", compressed);
    io::write_volume(volume, folder / "c.nii.gz");
    for (const char* name : {"c.nrrd", "c.mha"}) {
        EXPECT_FALSE(is_store(folder / name));
        EXPECT_TRUE(contains(refusal(folder / name), "compressed")) << name;
    }
    EXPECT_FALSE(is_store(folder / "c.nii.gz"));
    EXPECT_TRUE(contains(refusal(folder / "no.nrrd"), "does not exist"));
    io::write_volume(volume, folder / "cut.nrrd");
    std::filesystem::resize_file(folder / "cut.nrrd",
                                 std::filesystem::file_size(folder / "cut.nrrd") - 20);
    EXPECT_TRUE(contains(refusal(folder / "cut.nrrd"), "cut off"));
}

TEST(PlainFile, a_file_that_shrinks_while_it_is_open_is_an_error) {
    const ScratchFolder folder;
    put_bytes(folder / "v.raw", std::string(1000, 'a'));
    StoreOptions options;
    options.raw = {Index3(10, 10, 10), SampleType::uint8};
    const auto store = open_store(folder / "v.raw", options);
    std::filesystem::resize_file(folder / "v.raw", 500);
    const std::string message = message_of<io::InputError>([&] {
        (void)read_box(*store, 0, {Index3::Zero(), Index3(9, 9, 9)});
    });
    EXPECT_TRUE(contains(message, "shorter than when opened"));
}

TEST(PlainFile, reading_stops_when_asked_to) {
    const ScratchFolder folder;
    put_bytes(folder / "v.raw", std::string(1000, 'a'));
    StoreOptions options;
    options.raw = {Index3(10, 10, 10), SampleType::uint8};
    const auto store = open_store(folder / "v.raw", options);
    std::stop_source source;
    source.request_stop();
    std::vector<std::byte> out(1000);
    EXPECT_THROW(store->read(0, {Index3::Zero(), Index3(9, 9, 9)}, out, source.get_token()),
                 Cancelled);
}

TEST(PlainFile, real_files_give_what_reading_them_whole_gives) {
    int read = 0;
    for (const char* name : {"anatomical_be.nii", "HeadMRVolume.mhd"}) {
        if (!std::filesystem::exists(real_volume(name))) continue;
        expect_same_boxes(*open_store(real_volume(name)), io::read_volume(real_volume(name)).volume,
                          9);
        ++read;
    }
    if (read == 0) GTEST_SKIP() << "no real volumes";
}

}  // namespace
}  // namespace palpate::stream::test
