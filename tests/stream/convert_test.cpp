// Conversion to OME-Zarr and back: read again by us and by python3-zarr, continued where it was
// left.
#include "palpate/stream/convert.hpp"

#include <utility>

#include "io/volume_support.hpp"
#include "stream/store_support.hpp"
#include "stream/volume_server.hpp"
#include "stream/volumes_store.hpp"

namespace palpate::stream::test {
namespace {

namespace fs = std::filesystem;
using io::test::random_volume;
using support::bytes_of;
using support::contains;
using support::message_of;
using support::put_bytes;
using support::ScratchFolder;

Volume some_volume(SampleType type, unsigned seed = 1) {
    std::mt19937 random(seed);
    Geometry grid = io::test::random_geometry(random, true, false);
    grid.size = Index3(37, 21, 19);
    grid.spacing = Vec3(0.5, 0.6, 1.7);
    return random_volume(random, type, grid);
}

/// The mean of a sample's finer ones, one after the other.
double mean_at(const Volume& finer, const Index3& factor, const Index3& index) {
    double sum = 0;
    int count = 0;
    for (int z = 0; z < factor[2]; ++z) {
        for (int y = 0; y < factor[1]; ++y) {
            for (int x = 0; x < factor[0]; ++x) {
                const Index3 at = index.cwiseProduct(factor) + Index3(x, y, z);
                if ((at.array() >= finer.geometry().size.array()).any()) continue;
                sum += finer.sample(at);
                ++count;
            }
        }
    }
    return sum / count;
}

TEST(Convert, every_type_version_and_compression_reads_back_with_its_place_and_range) {
    const ScratchFolder folder;
    int number = 0;
    for (const int version : {2, 3}) {
        for (const Compression compression :
             {Compression::none, Compression::gzip, Compression::zstd, Compression::blosc}) {
            for (const SampleType type :
                 {SampleType::uint8, SampleType::int16, SampleType::uint16, SampleType::float32}) {
                const Volume volume = some_volume(type);
                const fs::path out = folder / ("v" + std::to_string(number++) + ".zarr");
                ConvertOptions options;
                options.zarr_version = version;
                options.compression = compression;
                options.chunk = 8;
                const Converted converted =
                    convert_to_zarr(*store_of(volume, "v"), 0, out, options);
                EXPECT_EQ(converted.range.minimum, volume.minimum());
                EXPECT_EQ(converted.range.maximum, volume.maximum());
                const auto store = open_store(out);
                EXPECT_EQ(store->info().format, version == 2 ? "OME-Zarr 0.4" : "OME-Zarr 0.5");
                EXPECT_EQ(store->info().range->maximum, volume.maximum());
                EXPECT_EQ(static_cast<int>(store->info().levels.size()), converted.levels);
                const Geometry& grid = store->info().levels[0].geometry;
                EXPECT_TRUE(grid == volume.geometry());
                expect_same_boxes(*store, volume, 3);
            }
        }
    }
}

TEST(Convert, each_coarser_level_is_the_mean_of_the_finer_one_and_lies_where_it_does) {
    const ScratchFolder folder;
    for (const SampleType type : {SampleType::int16, SampleType::float32}) {
        const Volume volume = some_volume(type, 2);
        const fs::path out = folder / (std::string(name_of(type)) + ".zarr");
        ConvertOptions options;
        options.chunk = 8;
        (void)convert_to_zarr(*store_of(volume, "v"), 0, out, options);
        const auto store = open_store(out);
        Volume finer = volume;
        for (std::size_t l = 1; l < store->info().levels.size(); ++l) {
            const Volume level = volume_of(*store, static_cast<int>(l));
            const Geometry& grid = level.geometry();
            const Index3 factor =
                grid.spacing.cwiseQuotient(finer.geometry().spacing).array().round().cast<int>();
            // The centre of the samples that make the first one.
            EXPECT_TRUE(grid.origin.isApprox(
                physical_from_index(finer.geometry(), (factor.cast<double>() - Vec3::Ones()) / 2)));
            for (int z = 0; z < grid.size[2]; ++z) {
                for (int y = 0; y < grid.size[1]; ++y) {
                    for (int x = 0; x < grid.size[0]; ++x) {
                        const double mean = mean_at(finer, factor, {x, y, z});
                        ASSERT_NEAR(level.sample({x, y, z}), mean,
                                    type == SampleType::int16 ? 0.5 : 1e-3);
                    }
                }
            }
            finer = level;
        }
        EXPECT_TRUE((finer.geometry().size.array() <= 8).all());
        // 1.7 mm is left alone until the other axes are as coarse.
        EXPECT_EQ(store->info().levels[1].geometry.size, Index3(19, 11, 19));
    }
}

TEST(Convert, python3_zarr_reads_what_is_written) {
    const ScratchFolder folder;
    for (const Compression compression :
         {Compression::none, Compression::gzip, Compression::zstd, Compression::blosc}) {
        const Volume volume = some_volume(SampleType::uint16, 4);
        const std::string out =
            folder / ("v" + std::to_string(static_cast<int>(compression)) + ".zarr");
        ConvertOptions options;
        options.zarr_version = 2;
        options.compression = compression;
        options.chunk = 16;
        (void)convert_to_zarr(*store_of(volume, "v"), 0, out, options);
        const std::string dump = std::string(PALPATE_ZARR_PYTHON) + " -B " + PALPATE_STREAM_TESTS +
                                 "/zarr_reference.py dump " + out + " 0 > " + out + ".raw";
        ASSERT_EQ(std::system(dump.c_str()), 0);
        const std::string raw = bytes_of(out + ".raw");
        ASSERT_EQ(raw.size(), volume.bytes());
        EXPECT_EQ(std::memcmp(raw.data(), volume.data(), raw.size()), 0);
    }
}

TEST(Convert, chunks_of_zeros_are_not_stored) {
    const ScratchFolder folder;
    std::vector<std::uint8_t> samples(32 * 32 * 32, 0);
    samples[5] = 7;
    Geometry grid;
    grid.size = Index3::Constant(32);
    const Volume volume(grid, std::move(samples));
    ConvertOptions options;
    options.chunk = 16;
    const Converted converted =
        convert_to_zarr(*store_of(volume, "v"), 0, folder / "v.zarr", options);
    EXPECT_EQ(converted.chunks, 9U);
    EXPECT_GE(converted.empty, 7U);
    expect_same_boxes(*open_store(folder / "v.zarr"), volume, 5);
}

struct Stop {};

/// Reports come at any time, the last one when all chunks are written.
void stop_once_some_are_written(double part) {
    if (part > 0) throw Stop{};
}

TEST(Convert, goes_on_where_it_was_interrupted_and_mends_damaged_chunks) {
    const ScratchFolder folder;
    const Volume volume = some_volume(SampleType::int16, 6);
    const auto store = store_of(volume, "v");
    const fs::path out = folder / "v.zarr", partial = folder / "v.zarr.partial";
    ConvertOptions options;
    options.chunk = 8;
    options.threads = 1;
    options.progress = stop_once_some_are_written;
    EXPECT_THROW((void)convert_to_zarr(*store, 0, out, options), Stop);
    ASSERT_TRUE(fs::exists(partial / "result/0/c/0/0/0"));
    put_bytes(partial / "result/0/c/0/0/0", "damaged");
    options.progress = {};
    const Converted converted = convert_to_zarr(*store, 0, out, options);
    EXPECT_GT(converted.kept, 0U);
    EXPECT_LT(converted.kept, converted.chunks);
    EXPECT_EQ(converted.note, "");
    EXPECT_FALSE(fs::exists(partial));
    expect_same_boxes(*open_store(out), volume, 7);
    for (const auto& entry : fs::recursive_directory_iterator(out)) {
        EXPECT_FALSE(contains(entry.path().string(), "part")) << entry.path();
    }
}

TEST(Convert, keeps_complete_chunks_of_the_same_work_only) {
    const ScratchFolder folder;
    const Volume volume = some_volume(SampleType::uint8, 8);
    const auto store = store_of(volume, "v");
    ConvertOptions options;
    options.chunk = 8;
    options.threads = 1;
    const auto stopped = [&] {
        ConvertOptions stopping = options;
        stopping.progress = stop_once_some_are_written;
        EXPECT_THROW((void)convert_to_zarr(*store, 0, folder / "v.zarr", stopping), Stop);
        EXPECT_TRUE(fs::exists(folder / "v.zarr.partial"));
    };
    stopped();
    const Converted again = convert_to_zarr(*store, 0, folder / "v.zarr", options);
    EXPECT_GT(again.kept, 0U);
    fs::remove_all(folder / "v.zarr");
    stopped();
    options.compression = Compression::gzip;
    EXPECT_EQ(convert_to_zarr(*store, 0, folder / "v.zarr", options).kept, 0U);
    expect_same_boxes(*open_store(folder / "v.zarr"), volume, 9);
}

TEST(Convert, writes_chunks_again_whose_bytes_did_not_reach_the_disk) {
    const ScratchFolder folder;
    const Volume volume = some_volume(SampleType::uint16, 11);
    const auto store = store_of(volume, "v");
    int number = 0;
    for (const int version : {2, 3}) {
        for (const Compression compression :
             {Compression::none, Compression::gzip, Compression::zstd, Compression::blosc}) {
            const fs::path out = folder / (std::to_string(number++) + ".zarr");
            ConvertOptions options;
            options.zarr_version = version;
            options.compression = compression;
            options.chunk = 16;
            const auto interrupted = [&] {
                ConvertOptions stopping = options;
                stopping.progress = [](double part) {
                    if (part == 1) throw Stop{};
                };
                EXPECT_THROW((void)convert_to_zarr(*store, 0, out, stopping), Stop);
            };
            interrupted();
            const fs::path chunk =
                out.string() + ".partial/result/0/" + (version == 2 ? "0/1/0" : "c/0/1/0");
            const std::string good = bytes_of(chunk);
            const auto lose = [&](std::string bad) {
                put_bytes(chunk, bad);
                interrupted();
                EXPECT_EQ(bytes_of(chunk), good) << out;
            };
            lose("");
            lose(good.substr(0, good.size() / 2));
            lose(std::string(good.size(), '\0'));
            if (version == 3) lose(good.substr(0, good.size() - 9) + std::string(9, '\0'));
            const Converted converted = convert_to_zarr(*store, 0, out, options);
            EXPECT_EQ(converted.kept, converted.chunks);
            expect_same_boxes(*open_store(out), volume, 3);
        }
    }
}

TEST(Convert, a_source_that_changes_meanwhile_gives_no_result) {
    const ScratchFolder folder;
    const Volume old_volume = some_volume(SampleType::uint8, 8);
    const auto put = [&](const char* name, const Volume& volume) {
        fs::remove_all(folder / name);
        if (fs::path(name).extension() == ".nrrd") return io::write_volume(volume, folder / name);
        (void)convert_to_zarr(*store_of(volume, "v"), 0, folder / name, {});
    };
    const auto convert = [&](const char* source, const fs::path& out,
                             const std::function<void(double)>& progress) {
        put(source, old_volume);
        const auto store = open_store(folder / source);
        ConvertOptions options;
        options.chunk = 8;
        options.progress = progress;
        if (out.extension() == ".zarr") return convert_to_zarr(*store, 0, out, options).note;
        write_plain(*store, 0, out, {false, progress, {}, 0});
        return std::string();
    };
    // In the same file; a folder is looked into by names.
    const auto write_anew = [&](const std::string& source) {
        put("new.nrrd", some_volume(SampleType::uint8, 9));
        if (source == "v.zarr") return put("v.zarr", some_volume(SampleType::uint8, 9));
        put_bytes(folder / source, bytes_of(folder / "new.nrrd"));
        fs::last_write_time(folder / source,
                            fs::last_write_time(folder / source) + std::chrono::seconds(1));
    };
    for (const char* source : {"v.zarr", "v.nrrd"}) {
        for (const char* name : {"a.zarr", "a.nrrd"}) {
            const std::string message = message_of<io::InputError>([&] {
                bool is_new = false;
                (void)convert(source, folder / name, [&](double part) {
                    if (part == 1 && !std::exchange(is_new, true)) write_anew(source);
                });
            });
            const bool reads_again = fs::path(name).extension() == ".zarr";
            const std::string what = reads_again && source == std::string("v.nrrd")
                                         ? "was written anew since it was opened"
                                         : "changed while it was converted";
            EXPECT_TRUE(contains(message, source + (": " + what))) << message;
            EXPECT_FALSE(fs::exists(folder / name));
        }
    }
    const std::string note = convert("v.zarr", folder / "b.zarr", [&](double part) {
        if (part == 1) fs::last_write_time(folder / "v.zarr/zarr.json", {});
    });
    EXPECT_TRUE(contains(note, "was touched")) << note;
    expect_same_boxes(*open_store(folder / "b.zarr"), old_volume, 3);
}

TEST(Convert, what_is_there_already_and_what_cannot_be_written_is_refused) {
    const ScratchFolder folder;
    const auto store = store_of(some_volume(SampleType::uint8), "v");
    fs::create_directory(folder / "v.zarr");
    std::string message = message_of<io::OutputError>(
        [&] { (void)convert_to_zarr(*store, 0, folder / "v.zarr", {}); });
    EXPECT_TRUE(contains(message, "is there already"));
    message = message_of<io::OutputError>(
        [&] { (void)convert_to_zarr(*store, 0, folder / "no/v.zarr", {}); });
    EXPECT_TRUE(contains(message, "choose another folder"));
}

TEST(Convert, a_level_of_a_store_becomes_a_plain_file_that_reads_the_same) {
    const ScratchFolder folder;
    for (const SampleType type : {SampleType::uint8, SampleType::int16, SampleType::float32}) {
        const Volume volume = some_volume(type, 10);
        fs::remove_all(folder / "v.zarr");
        ConvertOptions options;
        options.chunk = 8;
        (void)convert_to_zarr(*store_of(volume, "v"), 0, folder / "v.zarr", options);
        const auto store = open_store(folder / "v.zarr");
        for (const char* name : {"v.nrrd", "v.mha"}) {
            write_plain(*store, 0, folder / name, {});
            const Volume back = io::read_volume(folder / name).volume;
            EXPECT_TRUE(io::test::same_samples(back, volume)) << name;
            EXPECT_EQ(back.geometry().size, volume.geometry().size);
            EXPECT_TRUE(back.geometry().spacing.isApprox(volume.geometry().spacing));
            EXPECT_TRUE(back.geometry().origin.isApprox(volume.geometry().origin));
            EXPECT_TRUE(back.geometry().direction.isApprox(volume.geometry().direction));
        }
        write_plain(*store, 1, folder / "coarse.nrrd", {});
        EXPECT_TRUE(io::test::same_samples(io::read_volume(folder / "coarse.nrrd").volume,
                                           volume_of(*store, 1)));
    }
}

/// N5 of two channels, each of one value: 16 x 16 x 16 samples of a byte in blocks of 8^3.
void put_two_channels(const fs::path& folder) {
    fs::create_directories(folder);
    put_bytes(folder / "attributes.json",
              R"({"dimensions":[16,16,16,2],"blockSize":[8,8,8,1],"dataType":"uint8",)"
              R"("compression":{"type":"raw"}})");
    const std::string header("\0\0\0\4\0\0\0\x8\0\0\0\x8\0\0\0\x8\0\0\0\1", 20);
    for (int block = 0; block < 16; ++block) {
        const fs::path row = folder / std::to_string(block & 1) / std::to_string(block >> 1 & 1) /
                             std::to_string(block >> 2 & 1);
        fs::create_directories(row);
        const char value = block < 8 ? '\x11' : '\x22';
        put_bytes(row / std::to_string(block >> 3), header + std::string(512, value));
    }
}

TEST(Convert, a_run_that_was_ended_is_not_continued_with_another_channel) {
    const ScratchFolder folder;
    put_two_channels(folder / "two.n5");
    ConvertOptions options;
    options.chunk = 8;
    options.threads = 1;
    options.progress = stop_once_some_are_written;
    EXPECT_THROW(
        (void)convert_to_zarr(*open_store(folder / "two.n5"), 0, folder / "v.zarr", options), Stop);
    options.progress = {};
    StoreOptions other;
    other.channel = 1;
    const auto second = open_store(folder / "two.n5", other);
    EXPECT_EQ(convert_to_zarr(*second, 0, folder / "v.zarr", options).kept, 0U);
    const Volume volume = volume_of(*open_store(folder / "v.zarr"));
    EXPECT_EQ(volume.minimum(), 0x22);
    EXPECT_EQ(volume.maximum(), 0x22);
}

TEST(Convert, a_level_behind_http_becomes_a_local_image) {
    const ScratchFolder folder;
    const VolumeServer server({"--failures", "0.02"});
    const auto remote = open_store(server.address("virtual.zarr"));
    (void)convert_to_zarr(*remote, 7, folder / "v.zarr", {});
    const auto local = open_store(folder / "v.zarr");
    EXPECT_TRUE(
        local->info().levels[0].geometry.origin.isApprox(remote->info().levels[7].geometry.origin));
    expect_same_boxes(*local, volume_of(*remote, 7), 11);
}

TEST(Convert, a_piece_of_the_source_is_read_once_however_small_the_chunks_of_the_image_are) {
    const ScratchFolder folder;
    std::mt19937 random(5);
    Geometry grid;
    grid.size = Index3(64, 64, 64);
    const Volume volume = random_volume(random, SampleType::uint8, grid);
    const auto store = store_in_pieces(volume, {32, 32, 32});
    ConvertOptions options;
    options.chunk = 8;
    options.threads = 4;
    const Converted converted = convert_to_zarr(*store, 0, folder / "v.zarr", options);
    EXPECT_GT(converted.chunks, 512U);
    // Twice two slabs of planes to recognise the source.
    EXPECT_EQ(store->traffic().requests, 8U + 4U);
    expect_same_boxes(*open_store(folder / "v.zarr"), volume, 3);
}

}  // namespace
}  // namespace palpate::stream::test
