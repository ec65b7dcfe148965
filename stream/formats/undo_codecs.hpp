// Undoes compressions and filters that no library undoes by one call. None unpacks more than `most`
// bytes. Those with `most` throw DamagedChunk. Private to stream/.
#pragma once

#include "stream/formats/codecs.hpp"

namespace palpate::stream {

/// Of numcodecs: the size, four bytes, and one block.
std::vector<std::byte> unlz4(std::span<const std::byte> packed, std::size_t most);
/// Of lz4-java's LZ4BlockOutputStream, which N5 uses: blocks with sizes and checksums, the last
/// empty. Or as unlz4(), which zarr-python writes into N5.
std::vector<std::byte> unlz4_blocks(std::span<const std::byte> packed, std::size_t most);
/// Of HDF5's filter 32004: the size, that of blocks, then each block after its packed size.
std::vector<std::byte> unhdf5_lz4(std::span<const std::byte> packed, std::size_t most);

/// Of HDF5. Puts the bytes of samples of `each` bytes together again; what is no whole sample stays
/// at the end.
std::vector<std::byte> unshuffled(std::span<const std::byte> bytes, std::size_t each);
/// The checksum of HDF5: of big-endian words of 16 bits.
std::uint32_t fletcher32_of(std::span<const std::byte> bytes);

/// Of TIFF.
std::vector<std::byte> unlzw(std::span<const std::byte> packed, std::size_t most);
/// Of TIFF. Makes samples of `each` bytes (1, 2, 4, 8) of their differences along rows of `row`
/// samples. `swapped`: their bytes are in the other order than the machine's.
void undo_differences(std::span<std::byte> bytes, std::size_t each, std::size_t row, bool swapped);
/// The same of floating-point samples (predictor 3, TIFF Technical Note 3).
void undo_float_differences(std::span<std::byte> bytes, std::size_t each, std::size_t row,
                            bool swapped);

}  // namespace palpate::stream
