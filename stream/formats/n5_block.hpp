// The blocks of N5, which are its chunks: https://github.com/saalfeldlab/n5. Private to stream/.
#pragma once

#include "stream/formats/chunked_array.hpp"

namespace palpate::stream {

/// The bytes of a whole chunk's samples; a block that is cut is filled up with zeros. Throws
/// DamagedChunk, also for blocks of another mode than the usual one, which hold no samples of a
/// grid.
Bytes unpacked_n5_block(const ChunkedArray& array, std::span<const std::byte> block);

}  // namespace palpate::stream
