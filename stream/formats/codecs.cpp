// The compressions of stored chunks. See the header.
#include "stream/formats/codecs.hpp"

#include <blosc.h>
#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <array>
#include <boost/crc.hpp>
#include <cstdint>
#include <cstring>
#include <memory>
#include <string>
#include <utility>

#include "io/byte_order.hpp"
#include "io/inflate.hpp"
#include "stream/formats/undo_codecs.hpp"

namespace palpate::stream {
namespace {

using Bytes = std::vector<std::byte>;

Bytes gunzip(std::span<const std::byte> packed, std::size_t most) {
    Bytes out;
    out.reserve(most);
    try {
        io::inflate_checked(packed, most, [&](std::span<const std::byte> part) {
            out.insert(out.end(), part.begin(), part.end());
        });
    } catch (const io::OversizedStream&) {
        unpacks_too_long(most);
    } catch (const io::DamagedStream& e) {
        throw DamagedChunk(std::string("is a damaged gzip stream (") + e.what() + ")");
    }
    return out;
}

Bytes unzstd(std::span<const std::byte> packed, std::size_t most) {
    Bytes out(most);
    const std::size_t size = ZSTD_decompress(out.data(), most, packed.data(), packed.size());
    if (ZSTD_isError(size) != 0) {
        throw DamagedChunk(std::string("is a damaged zstd stream (") + ZSTD_getErrorName(size) +
                           ")");
    }
    out.resize(size);
    return out;
}

Bytes unblosc(std::span<const std::byte> packed, std::size_t most) {
    std::size_t size = 0;
    if (blosc_cbuffer_validate(packed.data(), packed.size(), &size) != 0) {
        throw DamagedChunk("is no whole blosc buffer");
    }
    if (size > most) unpacks_too_long(most);
    Bytes out(size);
    const int got = size == 0 ? 0 : blosc_decompress_ctx(packed.data(), out.data(), size, 1);
    if (got < 0 || static_cast<std::size_t>(got) != size) {
        throw DamagedChunk("is a damaged blosc buffer");
    }
    return out;
}

Bytes undone(Codec codec, Bytes bytes, std::size_t most, const SampleRows& rows) {
    switch (codec) {
        case Codec::gzip:
            return gunzip(bytes, most);
        case Codec::zstd:
            return unzstd(bytes, most);
        case Codec::blosc:
            return unblosc(bytes, most);
        case Codec::lz4:
            return unlz4(bytes, most);
        case Codec::lz4_blocks:
            return unlz4_blocks(bytes, most);
        case Codec::hdf5_lz4:
            return unhdf5_lz4(bytes, most);
        case Codec::shuffle:
            return unshuffled(bytes, rows.each);
        case Codec::lzw:
            return unlzw(bytes, most);
        case Codec::difference:
            undo_differences(bytes, rows.each, rows.row, rows.swapped);
            return bytes;
        case Codec::float_difference:
            undo_float_differences(bytes, rows.each, rows.row, rows.swapped);
            return bytes;
        case Codec::fletcher32:
            return without_checksum(std::move(bytes), fletcher32_of);
        case Codec::crc32c:
            break;
    }
    return without_checksum(std::move(bytes), crc32c_of);
}

using Name = std::pair<std::string_view, Codec>;

std::optional<Codec> named(std::string_view name, std::span<const Name> codecs) {
    const auto found = std::ranges::find(codecs, name, &Name::first);
    return found == codecs.end() ? std::nullopt : std::optional(found->second);
}

}  // namespace

void unpacks_too_long(std::size_t most) {
    throw DamagedChunk("unpacks to more than the " + std::to_string(most) +
                       " bytes that its metadata declare");
}

Bytes without_checksum(Bytes bytes, std::uint32_t (*sum_of)(std::span<const std::byte>)) {
    if (bytes.size() < 4) throw DamagedChunk("is too short for its checksum");
    const std::size_t size = bytes.size() - 4;
    const auto sum = io::little_endian<std::uint32_t>(std::span(bytes).subspan(size));
    if (sum_of({bytes.data(), size}) != sum) {
        throw DamagedChunk("does not have its checksum");
    }
    bytes.resize(size);
    return bytes;
}

std::optional<Codec> codec_named(std::string_view name) {
    constexpr std::string_view prefix = "numcodecs.";
    if (name.starts_with(prefix)) name.remove_prefix(prefix.size());
    static constexpr std::array codecs = {Name{"gzip", Codec::gzip}, Name{"zlib", Codec::gzip},
                                          Name{"zstd", Codec::zstd}, Name{"blosc", Codec::blosc},
                                          Name{"lz4", Codec::lz4},   Name{"crc32c", Codec::crc32c}};
    return named(name, codecs);
}

std::optional<Codec> codec_in_file(std::string_view name) {
    static constexpr std::array codecs = {Name{"gzip", Codec::gzip},
                                          Name{"zstd", Codec::zstd},
                                          Name{"blosc", Codec::blosc},
                                          Name{"lzw", Codec::lzw},
                                          Name{"difference", Codec::difference},
                                          Name{"float_difference", Codec::float_difference},
                                          Name{"shuffle", Codec::shuffle},
                                          Name{"fletcher32", Codec::fletcher32},
                                          Name{"hdf5_lz4", Codec::hdf5_lz4}};
    return named(name, codecs);
}

Bytes decoded(std::span<const Codec> codecs, Bytes packed, std::size_t size,
              const SampleRows& rows) {
    for (std::size_t i = 0; i < codecs.size(); ++i) {
        const bool last = i + 1 == codecs.size();
        packed = undone(codecs[i], std::move(packed), last ? size : packed_at_most(size), rows);
    }
    if (packed.size() != size) {
        throw DamagedChunk("has " + std::to_string(packed.size()) + " bytes instead of the " +
                           std::to_string(size) + " that its metadata declare");
    }
    return packed;
}

Bytes packed_gzip(std::span<const std::byte> bytes, int level) {
    z_stream z{};
    constexpr int gzip_header = 15 + 16, memory = 8;
    if (deflateInit2(&z, level, Z_DEFLATED, gzip_header, memory, Z_DEFAULT_STRATEGY) != Z_OK) {
        throw std::bad_alloc();
    }
    Bytes out(deflateBound(&z, static_cast<uLong>(bytes.size())));
    z.next_in = reinterpret_cast<Bytef*>(const_cast<std::byte*>(bytes.data()));
    z.avail_in = static_cast<uInt>(bytes.size());
    z.next_out = reinterpret_cast<Bytef*>(out.data());
    z.avail_out = static_cast<uInt>(out.size());
    deflate(&z, Z_FINISH);
    out.resize(z.total_out);
    deflateEnd(&z);
    return out;
}

Bytes packed_zstd(std::span<const std::byte> bytes, int level) {
    const std::unique_ptr<ZSTD_CCtx, decltype(&ZSTD_freeCCtx)> job(ZSTD_createCCtx(),
                                                                   &ZSTD_freeCCtx);
    if (!job) throw std::bad_alloc();
    ZSTD_CCtx_setParameter(job.get(), ZSTD_c_compressionLevel, level);
    ZSTD_CCtx_setParameter(job.get(), ZSTD_c_checksumFlag, 1);
    Bytes out(ZSTD_compressBound(bytes.size()));
    const std::size_t size =
        ZSTD_compress2(job.get(), out.data(), out.size(), bytes.data(), bytes.size());
    if (ZSTD_isError(size) != 0) throw std::runtime_error(ZSTD_getErrorName(size));
    out.resize(size);
    return out;
}

Bytes packed_blosc(std::span<const std::byte> bytes, std::size_t each, int level) {
    Bytes out(bytes.size() + BLOSC_MAX_OVERHEAD);
    const int size =
        blosc_compress_ctx(level, each > 1 ? BLOSC_SHUFFLE : BLOSC_NOSHUFFLE, each, bytes.size(),
                           bytes.data(), out.data(), out.size(), BLOSC_ZSTD_COMPNAME, 0, 1);
    if (size <= 0) throw std::runtime_error("blosc cannot pack a chunk");
    out.resize(static_cast<std::size_t>(size));
    return out;
}

std::uint32_t crc32c_of(std::span<const std::byte> bytes) {
    boost::crc_optimal<32, 0x1EDC6F41, 0xFFFFFFFF, 0xFFFFFFFF, true, true> crc;
    crc.process_bytes(bytes.data(), bytes.size());
    return crc.checksum();
}

}  // namespace palpate::stream
