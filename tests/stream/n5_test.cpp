// N5 against an independent writer, in the layouts that programs use, and damaged stores.
#include <cstdlib>
#include <filesystem>

#include "io/volume_support.hpp"
#include "stream/volume_server.hpp"
#include "stream/written_files.hpp"

namespace palpate::stream::test {
namespace {

namespace fs = std::filesystem;
using io::Stored;
using support::bytes_of;
using support::contains;
using support::message_of;
using support::put_bytes;
using support::ScratchFolder;

const fs::path& n5_written() {
    return written_by("n5");
}

void expect_samples(const Store& store, int level, const std::string& raw, Stored stored) {
    expect_level(store, level, n5_written() / raw, stored);
}

TEST(N5, every_type_and_compression_reads_as_another_program_wrote_it_whole_blocks_and_cut_ones) {
    int stores = 0;
    for (const auto& entry : fs::directory_iterator(n5_written())) {
        const std::string name = entry.path().filename().string();
        if (!entry.is_directory() || (!name.starts_with("n5-") && !name.starts_with("cut-"))) {
            continue;
        }
        SCOPED_TRACE(name);
        ASSERT_TRUE(is_store(entry.path()));
        const auto store = open_store(entry.path());
        EXPECT_EQ(store->info().format, "N5");
        EXPECT_EQ(store->info().levels.at(0).geometry.size, Index3(17, 13, 11));
        EXPECT_EQ(store->info().levels[0].chunk, Index3(6, 5, 4));
        expect_samples(*store, 0, name, stored_in(name));
        ++stores;
    }
    EXPECT_EQ(stores, 31 + 12);
}

TEST(N5, levels_have_the_scales_and_places_of_each_programs_attributes) {
    for (const char* name : {"scales", "factors", "units", "transform", "bare"}) {
        SCOPED_TRACE(name);
        const bool bare = std::string(name) == "bare", moved = std::string(name) == "transform";
        const auto store = open_store(n5_written() / ("group-" + std::string(name) + ".n5"));
        const StoreInfo& info = store->info();
        ASSERT_EQ(info.levels.size(), 2U);
        const Vec3 finest = bare ? Vec3(1, 1, 1) : Vec3(4e-3, 5e-3, 6e-3);
        EXPECT_TRUE(info.levels[0].geometry.spacing.isApprox(finest));
        EXPECT_TRUE(info.levels[1].geometry.spacing.isApprox(finest.cwiseProduct(Vec3(2, 2, 1))));
        // In the middle of the samples that it is the mean of, unless it says where it is.
        const Vec3 origin =
            moved ? Vec3(12e-6, 20e-6, 30e-6) : Vec3(finest.cwiseProduct(Vec3(0.5, 0.5, 0)));
        EXPECT_TRUE(info.levels[1].geometry.origin.isApprox(origin))
            << info.levels[1].geometry.origin.transpose();
        EXPECT_EQ(info.notes.size(), bare ? 2U : 0U);
        for (int level = 0; level < 2; ++level) {
            expect_samples(*store, level, "group-" + std::to_string(level), Stored::uint16);
        }
    }
}

TEST(N5, setups_and_times_of_bigdataviewer_are_channels_and_times) {
    for (int setup = 0; setup < 2; ++setup) {
        for (int time = 0; time < 3; ++time) {
            const auto store = open_store(n5_written() / "bdv.n5", choice_of(setup, time));
            const StoreInfo& info = store->info();
            EXPECT_EQ(info.times, 3);
            EXPECT_EQ(info.channels, (std::vector<std::string>{"setup 0", "setup 1"}));
            EXPECT_EQ(info.levels.at(1).geometry.spacing, Vec3(1, 1, 2));
            for (int level = 0; level < 2; ++level) {
                expect_samples(*store, level, numbered("bdv", {setup, time, level}),
                               Stored::uint16);
            }
        }
    }
    const auto setup = open_store(n5_written() / "bdv.n5/setup1", choice_of(0, 2));
    EXPECT_EQ(setup->info().times, 3);
    expect_samples(*setup, 0, "bdv-1-2-0", Stored::uint16);
    const auto moment = open_store(n5_written() / "bdv.n5/setup1/timepoint1");
    expect_samples(*moment, 0, "bdv-1-1-0", Stored::uint16);
    expect_refusal("no time 3: it has 3", n5_written() / "bdv.n5", choice_of(0, 3));
}

TEST(N5, channels_of_n5_viewer_and_axes_by_name_or_by_their_number) {
    const auto channels = open_store(n5_written() / "channels.n5", choice_of(1, 0));
    EXPECT_EQ(channels->info().channels.size(), 2U);
    EXPECT_EQ(channels->info().levels.at(1).geometry.spacing, Vec3(2, 4, 3));
    expect_samples(*channels, 0, "channels-1", Stored::uint16);
    const auto four = open_store(n5_written() / "four.n5", choice_of(1, 0));
    expect_samples(*four, 0, "four", Stored::uint8);
    const auto named = open_store(n5_written() / "axes.n5", choice_of(2, 1));
    EXPECT_EQ(named->info().times, 2);
    expect_samples(*named, 0, "axes", Stored::uint8);
}

TEST(N5, over_http_it_is_found_by_its_name_or_without_it) {
    const VolumeServer server({"--folder", n5_written().string()});
    const auto named = open_store(server.address("bdv.n5"));
    expect_samples(*named, 0, "bdv-0-0-0", Stored::uint16);
    const ScratchFolder folder;
    fs::copy(n5_written() / "group-scales.n5", folder / "scales", fs::copy_options::recursive);
    const VolumeServer other({"--folder", folder.path().string()});
    expect_samples(*open_store(other.address("scales")), 1, "group-1", Stored::uint16);
    expect_refusal("has no metadata of Zarr (zarr.json, .zgroup, .zarray) or N5",
                   server.address("absent.n5"));
}

TEST(N5, mutated_and_truncated_stores_are_refused_in_one_line_or_read) {
    std::mt19937 random(12);
    int refused = 0, tried = 0;
    for (const char* name : {"n5-0-gzip-u1.n5", "cut-raw-i2.n5", "cut-lz4-f4.n5", "cut-zstd-u1.n5",
                             "group-transform.n5", "bdv.n5"}) {
        refused += refused_of_damaged(n5_written() / name, 60, random);
        tried += 60;
    }
    EXPECT_GT(refused, tried / 3);
}

constexpr const char* one_block =
    R"({"dimensions":[2,2,2],"blockSize":[2,2,2],"dataType":"uint8","compression":{"type":"raw"}})";

/// A dataset of one raw block of 2 x 2 x 2 bytes with these bytes, and these attributes.
void put_dataset(const fs::path& folder, const std::string& block,
                 const std::string& attributes = one_block) {
    fs::create_directories(folder / "0/0");
    put_bytes(folder / "attributes.json", attributes);
    put_bytes(folder / "0/0/0", block);
}

std::string header(unsigned mode, std::vector<unsigned> sizes) {
    std::string bytes = {'\0', static_cast<char>(mode), '\0', static_cast<char>(sizes.size())};
    for (const unsigned size : sizes) {
        for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(size >> shift);
    }
    return bytes;
}

TEST(N5, blocks_that_are_not_possible_are_refused_with_what_is_wrong) {
    struct Wrong {
        std::string block;
        const char* what;
    };
    const std::string samples(8, 'x');
    for (const Wrong& wrong : std::vector<Wrong>{
             {header(1, {2, 2, 2}) + samples, "varying length (N5's mode 1), which is not read"},
             {header(2, {2, 2, 2}) + samples, "objects (N5's mode 2), which is not"},
             {header(3, {2, 2, 2}) + samples, "mode 3; the chunk is damaged"},
             {header(0, {2, 2}) + samples, "another number of axes"},
             {header(0, {2, 2, 3}) + samples, "size that is not possible"},
             {header(0, {2, 0, 2}) + samples, "size that is not possible"},
             {header(0, {2, 2, 0xFFFFFFFF}) + samples, "size that is not possible"},
             {header(0, {2, 2, 1}) + samples, "8 bytes instead of the 4"},
             {std::string("\0\0\0\3", 4), "too short for the header"}}) {
        const ScratchFolder folder;
        put_dataset(folder / "a.n5", wrong.block);
        const auto store = open_store(folder / "a.n5");
        const std::string message = message_of<io::InputError>([&] { (void)volume_of(*store); });
        EXPECT_TRUE(contains(message, wrong.what)) << message;
        EXPECT_TRUE(contains(message, "a.n5/0/0/0: ")) << message;
    }
}

TEST(N5, attributes_that_are_not_possible_are_refused_with_what_is_wrong) {
    struct Wrong {
        const char *from, *to, *what;
    };
    for (const Wrong& wrong : std::vector<Wrong>{
             {"[2,2,2],\"dataType", "[2,2],\"dataType", "do not agree"},
             {"[2,2,2]", "[2,2,0]", "size in its metadata is not possible"},
             {"uint8", "string", "type 'string'"},
             {"raw", "bzip2", "'bzip2' is not read"},
             {"[2,2,2],\"dataType", "[9999,9999,9999],\"dataType", "more than 1 GiB"},
             {R"(,"compression":{"type":"raw"})", "", "lack what they need"},
             {one_block, R"({"n5":"2.0"})", "a group of N5 without samples"},
             {one_block, "{", "is not JSON"}}) {
        std::string attributes = one_block;
        attributes.replace(attributes.find(wrong.from), std::strlen(wrong.from), wrong.to);
        const ScratchFolder folder;
        put_dataset(folder / "a.n5", "", attributes);
        const std::string message = refusal(folder / "a.n5");
        EXPECT_TRUE(contains(message, wrong.what)) << message;
        EXPECT_TRUE(io::test::one_line_about(message, folder / "a.n5") ||
                    contains(message, "a.n5/attributes.json"));
    }
}

}  // namespace
}  // namespace palpate::stream::test
