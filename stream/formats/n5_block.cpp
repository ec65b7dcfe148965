// The blocks of N5. See the header.
#include "stream/formats/n5_block.hpp"

#include <cstring>

#include "io/byte_order.hpp"

namespace palpate::stream {
namespace {

/// Mode, number of axes, and the size along each, the fastest first.
struct N5Header {
    std::size_t bytes;
    std::vector<std::int64_t> size;  ///< the slowest axis first, as in ChunkedArray
};

N5Header header_of(const ChunkedArray& array, std::span<const std::byte> block) {
    const std::size_t axes = array.axes();
    N5Header header{4 + 4 * axes, std::vector<std::int64_t>(axes)};
    if (block.size() < header.bytes) throw DamagedChunk("is too short for the header of a block");
    const auto mode = io::big_endian<std::uint16_t>(block);
    if (mode == 1 || mode == 2) {
        throw UnreadChunk(std::string("is a block of ") +
                          (mode == 1 ? "varying length" : "objects") + " (N5's mode " +
                          std::to_string(mode) +
                          "), which is not read; write it with blocks of mode 0");
    }
    if (mode != 0) throw DamagedChunk("has a block of mode " + std::to_string(mode));
    if (io::big_endian<std::uint16_t>(block.subspan(2)) != axes) {
        throw DamagedChunk("has a block with another number of axes than its array");
    }
    for (std::size_t i = 0; i < axes; ++i) {
        const std::size_t a = axes - 1 - i;
        header.size[a] = std::int64_t{io::big_endian<std::uint32_t>(block.subspan(4 + 4 * i))};
        if (header.size[a] < 1 || header.size[a] > array.chunk[a]) {
            throw DamagedChunk("has a block of a size that is not possible");
        }
    }
    return header;
}

/// Puts the rows of a cut block to their places in a whole one.
Bytes filled_up(const ChunkedArray& array, const std::vector<std::int64_t>& size,
                const Bytes& cut) {
    const std::size_t axes = array.axes();
    const std::size_t row = static_cast<std::size_t>(size[axes - 1]) * array.bytes.size();
    Bytes whole(array.bytes_in_chunk());
    std::vector<std::int64_t> at(axes, 0);  // of the row
    for (std::size_t from = 0; from < cut.size(); from += row) {
        std::size_t to = 0;
        for (std::size_t a = 0; a < axes; ++a) {
            to = to * static_cast<std::size_t>(array.chunk[a]) + static_cast<std::size_t>(at[a]);
        }
        std::memcpy(whole.data() + to * array.bytes.size(), cut.data() + from, row);
        for (std::size_t a = axes - 1; a-- > 0;) {
            if (++at[a] < size[a]) break;
            at[a] = 0;
        }
    }
    return whole;
}

}  // namespace

Bytes unpacked_n5_block(const ChunkedArray& array, std::span<const std::byte> block) {
    const N5Header header = header_of(array, block);
    std::size_t size = array.bytes.size();
    for (const std::int64_t along : header.size) size *= static_cast<std::size_t>(along);
    const auto packed = block.subspan(header.bytes);
    Bytes samples = decoded(array.codecs, Bytes(packed.begin(), packed.end()), size);
    return header.size == array.chunk ? samples : filled_up(array, header.size, samples);
}

}  // namespace palpate::stream
