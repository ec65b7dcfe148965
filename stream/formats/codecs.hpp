// The compressions of stored chunks. None unpacks more than it is told: declared sizes are checked
// before anything is unpacked. Private to stream/.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <stdexcept>
#include <string_view>
#include <vector>

namespace palpate::stream {

enum class Codec {
    gzip,
    zstd,
    blosc,
    lz4,         ///< of numcodecs: the size and one block
    lz4_blocks,  ///< of lz4-java, which N5 uses: blocks with sizes and checksums
    crc32c,
    shuffle,  ///< of HDF5: first the first bytes of all samples, then the second ones, ...
    fletcher32,
    hdf5_lz4,         ///< blocks with big-endian sizes
    lzw,              ///< of TIFF
    difference,       ///< of TIFF: samples less the one before in their row
    float_difference  ///< of TIFF: bytes of a row, the highest of all samples first, less the one
                      ///< before
};

/// What some codecs have to know of the samples.
struct SampleRows {
    std::size_t each = 1;  ///< bytes of a sample
    std::size_t row = 1;   ///< samples of a chunk's row
    bool swapped = false;  ///< their bytes are in the other order than the machine's
};

/// By the names of Zarr 2 and 3; "zlib" is gzip, whose decoder knows both.
std::optional<Codec> codec_named(std::string_view name);

/// By the names that the helper process gives to the compressions of HDF5 and TIFF.
std::optional<Codec> codec_in_file(std::string_view name);

/// Bytes that are not what their codec writes; what() is without a file's name.
class DamagedChunk : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

/// A chunk of a kind that is not read, which another copy would be, too. what() says what to do.
class UnreadChunk : public DamagedChunk {
  public:
    using DamagedChunk::DamagedChunk;
};

/// Throws DamagedChunk: a chunk unpacks to more than `most` bytes.
[[noreturn]] void unpacks_too_long(std::size_t most);

/// Bytes without their checksum, the last four, little-endian. Throws DamagedChunk.
std::vector<std::byte> without_checksum(std::vector<std::byte> bytes,
                                        std::uint32_t (*sum_of)(std::span<const std::byte>));

/// Undoes `codecs`, the first one first. The result has `size` bytes, or DamagedChunk is thrown.
std::vector<std::byte> decoded(std::span<const Codec> codecs, std::vector<std::byte> packed,
                               std::size_t size, const SampleRows& rows = {});

/// Most bytes that `size` bytes may have when packed: no codec makes more of them.
constexpr std::size_t packed_at_most(std::size_t size) {
    return size + size / 8 + 65536;
}

/// What writers use. gzip and zstd write a checksum, blosc none.
std::vector<std::byte> packed_gzip(std::span<const std::byte> bytes, int level);
std::vector<std::byte> packed_zstd(std::span<const std::byte> bytes, int level);
/// Blosc with zstd and byte shuffle; `each`: bytes of a sample.
std::vector<std::byte> packed_blosc(std::span<const std::byte> bytes, std::size_t each, int level);
/// The checksum of Zarr's crc32c.
std::uint32_t crc32c_of(std::span<const std::byte> bytes);

}  // namespace palpate::stream
