// Filters of HDF5 that do not compress. Private to stream/.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace palpate::stream {

/// Puts the bytes of samples of `each` bytes together again; what is no whole sample stays at the
/// end.
std::vector<std::byte> unshuffled(std::span<const std::byte> bytes, std::size_t each);

/// Without its checksum, the last four bytes. Throws DamagedChunk if that is another.
std::vector<std::byte> checked_fletcher32(std::vector<std::byte> bytes);

}  // namespace palpate::stream
