// A multiscale OME-Zarr image that grows chunk by chunk. Several processes, also of several
// machines with one file system, may write different chunks at the same time. convert_to_zarr() is
// made of it.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "palpate/stream/convert.hpp"

namespace palpate::stream {

struct CoarserGrid;

/// Version and size of chunks. Throws std::invalid_argument.
void check_format(const ConvertOptions& options);

class GrowingImage {
  public:
    /// Touches no file. Uses the options of the format only. `temporary`: how names of files
    /// end while they are written. Processes that may write the same chunk at the same time (one of
    /// them taken for dead) need different ones. Throws std::invalid_argument for options,
    /// and for grids that no reader would take.
    GrowingImage(std::filesystem::path folder, SampleType type, const Geometry& finest,
                 const ConvertOptions& options, std::string temporary = ".part");
    /// The same with given levels, the finest first.
    GrowingImage(std::filesystem::path folder, SampleType type, std::vector<CoarserGrid> levels,
                 const ConvertOptions& options, std::string temporary = ".part");
    ~GrowingImage();
    GrowingImage(const GrowingImage&) = delete;
    GrowingImage& operator=(const GrowingImage&) = delete;

    /// The finest and the coarser ones, down to one that fits into a chunk.
    int levels() const;
    const Geometry& geometry(int level) const;
    /// Chunks along each axis.
    Index3 chunks(int level) const;
    /// The samples of a chunk that lie in the grid.
    SampleBox box(int level, const Index3& chunk) const;

    /// Writes the metadata of all levels, which readers need first. `range` is that of the finest
    /// level, if it is known. Throws io::OutputError, like all functions here that write.
    void write_metadata(const std::optional<Range>& range) const;
    /// The samples of box(level, chunk), x fastest. Read back and compared. False: all are 0, and
    /// the chunk is not stored, unless `zeros` asks for that.
    bool write(int level, const Index3& chunk, std::span<const std::byte> samples,
               bool zeros = false) const;
    /// The samples of a chunk that was written before. Nothing if it is missing or incomplete.
    std::optional<std::vector<std::byte>> written(int level, const Index3& chunk) const;
    /// Chunks of all levels that are stored.
    std::uint64_t stored_chunks() const;
    /// The samples of a chunk of a coarser level: means of the level before, which has to be
    /// whole there. Throws as reading does.
    std::vector<std::byte> means(int level, const Index3& chunk, const std::stop_token& stop) const;

  private:
    struct Parts;
    std::unique_ptr<const Parts> parts_;
};

}  // namespace palpate::stream
