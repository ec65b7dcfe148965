// What stores may cost, whatever their metadata say: memory while chunks are unpacked, and depth.
#include <sys/resource.h>

#include <atomic>
#include <thread>

#include "io/json_text.hpp"
#include "palpate/stream/loader.hpp"
#include "stream/formats/unpacking_room.hpp"
#include "stream/store_support.hpp"
#include "stream/volume_server.hpp"
#include "stream/volumes_store.hpp"
#include "stream/written_files.hpp"
#include "support/edits.hpp"
#include "support/random.hpp"
#include "support/traced_process.hpp"

namespace palpate::stream::test {
namespace {

namespace fs = std::filesystem;
using support::contains;
using support::message_of;
using support::put_bytes;
using support::ScratchFolder;

constexpr std::uint64_t megabyte = 1'000'000;

/// 1024^3 bytes in one chunk of 1 GiB, of which little is stored.
void put_bomb(const fs::path& folder) {
    fs::create_directories(folder);
    put_bytes(
        folder / ".zarray",
        R"({"zarr_format":2,"shape":[1024,1024,1024],"chunks":[1024,1024,1024],"dtype":"|u1",)"
        R"("compressor":{"id":"gzip"},"fill_value":0,"order":"C","filters":null})");
    put_bytes(folder / "0.0.0", "no gzip");
}

TEST(Bounds, a_chunk_that_takes_more_than_may_be_used_is_refused_by_name_and_costs_nothing) {
    const ScratchFolder folder;
    put_bomb(folder / "bomb.zarr");
    StoreOptions options;
    options.unpacking = 128 * megabyte;
    const auto store = open_store(folder / "bomb.zarr", options);
    const std::string message = message_of<io::InputError>([&] { (void)overview_of(*store); });
    EXPECT_TRUE(contains(message, "bomb.zarr: a chunk of level 0 takes 2148 MB")) << message;
    EXPECT_TRUE(contains(message, "128 MB")) << message;
    if (support::is_slow_build) return;  // sanitizers need memory of their own
    const auto work = [&] {
        EXPECT_THROW((void)overview_of(*store), io::InputError);
        rusage used{};
        ::getrusage(RUSAGE_SELF, &used);
        if (static_cast<std::uint64_t>(used.ru_maxrss) * 1024 > 320 * megabyte) {
            throw std::runtime_error("too much memory");
        }
    };
    EXPECT_EQ(support::end_of(support::start_process(work)), 0);
}

/// A page of one tile, with a description of many elements.
void put_tiff(const fs::path& file, const std::string& description) {
    using io::test::little;
    const auto tag = [](std::uint16_t number, std::uint16_t type, std::uint32_t count,
                        std::uint32_t value) {
        return little(number) + little(type) + little(count) + little(value);
    };
    constexpr std::uint32_t tile = 16 * 16, tile_at = 8, directory = tile_at + tile;
    constexpr std::uint16_t tags = 11;
    const auto length = static_cast<std::uint32_t>(description.size()) + 1;
    put_bytes(file, "II*" + std::string(1, '\0') + little(directory) + std::string(tile, 'a') +
                        little(tags) + tag(256, 4, 1, 16) + tag(257, 4, 1, 16) + tag(258, 3, 1, 8) +
                        tag(259, 3, 1, 1) + tag(262, 3, 1, 1) +
                        tag(270, 2, length, directory + 2 + 12 * tags + 4) + tag(277, 3, 1, 1) +
                        tag(322, 4, 1, 16) + tag(323, 4, 1, 16) + tag(324, 4, 1, tile_at) +
                        tag(325, 4, 1, tile) + little(std::uint32_t{0}) + description +
                        std::string(1, '\0'));
}

TEST(Bounds, an_xml_document_costs_the_helper_no_more_than_may_be_used) {
    const ScratchFolder folder;
    std::string many;
    for (int i = 0; i < 4'000'000; ++i) many += "<a/>";
    const std::string start =
        R"(<OME><Image><Pixels DimensionOrder="XYZCT" SizeX="16" SizeY="16"/>)";
    put_tiff(folder / "small.tif", start + "</Image></OME>");
    put_tiff(folder / "large.tif", start + "</Image>" + many + "</OME>");
    fs::copy(written_by("hdf5") / "lonely.h5", folder / "large.h5");
    put_bytes(folder / "large.xml", "<SpimData>" + many + "</SpimData>");
    StoreOptions options;
    options.unpacking = 128 * megabyte;
    std::string attributes;
    for (int i = 0; i < 200'000; ++i) {
        attributes += R"(<a b="" c="" d="" e="" f="" g="" h="" i="" j="" k="" l="" m=""/>)";
    }
    put_tiff(folder / "attributes.tif", start + "</Image>" + attributes + "</OME>");
    EXPECT_EQ(open_store(folder / "small.tif", options)->info().format, "OME-TIFF");
    if (support::is_slow_build) return;  // sanitizers need memory of their own
    EXPECT_EQ(open_store(folder / "attributes.tif", options)->info().format, "OME-TIFF");
    std::string element = "<a";
    for (int i = 0; i < 3'000'000; ++i) element += " a" + std::to_string(i) + "=''";
    put_tiff(folder / "element.tif", start + "</Image>" + element + "/></OME>");
    StoreOptions more;
    more.unpacking = 240 * megabyte;
    EXPECT_EQ(open_store(folder / "element.tif", more)->info().format, "OME-TIFF");
    const auto work = [&] {
        for (const char* name : {"large.tif", "large.h5"}) {
            const std::string message = refusal(folder / name, options);
            if (!contains(message, "too large for the memory")) throw std::runtime_error(message);
        }
        rusage used{};
        ::getrusage(RUSAGE_CHILDREN, &used);
        if (static_cast<std::uint64_t>(used.ru_maxrss) * 1024 > 320 * megabyte) {
            throw std::runtime_error("too much memory");
        }
    };
    EXPECT_EQ(support::end_of(support::start_process(work)), 0);
}

/// Cubes of floats in chunks of 64^3; those that are not stored are NaN.
void put_cube(const fs::path& folder, int size,
              const std::vector<std::pair<std::string, float>>& chunks) {
    fs::create_directories(folder);
    const std::string n = std::to_string(size);
    put_bytes(folder / ".zarray",
              R"({"zarr_format":2,"shape":[)" + n + "," + n + "," + n +
                  R"(],"chunks":[64,64,64],"dtype":"<f4","compressor":null,"fill_value":"NaN",)"
                  R"("order":"C","filters":null})");
    for (const auto& [name, value] : chunks) {
        std::string bytes;
        for (int i = 0; i < 64 * 64 * 64; ++i) bytes += io::test::little(value);
        put_bytes(folder / name, bytes);
    }
}

float sample_at(const Store& store, const Index3& at) {
    float value = 0;
    std::memcpy(&value, read_box(store, 0, {at, at}).data(), sizeof value);
    return value;
}

TEST(Bounds, the_least_finite_sample_of_a_large_store_is_searched_in_part_of_it) {
    const ScratchFolder folder;
    put_cube(folder / "a.zarr", 1 << 16, {{"0.0.0", 5.0F}, {"0.0.1", 3.0F}});
    const auto store = open_store(folder / "a.zarr");
    EXPECT_EQ(sample_at(*store, {64, 0, 0}), 3);
    EXPECT_EQ(sample_at(*store, {4000, 0, 0}), 5);
    put_cube(folder / "b.zarr", 1 << 16, {{"0.0.1", 3.0F}});
    EXPECT_EQ(sample_at(*open_store(folder / "b.zarr"), {4000, 0, 0}), 0);
}

TEST(Bounds, the_least_finite_sample_is_searched_beside_damaged_chunks) {
    const ScratchFolder folder;
    put_cube(folder / "a.zarr", 256, {{"0.0.0", 5.0F}, {"0.0.1", 3.0F}});
    put_bytes(folder / "a.zarr/1.1.1", "short");
    const auto store = open_store(folder / "a.zarr");
    EXPECT_EQ(sample_at(*store, {200, 0, 0}), 3);
    EXPECT_THROW(sample_at(*store, {100, 100, 100}), io::InputError);
}

TEST(Bounds, a_grid_whose_table_of_bricks_would_fill_the_memory_is_refused) {
    const ScratchFolder folder;
    fs::create_directories(folder / "a.zarr");
    put_bytes(folder / "a.zarr/.zarray",
              R"({"zarr_format":2,"shape":[400000,400000,400000],"chunks":[64,64,64],)"
              R"("dtype":"|u1","compressor":null,"fill_value":0,"order":"C","filters":null})");
    const auto store = open_store(folder / "a.zarr");
    const Volume overview(Geometry{Index3::Constant(2)}, std::vector<std::uint8_t>(8));
    const std::string message = message_of<io::InputError>(
        [&] { (void)empty_samples(*store, overview, 0, 128 * megabyte); });
    EXPECT_TRUE(contains(message, "400000 x 400000 x 400000 samples")) << message;
    EXPECT_THROW(BrickLoader(store, overview, {.memory = 128 * megabyte}), io::InputError);
}

TEST(Bounds, threads_share_the_room_to_unpack_and_leave_the_queue_when_stopped) {
    UnpackingRoom room(100);
    EXPECT_GT(UnpackingRoom(0).most(), 100 * megabyte);
    std::stop_source stopped;
    stopped.request_stop();
    {
        const UnpackingRoom::Share one(room, 60, {});
        EXPECT_THROW(UnpackingRoom::Share(room, 41, stopped.get_token()), Cancelled);
        const UnpackingRoom::Share other(room, 40, {});
    }
    std::atomic<int> now{0}, most{0};
    {
        std::vector<std::jthread> threads;
        for (int t = 0; t < 8; ++t) {
            threads.emplace_back([&] {
                for (int i = 0; i < 50; ++i) {
                    const UnpackingRoom::Share share(room, 30, {});
                    int seen = most;
                    const int mine = ++now;
                    while (mine > seen && !most.compare_exchange_weak(seen, mine)) {
                    }
                    --now;
                }
            });
        }
    }
    EXPECT_LE(most, 3);
}

std::string nested(int depth) {
    return std::string(static_cast<std::size_t>(depth), '[') +
           std::string(static_cast<std::size_t>(depth), ']');
}

TEST(Bounds, json_with_more_values_than_memory_can_hold_is_refused_before_it_is_parsed) {
    const std::pair<const char*, std::size_t> values[] = {
        {"1", 32}, {"\"\"", 96}, {"[]", 160}, {"{}", 160}};
    for (const auto& [value, bytes] : values) {
        const auto of = [&, each = value](std::size_t count) {
            std::string text = "[0";
            for (std::size_t i = 0; i < count; ++i) text += std::string(",") + each;
            return text + "]";
        };
        const std::size_t most = (io::most_json_bytes - 128) / bytes;
        EXPECT_NO_THROW((void)io::parsed_json(of(most)));
        EXPECT_THROW((void)io::parsed_json(of(most + 1)), nlohmann::json::exception) << value;
        EXPECT_TRUE(io::parsed_or_discarded(of(most + 1)).is_discarded());
    }
}

TEST(Bounds, metadata_take_no_more_memory_than_may_be_used_and_are_held_once) {
    const ScratchFolder folder;
    const auto members = [](int count) {
        std::string text = R"("a":0)";
        for (int i = 0; i < count; ++i) text += ",\"" + std::to_string(i) + "\":1";
        return text;
    };
    const std::string array =
        R"("shape":[2,4,4],"data_type":"uint8","chunk_grid":{"name":"regular","configuration":)"
        R"({"chunk_shape":[2,4,4]}},"chunk_key_encoding":{"name":"default"},"fill_value":0,)"
        R"("codecs":["bytes"])";
    const auto put = [&](const std::string& name, int count) {
        fs::create_directories(folder / name);
        put_bytes(folder / name / "zarr.json", R"({"zarr_format":3,"node_type":"array",)" + array +
                                                   R"(,"attributes":{)" + members(count) + "}}");
        fs::create_directories(folder / (name + ".n5"));
        put_bytes(folder / (name + ".n5") / "attributes.json",
                  R"({"dimensions":[4,4,2],"blockSize":[4,4,2],"dataType":"uint8",)"
                  R"("compression":{"type":"raw"},"unknown":{)" +
                      members(count) + "}}");
    };
    put("large", 600'000);
    put("fits", 300'000);
    StoreOptions options;
    options.unpacking = 128 * megabyte;
    const auto work = [&] {
        rusage before{}, after{};
        ::getrusage(RUSAGE_SELF, &before);
        for (const std::string name : {"fits", "fits.n5"}) {
            (void)open_store(folder / name, options);
        }
        ::getrusage(RUSAGE_SELF, &after);
        const auto taken = static_cast<std::uint64_t>(after.ru_maxrss - before.ru_maxrss) * 1024;
        if (taken > 50 * megabyte) throw std::runtime_error(std::to_string(taken));
    };
    if (!support::is_slow_build) {  // sanitizers need memory of their own
        EXPECT_EQ(support::end_of(support::start_process(work)), 0);
    }
    for (const std::string name : {"large", "large.n5"}) {
        expect_refusal("its values take more than 30 MiB; allow more memory", folder / name,
                       options);
        EXPECT_NO_THROW((void)open_store(folder / name)) << name;
    }
}

/// Padded with blanks, which take memory only until they are parsed.
std::string of_size(std::string json, std::size_t bytes) {
    json.resize(bytes, ' ');
    return json;
}

TEST(Bounds, files_of_metadata_that_are_read_at_once_share_what_may_be_used) {
    const ScratchFolder folder;
    constexpr std::size_t most_of_one = 8 << 20;
    for (int i = 0; i < 16; ++i) {
        const std::string number = std::to_string(i);
        fs::create_directories(folder / "many.zarr" / number);
        fs::create_directories(folder / "many.n5" / ("setup" + number));
        put_bytes(folder / "many.zarr" / number / "zarr.json", of_size("{}", most_of_one));
        put_bytes(folder / "many.n5" / ("setup" + number) / "attributes.json",
                  of_size("{}", most_of_one));
    }
    put_bytes(folder / "many.zarr/zarr.json", "{}");
    put_bytes(folder / "many.n5/attributes.json", "{}");
    const VolumeServer server({"--folder", folder.path().string()});
    StoreOptions options;
    options.unpacking = 128 * megabyte;
    for (const std::string name : {"many.zarr", "many.n5"}) {
        for (const std::string& address : {std::string(folder / name), server.address(name)}) {
            expect_refusal("its metadata allow; copy it again, or allow more memory", address,
                           options);
        }
    }
}

TEST(Bounds, pieces_of_few_samples_are_read_and_kept_together) {
    for (const Index3& chunk : {Index3(1, 1, 1), Index3(3, 1, 2), Index3(1, 100, 1)}) {
        const Volume volume = support::noise_of(SampleType::uint8, support::grid({100, 90, 80}), 5);
        const auto store = store_in_pieces(volume, chunk);
        EXPECT_TRUE(support::same_bits(read_level(*store, 0), volume));
        BrickLoader loader(store, overview_of(*store), {.memory = 100 * megabyte, .threads = 1});
        (void)loader.read({0, 0, 0}, 0);
        (void)loader.read({1, 0, 0}, 0);
        EXPECT_LT(store->traffic().requests, 1000U) << chunk.transpose();
    }
}

TEST(Bounds, json_that_is_nested_too_deeply_is_refused_before_it_is_parsed) {
    EXPECT_NO_THROW((void)io::parsed_json(nested(io::deepest_json)));
    EXPECT_THROW((void)io::parsed_json(nested(io::deepest_json + 1)), nlohmann::json::exception);
    EXPECT_TRUE(io::parsed_or_discarded(nested(io::deepest_json + 1)).is_discarded());
    const std::string brackets(100, '[');
    EXPECT_EQ(io::parsed_json("\"\\\"" + brackets + "\""), "\"" + brackets);
    EXPECT_EQ(io::parsed_json("1 // " + brackets + "\n/*" + brackets + "*/", true), 1);
    EXPECT_THROW((void)io::parsed_json("\"" + brackets), nlohmann::json::exception);
    EXPECT_THROW((void)io::parsed_json("/*" + brackets, true), nlohmann::json::exception);
    const ScratchFolder folder;
    for (const char* file : {"a.zarr/zarr.json", "b.zarr/.zattrs", "c.n5/attributes.json",
                             "d.zarr/palpate-edits.json"}) {
        fs::create_directories((folder / file).parent_path());
        put_bytes(folder / file, R"({"a":)" + nested(100'000) + "}");
        EXPECT_THROW((void)open_store((folder / file).parent_path()), io::InputError) << file;
    }
}

TEST(Bounds, json_of_many_small_values_is_refused_in_time_that_grows_with_its_length) {
    std::string values;
    for (int i = 0; i < 5'000'000; ++i) values += "{},";
    const ScratchFolder folder;
    for (const char* file : {"a.zarr/zarr.json", "b.zarr/.zattrs", "c.n5/attributes.json",
                             "d.zarr/palpate-edits.json"}) {
        fs::create_directories((folder / file).parent_path());
        put_bytes(folder / file, R"({"a":[)" + values + "{}]}");
        EXPECT_THROW((void)open_store((folder / file).parent_path()), io::InputError) << file;
    }
}

}  // namespace
}  // namespace palpate::stream::test
