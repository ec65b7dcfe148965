// Images in files of chunks, one source file for each family of formats: their contents, and where
// their chunks lie.
#pragma once

#include <filesystem>
#include <span>

#include "io/chunked_image.hpp"

namespace palpate::io {

/// Some chunks of an array, along z, y, x.
struct ChunkBox {
    std::string array;  ///< its id
    std::array<std::int64_t, 3> first = {0, 0, 0}, count = {1, 1, 1};
};

/// `channel` and `time` may be beyond what there is: then there are no levels. Throw Failure.
ChunkedImage hdf5_image(const std::filesystem::path& path, int channel, int time);
ChunkedImage tiff_image(const std::filesystem::path& path, int channel, int time);

/// As many as there are in the box, x fastest. Throw Failure.
void hdf5_places(const std::filesystem::path& path, const ChunkBox& box,
                 std::span<ChunkPlace> places);
void tiff_places(const std::filesystem::path& path, const ChunkBox& box,
                 std::span<ChunkPlace> places);

}  // namespace palpate::io
