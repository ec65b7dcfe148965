// Tiled TIFF against an independent writer and libtiff's whole reading, and damaged files.
#include <cstdlib>
#include <filesystem>

#include "io/volume_support.hpp"
#include "palpate/io/volume_file.hpp"
#include "stream/formats/undo_codecs.hpp"
#include "stream/written_files.hpp"

namespace palpate::stream::test {
namespace {

namespace fs = std::filesystem;
using io::Stored;
using support::bytes_of;
using support::contains;
using support::message_of;
using support::ScratchFolder;

const fs::path& tiff_written() {
    return written_by("tiff");
}

TEST(Tiff, every_type_byte_order_and_compression_reads_as_written_and_as_libtiff_reads_it) {
    int files = 0;
    for (const auto& entry : fs::directory_iterator(tiff_written())) {
        const std::string name = entry.path().filename().string();
        if (!name.starts_with("kind-") || entry.path().extension() != ".tif") continue;
        SCOPED_TRACE(name);
        ASSERT_TRUE(is_store(entry.path()));
        EXPECT_FALSE(is_chunked(entry.path()));  // it has no coarser levels
        const auto store = open_store(entry.path());
        EXPECT_EQ(store->info().levels.at(0).geometry.size, Index3(70, 45, 3));
        EXPECT_EQ(store->info().levels[0].chunk, Index3(32, 16, 1));
        expect_level(*store, 0, tiff_written() / name, stored_in(name));
        const io::VolumeFile whole = io::read_volume(entry.path());
        EXPECT_EQ(read_box(*store, 0, whole_box(whole.volume.geometry())),
                  box_of(whole.volume, whole_box(whole.volume.geometry())));
        ++files;
    }
    EXPECT_EQ(files, 2 * (4 * 4 + 3 * 4));
}

TEST(Tiff, levels_channels_and_times_of_an_ome_pyramid_are_those_of_its_xml) {
    for (const std::string name : {"pyramid-TCZYX.ome.tif", "pyramid-TZCYX.ome.tif"}) {
        ASSERT_TRUE(is_chunked(tiff_written() / name));
        for (int time = 0; time < 3; ++time) {
            for (int channel = 0; channel < 2; ++channel) {
                const auto store = open_store(tiff_written() / name, choice_of(channel, time));
                const StoreInfo& info = store->info();
                EXPECT_EQ(info.format, "OME-TIFF");
                EXPECT_EQ(info.times, 3);
                EXPECT_DOUBLE_EQ(info.frame_interval, 0.1);
                EXPECT_EQ(info.channels, (std::vector<std::string>{"nuclei", "membrane"}));
                EXPECT_TRUE(info.notes.empty());
                ASSERT_EQ(info.levels.size(), 3U);
                const Vec3 finest(0.5e-3, 0.25e-3, 2e-3);
                for (int level = 0; level < 3; ++level) {
                    const Geometry& grid = info.levels[static_cast<std::size_t>(level)].geometry;
                    const double factor = 1 << level;
                    EXPECT_TRUE(
                        grid.spacing.isApprox(finest.cwiseProduct(Vec3(factor, factor, 1))));
                    EXPECT_TRUE(grid.origin.isApprox(
                        finest.cwiseProduct(Vec3(factor - 1, factor - 1, 0)) / 2));
                    expect_level(*store, level,
                                 tiff_written() / numbered(name, {level, time, channel}),
                                 Stored::uint16);
                }
            }
        }
    }
    expect_refusal("no channel 2: it has 2", tiff_written() / "pyramid-TCZYX.ome.tif",
                   choice_of(2, 0));
}

TEST(Tiff, coarser_levels_are_sub_directories_or_reduced_pages) {
    const auto pages = open_store(tiff_written() / "pages.tif");
    ASSERT_EQ(pages->info().levels.size(), 3U);
    for (int level = 0; level < 3; ++level) {
        expect_level(*pages, level, tiff_written() / numbered("pages", {level}), Stored::uint8);
    }
    const auto pyramid = open_store(tiff_written() / "pyramid.tif");
    EXPECT_EQ(pyramid->info().levels.size(), 2U);
    expect_level(*pyramid, 0, tiff_written() / "pyramid", Stored::uint16);
    EXPECT_TRUE(contains(pyramid->info().notes.at(0), "does not tell its spacing"));
}

TEST(Tiff, what_is_not_read_is_refused_with_what_is_wrong) {
    const std::pair<const char*, const char*> wrong[] = {
        {"colours.tif", "has colours"},
        {"order.ome.tif", "DimensionOrder 'YXZCT'"},
        {"planes.ome.tif", "does not tell where all its planes are"},
        {"size.ome.tif", "SizeC '0'"},
        {"xml.ome.tif", "OME-XML is no XML"},
        {"files.ome.tif", "planes in 'a.tif', others in 'b.tif'"}};
    for (const auto& [name, what] : wrong) {
        const fs::path file = tiff_written() / ("refused-" + std::string(name));
        const std::string message = refusal(file);
        EXPECT_TRUE(contains(message, what)) << message;
        EXPECT_TRUE(io::test::one_line_about(message, file)) << message;
    }
}

TEST(Tiff, mutated_and_truncated_files_are_refused_in_one_line_or_read) {
    std::mt19937 random(14);
    int refused = 0;
    const ScratchFolder folder;
    for (const char* name : {"pyramid-TCZYX.ome.tif", "pages.tif", "pyramid.tif"}) {
        const std::string good = bytes_of(tiff_written() / name);
        const fs::path file = folder / name;
        support::put_bytes(file, good);
        refused += refused_of_damaged(file, 10, random);
        // The beginning and the end, where the directories are.
        for (int i = 0; i < 10; ++i) {
            std::string bad = good;
            const std::size_t near = random() % 400;
            bad[i % 2 == 0 ? near : bad.size() - 1 - near] = static_cast<char>(random());
            support::put_bytes(file, bad);
            refused += !is_store(file) || !read_or_refused(file);
        }
    }
    EXPECT_GT(refused, 12);
}

TEST(Lzw, a_small_stream_that_unpacks_to_more_than_declared_is_refused_at_the_first_byte) {
    // Clear, then 0, then each code the one that is made by it: strings of 1, 2, 3, ... zeros.
    std::vector<std::byte> packed;
    std::uint32_t bits = 0;
    int held = 0;
    const auto put = [&](unsigned code, int width) {
        bits = bits << width | code;
        for (held += width; held >= 8; held -= 8) {
            packed.push_back(static_cast<std::byte>(bits >> (held - 8)));
        }
    };
    put(256, 9);
    put(0, 9);
    for (unsigned code = 258; code < 500; ++code) put(code, 9);
    put(257, 9);  // the end
    put(0, 7);
    EXPECT_THROW((void)unlzw(packed, 1000), DamagedChunk);
    const std::size_t all = 243 * 244 / 2;
    EXPECT_EQ(unlzw(packed, all), std::vector<std::byte>(all));
}

}  // namespace
}  // namespace palpate::stream::test
