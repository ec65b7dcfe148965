// The image in a file of chunks (HDF5, TIFF), and the places of its chunks. The helper process
// reads them, so that no library parses the file in the process that drives the device. Private to
// io/ and stream/.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <stop_token>
#include <string>
#include <vector>

#include "io/chunked_image.hpp"
#include "io/process/mirror.hpp"

namespace palpate::io {

/// True for names that no other function reads: .ims, .h5, .hdf5.
bool is_hdf5_name(const std::filesystem::path& path);

/// A file on this machine or, with a mirror, elsewhere.
struct ChunkFile {
    std::filesystem::path path;
    std::shared_ptr<Mirror> mirror = {};
};

/// Of HDF5 and of tiled TIFF: the levels of one channel and time; none if there is no such channel
/// or time. Throws InputError, and what a mirror throws.
ChunkedImage describe_image(const ChunkFile& file, int channel, int time);

/// Where `count` chunks along z, y, x lie, from `first` on, x fastest. Nothing is known of the
/// places but that they are what the file says. Throws as describe_image().
std::vector<ChunkPlace> locate_chunks(const ChunkFile& file, const std::string& array,
                                      const std::array<std::int64_t, 3>& first,
                                      const std::array<std::int64_t, 3>& count,
                                      const std::stop_token& stop = {});

}  // namespace palpate::io
