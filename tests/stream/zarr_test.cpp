// Zarr and OME-Zarr against an independent writer and reader, and damaged stores.
#include <algorithm>
#include <cstdlib>
#include <filesystem>

#include "io/real_volumes.hpp"
#include "io/volume_support.hpp"
#include "stream/written_files.hpp"

namespace palpate::stream::test {
namespace {

namespace fs = std::filesystem;
using io::test::real_volume;
using support::bytes_of;
using support::contains;
using support::message_of;
using support::put_bytes;
using support::ScratchFolder;

const fs::path& written() {
    return written_by("zarr");
}

/// By the bytes of a sample and the type that the store gives them.
io::Stored stored_of(const Store& store, std::size_t each) {
    using io::Stored;
    switch (store.info().type) {
        case SampleType::uint8:
            return Stored::uint8;
        case SampleType::int16:
            return each == 1 ? Stored::int8 : Stored::int16;
        case SampleType::uint16:
            return Stored::uint16;
        case SampleType::float32:
            break;
    }
    if (each == 4) {
        const auto& notes = store.info().notes;
        const bool whole = !notes.empty() && contains(notes.front() + notes.back(), "int32");
        return whole ? Stored::int32 : Stored::float32;
    }
    const auto& notes = store.info().notes;
    const bool whole = !notes.empty() && contains(notes.front() + notes.back(), "uint64");
    return whole ? Stored::uint64 : Stored::float64;
}

TEST(Zarr, every_type_codec_order_and_separator_reads_as_another_program_wrote_it) {
    int stores = 0;
    for (const auto& entry : fs::directory_iterator(written())) {
        const std::string name = entry.path().filename().string();
        if (!entry.is_directory() || name == "ome.zarr") continue;
        SCOPED_TRACE(name);
        ASSERT_TRUE(is_store(entry.path()));
        const auto store = open_store(entry.path());
        const Geometry& grid = store->info().levels.at(0).geometry;
        EXPECT_EQ(grid.size, Index3(17, 13, 11));
        EXPECT_EQ(store->info().levels[0].chunk, Index3(6, 5, 4));
        const std::string raw = bytes_of(entry.path().string() + ".raw");
        const std::size_t each = raw.size() / static_cast<std::size_t>(sample_count(grid));
        expect_same_boxes(*store, expected_volume(grid, raw, stored_of(*store, each)), 1);
        ++stores;
    }
    EXPECT_EQ(stores, 42 + 1 + 6 + 4);
}

TEST(Zarr, a_chunk_that_is_not_stored_has_the_fill_value) {
    const auto store = open_store(written() / "v2-missing.zarr");
    EXPECT_EQ(store->info().fill, -7);
    const auto bytes = read_box(*store, 0, {Index3(0, 12, 10), Index3(0, 12, 10)});
    std::int16_t value = 0;
    std::memcpy(&value, bytes.data(), sizeof value);
    EXPECT_EQ(value, -7);
}

TEST(Zarr, what_needs_no_configuration_may_be_given_by_its_name_alone) {
    const ScratchFolder folder;
    const std::string shards =
        R"([{"name":"sharding_indexed","configuration":{"chunk_shape":[4,4,4],)"
        R"("codecs":["bytes","zstd"],"index_codecs":)"
        R"([{"name":"bytes","configuration":{"endian":"little"}},"crc32c"]}}])";
    for (const std::string& codecs : {std::string(R"(["bytes","crc32c"])"), shards}) {
        fs::create_directories(folder / "a.zarr");
        put_bytes(folder / "a.zarr/zarr.json",
                  R"({"zarr_format":3,"node_type":"array","shape":[8,8,8],"fill_value":7,)"
                  R"("chunk_grid":{"name":"regular","configuration":{"chunk_shape":[8,8,8]}},)"
                  R"("chunk_key_encoding":"default","data_type":{"name":"uint8"},"codecs":)" +
                      codecs + "}");
        EXPECT_EQ(open_store(folder / "a.zarr")->info().fill, 7) << codecs;
    }
}

TEST(Zarr, axes_without_names_are_taken_by_their_number_and_that_is_said) {
    const ScratchFolder folder;
    for (const auto& [shape, told] : {std::pair{"[2,2,2]", ""},
                                      {"[3,2,2,2]", "taken as channels, z, y, x"},
                                      {"[4,3,2,2,2]", "taken as times, channels, z, y, x"}}) {
        fs::create_directories(folder / "a.zarr");
        put_bytes(folder / "a.zarr/.zarray",
                  std::string(R"({"zarr_format":2,"dtype":"|u1","compressor":null,"fill_value":0,)"
                              R"("order":"C","filters":null,"shape":)") +
                      shape + R"(,"chunks":)" + shape + "}");
        const auto store = open_store(folder / "a.zarr");
        std::string notes;
        for (const std::string& note : store->info().notes) notes += note;
        EXPECT_EQ(contains(notes, "axes have no names"), *told != 0) << notes;
        EXPECT_TRUE(contains(notes, told)) << notes;
    }
}

TEST(OmeZarr, channel_time_scale_and_translation_of_each_level_are_those_of_its_metadata) {
    for (int time = 0; time < 2; ++time) {
        for (int channel = 0; channel < 3; ++channel) {
            const auto store = open_store(written() / "ome.zarr", choice_of(channel, time));
            const StoreInfo& info = store->info();
            EXPECT_EQ(info.format, "OME-Zarr 0.4");
            EXPECT_EQ(info.times, 2);
            EXPECT_DOUBLE_EQ(info.frame_interval, 0.04);
            EXPECT_EQ(info.channels, (std::vector<std::string>{"nuclei", "membrane", "channel 2"}));
            ASSERT_EQ(info.levels.size(), 2U);
            EXPECT_TRUE(info.levels[0].geometry.spacing.isApprox(Vec3(2e-3, 4e-3, 6e-3)));
            EXPECT_TRUE(info.levels[1].geometry.spacing.isApprox(Vec3(4e-3, 8e-3, 12e-3)));
            EXPECT_TRUE(info.levels[0].geometry.origin.isApprox(Vec3(30e-3, 20e-3, 10e-3)));
            EXPECT_TRUE(info.levels[1].geometry.origin.isApprox(Vec3(31e-3, 22e-3, 13e-3)));
            for (int level = 0; level < 2; ++level) {
                expect_level(*store, level, written() / numbered("ome", {level, time, channel}),
                             io::Stored::uint16);
            }
        }
    }
    expect_refusal("no channel 3: it has 3", written() / "ome.zarr", choice_of(3, 0));
}

TEST(Zarr, the_greatest_number_may_be_the_fill_value_and_an_index_of_shards_big_endian) {
    const ScratchFolder folder;
    fs::create_directories(folder / "a.zarr");
    support::put_bytes(folder / "a.zarr/.zarray",
                       R"({"zarr_format": 2, "shape": [2, 2, 2], "chunks": [2, 2, 2], )"
                       R"("dtype": "<u8", "compressor": null, "order": "C", "filters": null, )"
                       R"("fill_value": 18446744073709551615})");
    EXPECT_FLOAT_EQ(static_cast<float>(open_store(folder / "a.zarr")->info().fill), 0x1p64F);
    fs::create_directories(folder / "b.zarr/c/0/0");
    support::put_bytes(
        folder / "b.zarr/zarr.json",
        R"({"zarr_format": 3, "node_type": "array", "shape": [2, 1, 1], "data_type": "uint8", )"
        R"("chunk_grid": {"name": "regular", "configuration": {"chunk_shape": [2, 1, 1]}}, )"
        R"("chunk_key_encoding": {"name": "default"}, "fill_value": 0, "codecs": [{"name": )"
        R"("sharding_indexed", "configuration": {"chunk_shape": [1, 1, 1], "codecs": )"
        R"([{"name": "bytes"}], "index_codecs": [{"name": "bytes", "configuration": )"
        R"({"endian": "big"}}]}}]})");
    std::string shard = "xy";
    for (const char number : {0, 1, 1, 1}) shard += std::string(7, '\0') + number;
    support::put_bytes(folder / "b.zarr/c/0/0/0", shard);
    const auto store = open_store(folder / "b.zarr");
    EXPECT_EQ(read_box(*store, 0, {{0, 0, 0}, {0, 0, 1}}),
              (std::vector{std::byte{'x'}, std::byte{'y'}}));
}

TEST(OmeZarr, the_first_series_is_that_of_the_list) {
    const ScratchFolder folder;
    const auto put = [&](const std::string& name, const std::string& text) {
        fs::create_directories((folder / name).parent_path());
        support::put_bytes(folder / name, text);
    };
    const std::string group = R"({"zarr_format": 2})";
    put("a.zarr/.zgroup", group);
    put("a.zarr/.zattrs", R"({"bioformats2raw.layout": 3})");
    put("a.zarr/OME/.zgroup", group);
    double scale = 0;
    for (const std::string name : {"0", "1", "left"}) {
        const std::string image = "a.zarr/" + name;
        put(image + "/.zgroup", group);
        put(image + "/.zattrs",
            R"({"multiscales": [{"version": "0.4", "axes": [{"name": "z", "type": "space"}, )"
            R"({"name": "y", "type": "space"}, {"name": "x", "type": "space"}], "datasets": )"
            R"([{"path": "0", "coordinateTransformations": [{"type": "scale", "scale": [1, 1, )" +
                std::to_string(++scale) + "]}]}]}]}");
        put(image + "/0/.zarray",
            R"({"zarr_format": 2, "shape": [2, 2, 2], "chunks": [2, 2, 2], "dtype": "|u1", )"
            R"("compressor": null, "fill_value": 0, "order": "C", "filters": null})");
    }
    const auto spacing_with = [&](const std::string& series) {
        put("a.zarr/OME/.zattrs", series);
        return open_store(folder / "a.zarr")->info().levels.at(0).geometry.spacing.x();
    };
    EXPECT_EQ(spacing_with(R"({"series": ["0", "1"]})"), 1);
    EXPECT_EQ(spacing_with(R"({"series": ["1", "0"]})"), 2);
    EXPECT_EQ(spacing_with(R"({"series": ["left", "0"]})"), 3);
    EXPECT_EQ(spacing_with(R"({"series": ["../a.zarr/left"]})"), 1);
    EXPECT_EQ(spacing_with("{}"), 1);
}

TEST(OmeZarr, an_axis_without_a_unit_has_that_of_the_others) {
    const ScratchFolder folder;
    const std::string space = R"("type": "space")", um = R"(, "unit": "micrometer")";
    const auto zattrs = [&](const std::string& z, const std::string& y) {
        return R"({"multiscales": [{"version": "0.4", "axes": [{"name": "z", )" + space + z +
               R"(}, {"name": "y", )" + space + y + R"(}, {"name": "x", )" + space + y +
               R"(}], "datasets": [{"path": "0", "coordinateTransformations": [)"
               R"({"type": "scale", "scale": [1.0, 0.25, 0.25]}]}]}]})";
    };
    fs::create_directories(folder / "a.zarr/0");
    support::put_bytes(folder / "a.zarr/.zgroup", R"({"zarr_format": 2})");
    support::put_bytes(folder / "a.zarr/0/.zarray",
                       R"({"zarr_format": 2, "shape": [2, 2, 2], "chunks": [2, 2, 2], )"
                       R"("dtype": "|u1", "compressor": null, "fill_value": 0, "order": "C", )"
                       R"("filters": null})");
    const auto says = [](const Store& store, const char* words) {
        return std::ranges::any_of(store.info().notes,
                                   [&](const std::string& note) { return contains(note, words); });
    };
    for (const std::string& z : {std::string(), std::string(R"(, "unit": "pixel")")}) {
        support::put_bytes(folder / "a.zarr/.zattrs", zattrs(z, um));
        const auto store = open_store(folder / "a.zarr");
        const Geometry& grid = store->info().levels.at(0).geometry;
        EXPECT_TRUE(grid.spacing.isApprox(Vec3(0.25e-3, 0.25e-3, 1e-3))) << grid.spacing;
        EXPECT_FALSE(grid.measured);
        EXPECT_TRUE(says(*store, "its axis z has no unit of length"));
    }
    const std::string units = R"(, "units": "micrometer")";
    support::put_bytes(folder / "a.zarr/.zattrs", zattrs(units, units));
    EXPECT_TRUE(open_store(folder / "a.zarr")
                    ->info()
                    .levels.at(0)
                    .geometry.spacing.isApprox(Vec3(0.25e-3, 0.25e-3, 1e-3)));
    support::put_bytes(folder / "a.zarr/.zattrs", zattrs("", ""));
    const auto store = open_store(folder / "a.zarr");
    EXPECT_EQ(store->info().levels.at(0).geometry.spacing, Vec3(0.25, 0.25, 1));
    EXPECT_TRUE(says(*store, "mm were taken"));
}

TEST(OmeZarr, a_spacing_that_is_given_is_that_of_the_finest_level) {
    StoreOptions options;
    options.spacing = Vec3(1, 2, 3);
    const auto store = open_store(written() / "ome.zarr", options);
    EXPECT_TRUE(store->info().levels[0].geometry.spacing.isApprox(Vec3(1, 2, 3)));
    EXPECT_TRUE(store->info().levels[1].geometry.spacing.isApprox(Vec3(2, 4, 6)));
    options.spacing = Vec3(1, 2, 1e-10);
    expect_refusal("1e-10 mm is outside 1e-9 to 1e9 mm", written() / "ome.zarr", options);
}

/// The first array of a Zarr 2 image by python3-zarr, and of its twin of version 3 by us.
void expect_same_as_reference(const fs::path& v4, const fs::path& v5) {
    const ScratchFolder folder;
    for (const char* level : {"0", "1"}) {
        const std::string raw = folder / "level.raw";
        ASSERT_EQ(std::system(
                      reference("zarr", "dump " + v4.string() + " " + level + " > " + raw).c_str()),
                  0);
        const std::string samples = bytes_of(raw);
        for (const fs::path& path : {v4, v5}) {
            SCOPED_TRACE(path);
            std::size_t at = 0;
            const auto first = open_store(path);
            const auto channels = std::max<std::size_t>(1, first->info().channels.size());
            for (std::size_t i = 0; i < static_cast<std::size_t>(first->info().times) * channels;
                 ++i) {
                const auto store = open_store(path, choice_of(static_cast<int>(i % channels),
                                                              static_cast<int>(i / channels)));
                const Geometry& grid = store->info().levels.at(level[0] == '0' ? 0 : 1).geometry;
                const auto bytes =
                    static_cast<std::size_t>(sample_count(grid)) * size_of(store->info().type);
                const Volume read = volume_of(*store, level[0] - '0');
                ASSERT_LE(at + bytes, samples.size());
                EXPECT_EQ(std::memcmp(read.data(), samples.data() + at, bytes), 0);
                at += bytes;
            }
            EXPECT_EQ(at, samples.size());
        }
    }
}

TEST(OmeZarr, public_samples_of_both_versions_read_as_python_reads_them) {
    const fs::path data = real_volume("zarr");
    if (!fs::exists(data)) GTEST_SKIP() << "no sample stores";
    for (const char* kind : {"3d_testing/xyz", "3d_testing/xyt", "3d_testing/xyc"}) {
        expect_same_as_reference(data / kind / "3d_dataset_v4.ome.zarr",
                                 data / kind / "3d_dataset_v5.ome.zarr");
    }
    for (const char* kind : {"4d_testing/xyzc", "4d_testing/xyzt", "4d_testing/xyct"}) {
        expect_same_as_reference(data / kind / "4d_dataset_v4.ome.zarr",
                                 data / kind / "4d_dataset_v5.ome.zarr");
    }
    expect_same_as_reference(data / "pyramid_testing/pyramid_v4.zarr",
                             data / "pyramid_testing/pyramid_v5.zarr");
    const auto series = open_store(data / "bioformats2raw_testing/bf2raw_dataset_v5.ome.zarr");
    ASSERT_FALSE(series->info().notes.empty());
    EXPECT_TRUE(contains(series->info().notes.front(), "series 0 was taken; others are 1"));
    EXPECT_EQ(series->info().levels.size(), 2U);
    (void)volume_of(*series);
}

TEST(Zarr, mutated_and_truncated_stores_are_refused_in_one_line_or_read) {
    std::mt19937 random(11);
    int refused = 0, tried = 0;
    for (const char* name : {"v2-5-gzip.zarr", "v2-12-lz4.zarr", "v2-17-blosc-lz4.zarr",
                             "v3-2.zarr", "v3-shards-0.zarr", "v3-shards-1.zarr", "ome.zarr"}) {
        if (!fs::exists(written() / name)) ADD_FAILURE() << name;
        refused += refused_of_damaged(written() / name, 60, random);
        tried += 60;
    }
    EXPECT_GT(refused, tried / 3);
    EXPECT_EQ(tried, 420);
}

struct Hostile {
    const char* what;
    const char* from;
    const char* to;
};

TEST(Zarr, impossible_metadata_are_refused_with_what_is_wrong) {
    const ScratchFolder folder;
    const std::string good =
        R"({"zarr_format":2,"shape":[4,4,4],"chunks":[4,4,4],"dtype":"|u1","compressor":null,)"
        R"("fill_value":0,"order":"C","filters":null})";
    fs::create_directories(folder / "a.zarr");
    for (const auto& [what, from, to] : std::initializer_list<Hostile>{
             {"not possible", R"("shape":[4,4,4])", R"("shape":[4,-4,4])"},
             {"2^30", R"("shape":[4,4,4])", R"("shape":[4,4,10000000000])"},
             {"1 GiB", R"("chunks":[4,4,4])", R"("chunks":[100000,100000,4])"},
             {"no list of whole numbers", R"("chunks":[4,4,4])", R"("chunks":[4,4.5,4])"},
             {"do not agree", R"("chunks":[4,4,4])", R"("chunks":[4,4])"},
             {"store it as integers", "|u1", "<c8"},
             {"codec 'bz2' is not read", R"("compressor":null)", R"("compressor":{"id":"bz2"})"},
             {"filter 'delta' is not read", R"("filters":null)", R"("filters":[{"id":"delta"}])"},
             {"order", R"("order":"C")", R"("order":"Z")"},
             {"is not JSON", "{", "{{"},
             {"lack what they need", R"("chunks":)", R"("chunk":)"}}) {
        std::string text = good;
        text.replace(text.find(from), std::strlen(from), to);
        put_bytes(folder / "a.zarr/.zarray", text);
        expect_refusal(what, folder / "a.zarr");
    }
}

TEST(Zarr, a_small_chunk_that_unpacks_to_gigabytes_is_refused_at_its_declared_size) {
    const ScratchFolder folder;
    fs::create_directories(folder / "a.zarr");
    put_bytes(folder / "a.zarr/.zarray",
              R"({"zarr_format":2,"shape":[4,4,4],"chunks":[4,4,4],"dtype":"|u1",)"
              R"("compressor":{"id":"gzip"},"fill_value":0,"order":"C","filters":null})");
    io::test::put_gzip(folder / "a.zarr/0.0.0", std::string(50'000, '\0'));
    const auto store = open_store(folder / "a.zarr");
    const std::string message = message_of<io::InputError>([&] { (void)volume_of(*store); });
    EXPECT_TRUE(contains(message, "unpacks to more than the 64 bytes")) << message;
}

TEST(OmeZarr, a_level_outside_of_the_folder_is_refused) {
    const ScratchFolder folder;
    fs::create_directories(folder / "a.zarr");
    put_bytes(folder / "a.zarr/.zgroup", R"({"zarr_format":2})");
    put_bytes(folder / "a.zarr/.zattrs",
              R"({"multiscales":[{"axes":["z","y","x"],"datasets":[{"path":"../secret"}]}]})");
    expect_refusal("leads out of it", folder / "a.zarr");
}

}  // namespace
}  // namespace palpate::stream::test
