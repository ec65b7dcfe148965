// Finds the chunks of an array in its one file (HDF5, TIFF). The helper process looks them up,
// a page of 16 x 16 x 16 chunks at a time, when the first of them is wanted. Private to stream/.
#pragma once

#include <filesystem>
#include <list>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "io/process/located_chunks.hpp"
#include "stream/formats/unpacking_room.hpp"

namespace palpate::stream {

/// A file that its tables ask about, one thread at a time. Others wait, or are stopped.
struct LocatedFile {
    explicit LocatedFile(io::ChunkFile of) : file(std::move(of)) {}
    io::ChunkFile file;
    UnpackingRoom turn{1};
};

/// Safe to use from several threads at a time. Keeps the last pages, at most 24 MiB.
class ChunkTable {
  public:
    /// `id`: of an array with three axes, the slowest first; `chunks`: so many along each.
    ChunkTable(std::shared_ptr<LocatedFile> file, std::string id,
               std::array<std::int64_t, 3> chunks)
        : file_(std::move(file)), id_(std::move(id)), chunks_(chunks) {}

    /// Nothing: the chunk is not stored. The place is what the file says and may be impossible.
    /// Throws io::InputError, Cancelled.
    std::optional<io::ChunkPlace> find(std::span<const std::int64_t> chunk,
                                       const std::stop_token& stop) const;

  private:
    using PageIndex = std::array<std::int64_t, 3>;
    using Page = std::vector<io::ChunkPlace>;

    std::shared_ptr<LocatedFile> file_;
    std::string id_;
    std::array<std::int64_t, 3> chunks_;
    mutable UnpackingRoom turn_{1};  ///< of the next thread, for the same page
    mutable std::map<PageIndex, Page> pages_;
    mutable std::list<PageIndex> order_;  ///< of pages_, the oldest first
};

}  // namespace palpate::stream
