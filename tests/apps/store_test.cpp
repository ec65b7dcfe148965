// Stores that are read as they are felt, by the command line: what info and replay say of them, and
// damaged ones, which are refused in one line and bounded memory.
#include <nlohmann/json.hpp>

#include "apps/program.hpp"
#include "io/helper/child.hpp"

namespace palpate::app::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using support::put_bytes;

/// A dataset of N5 in one raw block: 16^3 bytes that rise along x.
void put_ramp(const fs::path& folder, const std::string& blocks = "[16,16,16]",
              const std::string& compression = "raw") {
    fs::create_directories(folder / "0/0");
    put_bytes(folder / "attributes.json", R"({"dimensions":[16,16,16],"blockSize":)" + blocks +
                                              R"(,"dataType":"uint8","compression":{"type":")" +
                                              compression +
                                              R"("},"pixelResolution":{"unit":"mm",)"
                                              R"("dimensions":[0.5,0.5,1]}})");
    std::string block("\0\0\0\3\0\0\0\x10\0\0\0\x10\0\0\0\x10", 16);
    for (int i = 0; i < 16 * 16 * 16; ++i) block += static_cast<char>(10 * (i % 16));
    put_bytes(folder / "0/0/0", block);
}

TEST(Store, info_tells_format_levels_and_spacing_and_replay_feels_it) {
    const ScratchFolder folder;
    put_ramp(folder / "ramp.n5");
    const Outcome info = succeeds(folder, "info -q --json ramp.n5");
    const json told = json::parse(info.out);
    EXPECT_EQ(told.at("format"), "N5");
    EXPECT_EQ(told.at("spacing_mm"), json({0.5, 0.5, 1.0}));
    EXPECT_EQ(told.at("levels").size(), 1U);
    EXPECT_EQ(told.at("channels"), json::array());
    put_bytes(folder / "t.csv", "t,x,y,z\n0,1,4,8\n0.001,3,4,8\n0.002,6,4,8\n");
    succeeds(folder, "replay -q ramp.n5 --trajectory t.csv -i 75 --field linear -o trace.csv");
    // The level of 75 lies half a sample beyond the seventh: at 3.75 mm.
    const std::string trace = support::bytes_of(folder / "trace.csv");
    EXPECT_TRUE(contains(trace, "constrained")) << trace;
    EXPECT_TRUE(contains(trace, ",3.7")) << trace;
}

/// As palpate(), with at most 3 GB of memory in its address space.
Outcome palpate_in_3_gb(const ScratchFolder& folder, const std::string& line) {
    return by_bash(folder, "ulimit -v 3000000 && exec \"$0\" " + line);
}

TEST(Store, info_lists_the_channels_of_a_store) {
    const ScratchFolder folder;
    put_ramp(folder / "two.n5/c0/s0");
    put_ramp(folder / "two.n5/c1/s0");
    const Outcome as_json = palpate(folder, "info -q --json two.n5");
    EXPECT_EQ(json::parse(as_json.out).at("channels"), json({"channel 0", "channel 1"}));
    const Outcome text = succeeds(folder, "info -q two.n5 --channel 1");
    EXPECT_TRUE(contains(text.out, "channels     channel 0, channel 1 (1 was taken)")) << text.out;
}

TEST(Store, metadata_that_ask_for_more_than_there_can_be_are_refused_in_bounded_memory) {
#ifdef PALPATE_SANITIZED
    GTEST_SKIP() << "sanitizers take more of the address space";
#endif
    const ScratchFolder folder;
    put_ramp(folder / "blocks.n5", "[99999,99999,99999]");
    put_ramp(folder / "packed.n5", "[900,900,900]", "gzip");  // 729 MB, and no gzip
    fs::create_directories(folder / "shards.zarr");
    put_bytes(folder / "shards.zarr/zarr.json",
              R"({"zarr_format":3,"node_type":"array","shape":[9,9,9],"data_type":"uint8",)"
              R"("chunk_grid":{"name":"regular","configuration":{"chunk_shape":[4096,4096,4096]}},)"
              R"("chunk_key_encoding":{"name":"default"},"fill_value":0,"codecs":[)"
              R"({"name":"sharding_indexed","configuration":{"chunk_shape":[1,1,1],"codecs":[)"
              R"({"name":"bytes"}],"index_codecs":[)"
              R"({"name":"bytes","configuration":{"endian":"little"}}]}}]})");
    fs::create_directories(folder / "long.zarr");
    put_bytes(folder / "long.zarr/.zarray", std::string(9 << 20, ' '));
    const std::pair<const char*, const char*> wrong[] = {
        {"blocks.n5", "1 GiB"},
        {"packed.n5", "is a damaged gzip stream"},
        {"shards.zarr", "2^20 chunks"},
        {"long.zarr", "more bytes than its metadata allow"}};
    for (const auto& [name, reason] : wrong) {
        SCOPED_TRACE(name);
        expect_failure(palpate_in_3_gb(folder, std::string("info ") + name), 3, reason);
    }
}

TEST(Store, files_that_are_cut_off_or_something_else_are_refused_in_one_line) {
    const ScratchFolder folder;
    put_bytes(folder / "letter.ims", "Dear reader,\nthis is a letter.\n");
    put_bytes(folder / "head.h5", std::string("\x89HDF\r\n\x1a\n\0\0\0\0", 12));
    // The tags of tiles and of coarser levels, and nothing that they point to.
    put_bytes(folder / "tags.tif", std::string("II*\0\x08\0\0\0\x02\0\x42\1\3\0\1\0\0\0\x10\0\0\0"
                                               "\x4a\1\4\0\1\0\0\0\xff\0\0\0\0\0\0\0",
                                               38));
    put_ramp(folder / "cut.n5");
    put_bytes(folder / "cut.n5/0/0/0", std::string("\0\0\0\3", 4));
    fs::create_directories(folder / "empty.n5");
    const std::pair<const char*, const char*> wrong[] = {
        {"letter.ims", "is no HDF5 file"},
        {"head.h5", "is damaged, cut off"},
        {"tags.tif", "no TIFF file or is damaged"},
        {"cut.n5", "too short for the header of a block"},
        {"empty.n5", "has no metadata of Zarr"}};
    for (const auto& [name, reason] : wrong) {
        SCOPED_TRACE(name);
        expect_failure(palpate(folder, std::string("info ") + name), 3, reason);
        expect_failure(palpate(folder, "convert " + std::string(name) + " out.zarr"), 3, reason);
        EXPECT_FALSE(fs::exists(folder / "out.zarr"));
        fs::remove_all(folder / "out.zarr.partial");
    }
}

}  // namespace
}  // namespace palpate::app::test
