// Writes a small store whose chunks lie in a shard, so that parts of a file are read.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "io/volume_support.hpp"

namespace palpate::stream::test {

/// A Zarr array of 4 x 4 x 8 bytes in two shards with two chunks each: 'v' below, 'u' above.
/// `upper_first`: where the upper chunk lies in the file before the lower one, as long as before.
inline void put_shards(const std::filesystem::path& folder, bool upper_first = true) {
    std::filesystem::create_directories(folder);
    support::put_bytes(
        folder / "zarr.json",
        R"({"zarr_format":3,"node_type":"array","shape":[8,4,4],"data_type":"uint8",)"
        R"("chunk_grid":{"name":"regular","configuration":{"chunk_shape":[4,4,4]}},)"
        R"("chunk_key_encoding":{"name":"default"},"fill_value":0,"codecs":[)"
        R"({"name":"sharding_indexed","configuration":{"chunk_shape":[2,4,4],)"
        R"("codecs":[{"name":"bytes"}],"index_codecs":[)"
        R"({"name":"bytes","configuration":{"endian":"little"}}]}}]})");
    const auto entry = [](std::uint64_t a, std::uint64_t b) {
        return io::test::little(a) + io::test::little(b);
    };
    for (const char* shard : {"c/0/0", "c/1/0"}) {
        std::filesystem::create_directories(folder / shard);
        const std::string lower(32, 'v'), upper(32, 'u'), gap(5, '-');
        support::put_bytes(folder / shard / "0",
                           upper_first ? gap + upper + lower + entry(37, 32) + entry(5, 32)
                                       : gap + lower + upper + entry(5, 32) + entry(37, 32));
    }
}

}  // namespace palpate::stream::test
