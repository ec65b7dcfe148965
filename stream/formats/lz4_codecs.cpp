// The ways in which formats put lz4 blocks into chunks. See the header.
#include "stream/formats/undo_codecs.hpp"

#define XXH_INLINE_ALL  // nothing to link
#include <lz4.h>
#include <xxhash.h>

#include <algorithm>
#include <cstring>
#include <string_view>

#include "io/byte_order.hpp"

namespace palpate::stream {

using Bytes = std::vector<std::byte>;

namespace {

/// One block, which has to fill `to`.
void unpack_block(std::span<const std::byte> packed, std::span<std::byte> to) {
    const int got = LZ4_decompress_safe(
        reinterpret_cast<const char*>(packed.data()), reinterpret_cast<char*>(to.data()),
        static_cast<int>(packed.size()), static_cast<int>(to.size()));
    if (got < 0 || static_cast<std::size_t>(got) != to.size()) {
        throw DamagedChunk("is a damaged lz4 block");
    }
}

/// A block that did not become smaller. Throws unless it is as long as `to`.
void copy_block(std::span<const std::byte> plain, std::span<std::byte> to) {
    if (plain.size() != to.size()) throw DamagedChunk("is a damaged lz4 block");
    std::ranges::copy(plain, to.begin());
}

/// One block of an LZ4BlockOutputStream of lz4-java; all numbers are little-endian.
struct Lz4Block {
    static constexpr std::size_t header_bytes = 21;
    bool stored_plain;  ///< without compression
    std::size_t packed_size, size;
    std::uint64_t checksum;
};

bool begins_with_block(std::span<const std::byte> packed) {
    static constexpr std::string_view magic = "LZ4Block";
    return packed.size() >= Lz4Block::header_bytes &&
           std::memcmp(packed.data(), magic.data(), magic.size()) == 0;
}

Lz4Block lz4_block_at(std::span<const std::byte> packed) {
    if (!begins_with_block(packed)) {
        throw DamagedChunk("is no whole stream of lz4 blocks");
    }
    const unsigned method = std::to_integer<unsigned>(packed[8]) & 0xF0U;
    const auto number_at = [&](std::size_t at) {
        return io::little_endian<std::uint32_t>(packed.subspan(at));
    };
    const Lz4Block block{method == 0x10, number_at(9), number_at(13), number_at(17)};
    if ((method != 0x10 && method != 0x20) ||
        block.packed_size > packed.size() - Lz4Block::header_bytes ||
        (block.stored_plain && block.packed_size != block.size)) {
        throw DamagedChunk("has a damaged header of an lz4 block");
    }
    return block;
}

}  // namespace

Bytes unlz4(std::span<const std::byte> packed, std::size_t most) {
    if (packed.size() < 4) throw DamagedChunk("is too short for lz4");
    const std::size_t size = io::little_endian<std::uint32_t>(packed);
    if (size > most) unpacks_too_long(most);
    Bytes out(size);
    unpack_block(packed.subspan(4), out);
    return out;
}

Bytes unlz4_blocks(std::span<const std::byte> packed, std::size_t most) {
    constexpr std::uint32_t seed = 0x9747B28C, checksum_bits = 0x0FFFFFFF;
    if (!begins_with_block(packed)) return unlz4(packed, most);
    Bytes out;
    while (true) {
        const Lz4Block block = lz4_block_at(packed);
        packed = packed.subspan(Lz4Block::header_bytes);
        if (block.size == 0) return out;  // the end
        if (block.size > most - out.size()) unpacks_too_long(most);
        out.resize(out.size() + block.size);
        const std::span<std::byte> to(out.data() + out.size() - block.size, block.size);
        const auto from = packed.first(block.packed_size);
        block.stored_plain ? copy_block(from, to) : unpack_block(from, to);
        if ((XXH32(to.data(), to.size(), seed) & checksum_bits) != block.checksum) {
            throw DamagedChunk("does not have the checksum of an lz4 block");
        }
        packed = packed.subspan(block.packed_size);
    }
}

Bytes unhdf5_lz4(std::span<const std::byte> packed, std::size_t most) {
    constexpr std::size_t header_bytes = 12;
    if (packed.size() < header_bytes) throw DamagedChunk("is too short for lz4");
    const std::uint64_t size = io::big_endian<std::uint64_t>(packed);
    const std::uint64_t block_size = io::big_endian<std::uint32_t>(packed.subspan(8));
    if (size > most) unpacks_too_long(most);
    if (block_size == 0) throw DamagedChunk("has lz4 blocks of no size");
    packed = packed.subspan(header_bytes);
    Bytes out(size);
    for (std::span<std::byte> to = out; !to.empty();) {
        const auto part = to.first(std::min<std::uint64_t>(block_size, to.size()));
        if (packed.size() < 4 || io::big_endian<std::uint32_t>(packed) > packed.size() - 4) {
            throw DamagedChunk("ends within an lz4 block");
        }
        const auto from = packed.subspan(4, io::big_endian<std::uint32_t>(packed));
        from.size() == part.size() ? copy_block(from, part) : unpack_block(from, part);
        packed = packed.subspan(4 + from.size());
        to = to.subspan(part.size());
    }
    return out;
}

}  // namespace palpate::stream
