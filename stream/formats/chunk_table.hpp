// Where the chunks of an array lie in its one file (HDF5, TIFF): the helper process looks them up,
// a page of 16 x 16 x 16 chunks at a time, when the first of them is wanted. Private to stream/.
#pragma once

#include <filesystem>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "io/process/located_chunks.hpp"

namespace palpate::stream {

/// Safe to use from several threads at a time. Keeps the last pages, at most 24 MiB.
class ChunkTable {
  public:
    /// `id`: of an array with three axes, the slowest first; `chunks`: so many along each.
    ChunkTable(io::ChunkFile file, std::string id, std::array<std::int64_t, 3> chunks)
        : file_(std::move(file)), id_(std::move(id)), chunks_(chunks) {}

    /// Nothing: the chunk is not stored. The place is what the file says and may be impossible.
    /// Throws io::InputError, Cancelled.
    std::optional<io::ChunkPlace> find(std::span<const std::int64_t> chunk,
                                       const std::stop_token& stop) const;

  private:
    using PageIndex = std::array<std::int64_t, 3>;
    using Page = std::vector<io::ChunkPlace>;

    io::ChunkFile file_;
    std::string id_;
    std::array<std::int64_t, 3> chunks_;
    mutable std::mutex
        mutex_;  ///< also while the helper looks: the next thread wants the same page
    mutable std::map<PageIndex, Page> pages_;
    mutable std::list<PageIndex> order_;  ///< of pages_, the oldest first
};

}  // namespace palpate::stream
