// The image in a file of chunks (HDF5, TIFF), and the places of its chunks. The helper process
// reads them, so that no library parses the file in the process that drives the device. Private to
// io/ and stream/.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <stop_token>
#include <string>
#include <vector>

#include "io/chunked_image.hpp"
#include "io/process/helper_process.hpp"

namespace palpate::io {

/// True for names that no other function reads: .ims, .h5, .hdf5.
bool is_hdf5_name(const std::filesystem::path& path);

/// A file on this machine or elsewhere, and the helper that looks into it. It starts with the first
/// question. One thread at a time.
class ChunkFile {
  public:
    /// Reads a part of the file that lies within it. May throw.
    using Read = std::function<std::vector<std::byte>(std::uint64_t offset, std::uint64_t length,
                                                      const std::stop_token& stop)>;

    /// `own_memory`: [bytes] most that the helper may take.
    explicit ChunkFile(std::filesystem::path path, std::uint64_t own_memory = 1 << 30)
        : path_(std::move(path)), own_memory_(own_memory) {}
    /// Elsewhere. `name`: in messages, and its extension tells the format. `size` in bytes.
    ChunkFile(std::filesystem::path name, std::uint64_t size, Read read,
              std::uint64_t own_memory = 1 << 30)
        : path_(std::move(name)), own_memory_(own_memory), size_(size), read_(std::move(read)) {}

    const std::filesystem::path& path() const { return path_; }

    /// Of HDF5 and of tiled TIFF: the levels of one channel and time; none if there is no such
    /// channel or time. Throws InputError, what reading throws, and Cancelled.
    ChunkedImage describe(int channel, int time, const std::stop_token& stop = {});

    /// Where `count` chunks along z, y, x lie, from `first` on, x fastest. Nothing is known of the
    /// places but that they are what the file says. Throws as describe().
    std::vector<ChunkPlace> locate(const std::string& array,
                                   const std::array<std::int64_t, 3>& first,
                                   const std::array<std::int64_t, 3>& count,
                                   const std::stop_token& stop = {});

  private:
    nlohmann::json answer(const nlohmann::json& question, const std::stop_token& stop);

    std::filesystem::path path_;
    std::uint64_t own_memory_, size_ = 0;
    Read read_;
    HelperTalk talk_;
    int talker_ = 0;  // process that began it: a fork must not take its parent's answers
};

}  // namespace palpate::io
