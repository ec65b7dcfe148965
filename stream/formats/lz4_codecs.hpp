// The ways in which formats put lz4 blocks into chunks. None unpacks more than `most` bytes. All
// throw DamagedChunk. Private to stream/.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace palpate::stream {

/// Of numcodecs: the size, four bytes, and one block.
std::vector<std::byte> unlz4(std::span<const std::byte> packed, std::size_t most);

/// Of lz4-java's LZ4BlockOutputStream, which N5 uses: blocks with sizes and checksums, the last
/// empty.
std::vector<std::byte> unlz4_blocks(std::span<const std::byte> packed, std::size_t most);

/// Of HDF5's filter 32004: the size, that of blocks, then each block after its packed size.
std::vector<std::byte> unhdf5_lz4(std::span<const std::byte> packed, std::size_t most);

}  // namespace palpate::stream
