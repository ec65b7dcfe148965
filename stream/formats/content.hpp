// Recognises the content of stores, so that work on one is never continued or opened over another
// one that has its name and its size. Private to stream/.
#pragma once

#include <cstdint>
#include <span>
#include <stop_token>
#include <string>

#include "palpate/stream/store.hpp"

namespace palpate::stream {

/// XXH64, seed 0 (https://github.com/Cyan4973/xxHash, doc/xxhash_spec.md): fast, well spread, no
/// protection against somebody who wants two contents to look alike.
class ContentHash {
  public:
    void take(std::span<const std::byte> bytes);
    std::uint64_t value() const;

  private:
    void take_stripe(const std::byte* at);

    std::uint64_t lanes_[4] = {0x60EA27EEADC0B5D6U, 0xC2B2AE3D27D4EB4FU, 0, 0x61C8864E7A143579U};
    std::byte begun_[32] = {};  ///< of the stripe that is not full yet
    std::size_t in_begun_ = 0;
    std::uint64_t bytes_ = 0;
};

/// What `store` holds from a level on: type, channel, time, every level's grid, and samples. Of
/// each level all, if they are at most 64 MiB (1 MiB of a store behind HTTP). Else those of 64 (8)
/// pieces that are spread evenly over the grid, at most 64 samples long along each axis; of coarser
/// levels an eighth as many. All samples of a volume in memory. Hexadecimal. Throws what the store
/// throws, and Cancelled as soon as `stop` is requested.
std::string content_of(const Store& store, int level, const std::stop_token& stop = {});

/// Names, sizes and times of change of a file, or of all files of a folder and below, as one
/// number: which files they are, without reading them. 0 if there is no such file.
std::uint64_t files_at(const std::string& address);

}  // namespace palpate::stream
