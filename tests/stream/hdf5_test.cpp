// Imaris and BigDataViewer files against an independent writer and reader, and damaged ones.
#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "io/real_volumes.hpp"
#include "io/volume_support.hpp"
#include "stream/written_files.hpp"

namespace palpate::stream::test {
namespace {

namespace fs = std::filesystem;
using io::Stored;
using io::test::real_volume;
using support::bytes_of;
using support::contains;
using support::message_of;
using support::ScratchFolder;

const fs::path& hdf5_written() {
    return written_by("hdf5");
}

TEST(Hdf5, every_type_and_filter_reads_as_another_program_wrote_it) {
    int files = 0;
    for (const auto& entry : fs::directory_iterator(hdf5_written())) {
        const std::string name = entry.path().filename().string();
        if (!name.starts_with("ims-") || entry.path().extension() != ".ims") continue;
        SCOPED_TRACE(name);
        ASSERT_TRUE(is_store(entry.path()) && is_chunked(entry.path()));
        const auto store = open_store(entry.path());
        EXPECT_EQ(store->info().levels.at(0).geometry.size, Index3(17, 13, 11));
        EXPECT_TRUE(store->info().levels[0].geometry.spacing.isApprox(Vec3(2e-3, 2e-3, 3e-3)));
        EXPECT_TRUE(store->info().levels[0].geometry.origin.isApprox(Vec3(11e-3, 21e-3, 31.5e-3)));
        expect_level(*store, 0, hdf5_written() / name, stored_in(name));
        ++files;
    }
    EXPECT_EQ(files, 24 + 9);
}

TEST(Hdf5, the_range_of_an_imaris_histogram_holds_every_sample) {
    for (const auto& entry : fs::directory_iterator(hdf5_written())) {
        const std::string name = entry.path().filename().string();
        if (!contains(name, "-shuffled-") || entry.path().extension() != ".ims") continue;
        const auto store = open_store(entry.path());
        const Volume volume = volume_of(*store);
        ASSERT_TRUE(store->info().range) << name;
        // Imaris's numbers have three digits; wide integers are rounded to float32.
        const double low = volume.minimum(), high = volume.maximum(), digits = 1e-3;
        const Range& range = *store->info().range;
        EXPECT_LE(range.minimum, low + digits + 1e-6 * std::abs(low)) << name;
        EXPECT_GE(range.maximum, high - digits - 1e-6 * std::abs(high)) << name;
        EXPECT_LE(range.maximum - range.minimum, 1.01 * (high - low) + 2 * digits) << name;
    }
}

TEST(Hdf5, levels_channels_and_times_of_imaris_are_those_of_its_attributes) {
    for (int time = 0; time < 3; ++time) {
        for (int channel = 0; channel < 2; ++channel) {
            const auto store = open_store(hdf5_written() / "image.ims", choice_of(channel, time));
            const StoreInfo& info = store->info();
            EXPECT_EQ(info.format, "Imaris");
            EXPECT_EQ(info.times, 3);
            EXPECT_NEAR(info.frame_interval, 0.5, 1e-9);
            EXPECT_EQ(info.channels, (std::vector<std::string>{"nuclei", "membrane"}));
            EXPECT_TRUE(info.notes.empty());
            ASSERT_EQ(info.levels.size(), 3U);
            const Vec3 finest(0.5e-3, 1e-3, 2e-3), corner(0, 10e-3, 20e-3);
            const Vec3 factors[] = {{1, 1, 1}, {2, 2, 1}, {4, 4, 2}};
            for (int level = 0; level < 3; ++level) {
                const Geometry& grid = info.levels[static_cast<std::size_t>(level)].geometry;
                EXPECT_TRUE(grid.spacing.isApprox(finest.cwiseProduct(factors[level])));
                EXPECT_TRUE(grid.origin.isApprox(corner + grid.spacing / 2));
                expect_level(*store, level,
                             hdf5_written() / numbered("image", {level, time, channel}),
                             Stored::uint16);
            }
        }
    }
    expect_refusal("no time 3: it has 3", hdf5_written() / "image.ims", choice_of(0, 3));
}

TEST(Hdf5, a_chunk_that_is_not_stored_has_the_fill_value) {
    const auto store = open_store(hdf5_written() / "missing.ims");
    EXPECT_EQ(store->info().fill, -7);
    expect_level(*store, 0, hdf5_written() / "missing", Stored::int16);
    EXPECT_TRUE(contains(store->info().notes.at(0), "micrometres were taken"));
}

TEST(Hdf5, a_fill_value_of_bigdataviewer_loses_its_sign_as_its_samples_do) {
    for (const std::string name : {"plain", "gzip", "latest", "typed", "contiguous"}) {
        SCOPED_TRACE(name);
        const auto store = open_store(hdf5_written() / ("missing-" + name + ".h5"));
        EXPECT_EQ(store->info().fill, 65000);
        expect_level(*store, 0, hdf5_written() / ("missing-" + name), Stored::uint16);
    }
}

TEST(Hdf5, setups_and_times_of_bigdataviewer_are_channels_and_times_with_the_xml_s_voxels) {
    for (int time = 0; time < 2; ++time) {
        for (int setup = 0; setup < 2; ++setup) {
            for (const char* name : {"bdv.h5", "lonely.h5"}) {
                const auto store = open_store(hdf5_written() / name, choice_of(setup, time));
                const StoreInfo& info = store->info();
                const bool lonely = std::string(name) == "lonely.h5";
                EXPECT_EQ(info.channels.at(0), lonely ? "setup 0" : "left");
                EXPECT_EQ(info.notes.size(), lonely ? 1U : 0U);
                const Vec3 spacing = lonely       ? Vec3(1, 1, 1)
                                     : setup == 0 ? Vec3(0.5e-3, 0.25e-3, 2e-3)
                                                  : Vec3(1, 2, 3);
                EXPECT_TRUE(info.levels.at(1).geometry.spacing.isApprox(
                    spacing.cwiseProduct(Vec3(2, 2, 1))));
                EXPECT_TRUE(info.levels[1].geometry.origin.isApprox(
                    spacing.cwiseProduct(Vec3(0.5, 0.5, 0))));
                for (int level = 0; level < 2; ++level) {
                    expect_level(*store, level,
                                 hdf5_written() / numbered("bdv", {level, time, setup}),
                                 Stored::uint16);
                }
            }
        }
    }
}

TEST(Hdf5, voxels_of_bigdataviewer_in_pixels_are_not_measured) {
    const ScratchFolder folder;
    support::put_bytes(folder / "bdv.h5", bytes_of(hdf5_written() / "bdv.h5"));
    const std::string xml = bytes_of(hdf5_written() / "bdv.xml");
    for (const auto& [unit, measured] : {std::pair{"mm", true}, {"pixel", false}, {"px", false}}) {
        std::string text = xml;
        text.replace(text.find("<unit>mm"), 8, std::string("<unit>") + unit);
        support::put_bytes(folder / "bdv.xml", text);
        const auto store = open_store(folder / "bdv.h5", choice_of(1, 0));
        EXPECT_EQ(store->info().levels.at(0).geometry.measured, measured) << unit;
        EXPECT_EQ(store->info().levels[0].geometry.spacing, Vec3(1, 2, 3));
        EXPECT_EQ(store->info().notes.size(), measured ? 0U : 1U);
    }
}

TEST(Hdf5, registrations_of_bigdataviewer_that_stretch_count_where_no_voxel_size_does) {
    struct Case {
        const char *size, *affine;
        Vec3 spacing;
        const char* note;  ///< empty: none
    };
    const Case cases[] = {
        {"1 1 1", "1 0 0 0 0 1 0 0 0 0 5 0", {1, 1, 5}, "which was taken as their size"},
        {"1 1 1", "3 0 0 0 0 3 0 0 0 0 3 0", {1, 1, 1}, ""},
        {"1 2 8", ".5 0 0 0 0 1 0 0 0 0 4 0", {1, 2, 8}, ""},
        {"1 2 3", "1 0 0 0 0 1 0 0 0 0 5 0", {1, 2, 3}, "does not fit their size of 1 x 2 x 3"},
        {"1 1 1", "-1 0 0 0 0 1 0 0 0 0 1 0", {1, 1, 1}, "mirror"},
        {"1 1 1", "1 0 0 9 0 1 0 0 0 0 1 0", {1, 1, 1}, "move"},
    };
    const ScratchFolder folder;
    support::put_bytes(folder / "bdv.h5", bytes_of(hdf5_written() / "bdv.h5"));
    const std::string xml = bytes_of(hdf5_written() / "bdv.xml");
    for (const Case& one : cases) {
        std::string text = xml;
        text.replace(text.find("<size>1 2 3"), 11, std::string("<size>") + one.size);
        text.insert(text.find("</SpimData>"),
                    "<ViewRegistrations><ViewRegistration timepoint=\"0\" setup=\"0\"/>"
                    "<ViewRegistration timepoint=\"0\" setup=\"1\">"
                    "<ViewTransform type=\"affine\"><affine>" +
                        std::string(one.affine) +
                        "</affine></ViewTransform></ViewRegistration></ViewRegistrations>");
        support::put_bytes(folder / "bdv.xml", text);
        const auto store = open_store(folder / "bdv.h5", choice_of(1, 0));
        const StoreInfo& info = store->info();
        EXPECT_EQ(info.levels.at(0).geometry.spacing, one.spacing) << one.affine;
        ASSERT_EQ(info.notes.size(), *one.note ? 1U : 0U) << one.affine;
        if (*one.note) {
            EXPECT_TRUE(contains(info.notes[0], one.note)) << info.notes[0];
        }
    }
}

TEST(Hdf5, a_public_file_of_imaris_reads_as_h5py_reads_it) {
    const fs::path file = real_volume("minimal.ims");
    if (!fs::exists(file)) GTEST_SKIP() << "no sample file";
    const ScratchFolder folder;
    const std::string raw = folder / "all.raw";
    ASSERT_EQ(std::system(
                  reference("hdf5",
                            "dump " + file.string() +
                                " '/DataSet/ResolutionLevel 0/TimePoint 0/Channel 0/Data' > " + raw)
                      .c_str()),
              0);
    const auto store = open_store(file);
    const Geometry& grid = store->info().levels.at(0).geometry;
    EXPECT_EQ(grid.size, Index3(128, 128, 1));
    EXPECT_TRUE(grid.spacing.isApprox(Vec3(7e-3 / 128, 7e-3 / 128, 1e-4)));
    expect_same_boxes(*store, expected_volume(grid, bytes_of(raw), Stored::uint16), 5);
}

TEST(Hdf5, what_is_not_read_is_refused_with_what_is_wrong) {
    const std::pair<const char*, const char*> wrong[] = {
        {"userblock", "user block"},
        {"other", "of another program"},
        {"filter", "32000 (lzf) is not read"},
        {"bfloat16", "no usual integers or floats"},
        {"extent", "extent"},
        {"backwards", "extent"},
        {"long", "ImageSizeX"},
        {"link", "lies in another file"}};
    for (const auto& [name, what] : wrong) {
        const fs::path file = hdf5_written() / ("refused-" + std::string(name) + ".ims");
        const std::string message = refusal(file);
        EXPECT_TRUE(contains(message, what)) << message;
        EXPECT_TRUE(io::test::one_line_about(message, file)) << message;
    }
}

TEST(Hdf5, mutated_and_truncated_files_are_refused_in_one_line_or_read) {
    std::mt19937 random(13);
    int refused = 0;
    const ScratchFolder folder;
    for (const char* name : {"image.ims", "missing.ims", "bdv.h5"}) {
        const std::string good = bytes_of(hdf5_written() / name);
        const fs::path file = folder / name;
        support::put_bytes(file, good);
        refused += refused_of_damaged(file, 15, random);
    }
    EXPECT_GT(refused, 15);
}

}  // namespace
}  // namespace palpate::stream::test
