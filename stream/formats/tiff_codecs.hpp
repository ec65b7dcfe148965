// Compressions of TIFF that no library offers apart from reading the file: LZW, and the differences
// along rows. "TIFF Revision 6.0", Adobe 1992, sections 13 and 14. Private to stream/.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace palpate::stream {

/// Unpacks at most `most` bytes. Throws DamagedChunk.
std::vector<std::byte> unlzw(std::span<const std::byte> packed, std::size_t most);

/// Makes samples of `each` bytes (1, 2, 4, 8) of their differences along rows of `row` samples.
/// `swapped`: their bytes are in the other order than the machine's.
void undo_differences(std::span<std::byte> bytes, std::size_t each, std::size_t row, bool swapped);

}  // namespace palpate::stream
