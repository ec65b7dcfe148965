// Writes the files of a multiscale OME-Zarr image. Private to stream/.
#pragma once

#include <filesystem>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>

#include "palpate/stream/convert.hpp"
#include "stream/formats/chunked_array.hpp"
#include "stream/objects/held_folder.hpp"
#include "stream/writer/pyramid.hpp"

namespace palpate::stream {

/// Of what is written, not how. Throws std::invalid_argument.
void check_format(const ConvertOptions& options);

class ZarrWriter {
  public:
    ZarrWriter(std::filesystem::path folder, SampleType type, std::vector<CoarserGrid> levels,
               const ConvertOptions& options, std::string temporary = ".part");

    const std::vector<CoarserGrid>& levels() const { return levels_; }
    /// Of all levels and of the image. Throws io::OutputError, as the next one does.
    void write_metadata(const std::optional<Range>& range) const;
    /// The samples of a chunk that lie in the grid.
    SampleBox box_of(int level, const Index3& chunk) const;
    /// Writes these under another name and renames the file, after having read it back. A chunk
    /// whose samples are all 0 is not written; returns false then.
    bool write_chunk(int level, const Index3& chunk, std::span<const std::byte> samples) const;
    /// Those of a chunk that was written before; nothing if it is not there or not whole.
    std::optional<Bytes> written_chunk(int level, const Index3& chunk) const;
    /// Chunks of all levels that are there.
    std::uint64_t stored_chunks() const;
    /// Chunks along each axis.
    Index3 chunks_of(int level) const;

  private:
    /// A chunk with what lies outside the grid.
    SampleBox whole(const Index3& chunk) const;
    std::optional<Bytes> stored(int level, const Index3& chunk) const;
    void put_json(const std::filesystem::path& name, const nlohmann::json& json) const;
    std::string name_of(int level, const Index3& chunk) const;
    Bytes packed(const Bytes& samples) const;

    std::shared_ptr<HeldFolder> folder_;
    SampleType type_;
    std::vector<CoarserGrid> levels_;
    ConvertOptions options_;
    std::string temporary_;
    std::vector<ChunkedArray> arrays_;
};

}  // namespace palpate::stream
