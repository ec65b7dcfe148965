// An array in chunks, as Zarr, N5 and HDF5 describe it: where each chunk lies and how its bytes
// become samples. Private to stream/.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "io/process/located_chunks.hpp"
#include "stream/formats/codecs.hpp"
#include "stream/formats/unpacking_room.hpp"
#include "stream/objects/objects.hpp"
#include "stream/sample_bytes.hpp"

namespace palpate::stream {

/// A file in which arrays look up their chunks, one thread at a time. Others wait until it is their
/// turn or they are stopped.
struct LocatedFile {
    LocatedFile(io::ChunkFile of, std::string name) : file(std::move(of)), key(std::move(name)) {}
    io::ChunkFile file;  ///< its path is for messages and may be shortened
    UnpackingRoom turn{1};
    std::string key;  ///< among the objects of its folder
};

/// Groups of chunks. One index tells where each chunk of a group lies in its object.
struct Shards {
    std::vector<std::int64_t> chunks;  ///< along each axis of the array, in a shard
    std::vector<int> axes;            ///< in the order in which the index counts, the slowest first
    std::vector<Codec> index_codecs;  ///< in the order of decoding
    bool index_at_start = false;
    bool is_index_big_endian = false;
    /// The file of an array in HDF5 or TIFF. The helper process looks up a shard in it when its
    /// first chunk is needed. Null: each shard is an object that contains its index.
    std::shared_ptr<LocatedFile> file = {};
    std::string id = {};  ///< of the array in that file
};

struct ChunkedArray {
    std::vector<std::int64_t> shape, chunk;  ///< samples along each axis, the slowest first
    std::vector<int> stored_axes;  ///< which axis of the array each axis of a stored chunk is
    SampleBytes bytes;
    std::vector<Codec> codecs;  ///< in the order of decoding
    std::optional<Shards> shards;
    std::string folder;  ///< the key of the array, or of its one file
    std::string prefix;  ///< of a chunk's name: "c/", "c." or none
    char separator = '.';
    /// Chunks are blocks of N5: named with the fastest axis first, with a header, those at the end
    /// of the array cut.
    bool n5_blocks = false;

    std::size_t axes() const { return shape.size(); }
    std::size_t samples_in_chunk() const;
    std::size_t bytes_in_chunk() const { return samples_in_chunk() * bytes.size(); }
    /// [bytes] That reading a chunk takes: packed and unpacked, and the index of its shard.
    std::uint64_t bytes_to_read_chunk() const;
};

/// More than 2^64 are no error.
double rough_product(std::span<const std::int64_t> sizes);

/// The key of the object with a chunk, or with its shard if there are shards.
std::string key_of(const ChunkedArray& array, std::span<const std::int64_t> object);

/// Throws std::invalid_argument, without a file's name, for what cannot be or is beyond our limits:
/// 1 to 8 axes, at least one sample along each, chunks of at most 1 GiB, shards of at most 2^20
/// chunks.
void check(const ChunkedArray& array);

/// The bytes of a chunk's samples out of what is stored. Bit i of `skipped`: codec i was not used.
/// Throws DamagedChunk.
Bytes unpacked_chunk(const ChunkedArray& array, Bytes packed, std::uint64_t skipped = 0);

/// Reads chunks of one array; keeps the last indices of shards. Safe from several threads.
class ChunkReader {
  public:
    ChunkReader(std::shared_ptr<const Objects> objects, ChunkedArray array);

    const ChunkedArray& array() const { return array_; }
    /// The bytes of a chunk's samples as they are stored, unpacked; nothing if it is not stored.
    /// Throws io::InputError, Cancelled.
    std::optional<Bytes> chunk(std::span<const std::int64_t> index, std::stop_token stop) const;

  private:
    struct ShardIndex {
        std::vector<io::ChunkPlace> places;
        std::string identity;  ///< of the shard
    };
    using Index = std::shared_ptr<const ShardIndex>;  ///< null: there is no such shard
    using Shard = std::vector<std::int64_t>;
    Index index_of(const Shard& shard, bool again, const std::stop_token& stop) const;
    Index fetched_index(const Shard& shard, bool again, const std::stop_token& stop) const;
    Index located_index(const Shard& shard, const std::stop_token& stop) const;
    void keep(const Shard& shard, const Index& index) const;
    std::int64_t chunks_of(const Shard& shard, std::size_t axis) const;
    /// Where a chunk is stored.
    struct Place {
        std::string key;  ///< of the object
        std::optional<ByteRange> range = std::nullopt;
        std::uint64_t skipped = 0;  ///< as in io::ChunkPlace
        std::string identity = {};  ///< that the shard had with this index
    };
    /// `again`: reads the shard's index anew.
    std::optional<Place> place_in_shard(std::span<const std::int64_t> index, bool again,
                                        const std::stop_token& stop) const;
    std::optional<Bytes> chunk_in_shard(std::span<const std::int64_t> index,
                                        const std::stop_token& stop) const;
    std::optional<Bytes> chunk_at(const Place& place, std::string* identity, bool again,
                                  const std::stop_token& stop) const;
    template <class Unpack>
    auto unpacked(Wanted wanted, const std::string& part, const std::string& what,
                  const std::stop_token& stop, const Unpack& unpack) const;

    std::shared_ptr<const Objects> objects_;
    ChunkedArray array_;
    mutable std::mutex mutex_;
    mutable std::condition_variable_any fetched_;
    mutable std::set<Shard> fetching_;  ///< each by one thread, for which others wait
    mutable std::map<Shard, Index> indices_;
    mutable std::list<Shard> order_;  ///< of indices_, the oldest first
    mutable std::size_t held_ = 0;    ///< places in indices_
};

}  // namespace palpate::stream
