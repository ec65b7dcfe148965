// A store over arrays in chunks, one for each level. Private to stream/.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "stream/formats/chunked_array.hpp"

namespace palpate::stream {

/// What a format's metadata say of a volume.
struct ChunkedVolume {
    StoreInfo info;
    std::vector<ChunkedArray> arrays;         ///< one for each of info.levels
    std::array<int, 3> space = {-1, -1, -1};  ///< axes of the arrays for x, y, z; -1: none
    std::vector<std::int64_t> fixed;          ///< the index along each other axis
};

/// `unpacking`: as in StoreOptions.
std::shared_ptr<const Store> chunked_store(std::shared_ptr<const Objects> objects,
                                           ChunkedVolume volume, std::uint64_t unpacking);

}  // namespace palpate::stream
