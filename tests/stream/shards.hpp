// Writes a small store whose chunks lie in a shard, so that parts of a file are read.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "io/volume_support.hpp"

namespace palpate::stream::test {

/// A Zarr array of 4 x 4 x 8 bytes in two shards with two chunks each: 'v' below, 'u' above.
inline void put_shards(const std::filesystem::path& folder) {
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
        support::put_bytes(folder / shard / "0", std::string(5, '-') + std::string(32, 'u') +
                                                     std::string(32, 'v') + entry(37, 32) +
                                                     entry(5, 32));
    }
}

}  // namespace palpate::stream::test
