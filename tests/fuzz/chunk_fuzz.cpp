// Any bytes are a chunk that unpacks to its declared size, or damage of one line: all codecs, alone
// and in the orders that formats use, and blocks of N5. The first byte chooses, the second gives
// the size.
#include <cstdint>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "fuzz/require.hpp"
#include "io/tiff_peek.hpp"
#include "stream/formats/chunked_array.hpp"

namespace {

using namespace palpate::stream;

/// In the order of decoding.
const std::vector<std::vector<Codec>>& pipelines() {
    static const std::vector<std::vector<Codec>> all = {
        {},
        {Codec::gzip},
        {Codec::zstd},
        {Codec::blosc},
        {Codec::lz4},
        {Codec::lz4_blocks},
        {Codec::crc32c},
        {Codec::fletcher32},
        {Codec::hdf5_lz4},
        {Codec::lzw},
        {Codec::lzw, Codec::difference},
        {Codec::fletcher32, Codec::gzip, Codec::shuffle},
        {Codec::crc32c, Codec::zstd},
        {Codec::gzip, Codec::blosc}};
    return all;
}

ChunkedArray array_of(std::uint8_t size) {
    ChunkedArray array;
    array.chunk = {1 + size % 3, 1 + size / 3 % 5, 1 + size / 15};
    array.shape = array.chunk;
    array.stored_axes = {0, 1, 2};
    array.bytes.stored = size % 2 == 0 ? palpate::io::Stored::uint16 : palpate::io::Stored::float64;
    array.bytes.swapped = size % 7 == 0;
    return array;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size < 2) return 0;
    const std::size_t count = pipelines().size();
    const auto* const begin = reinterpret_cast<const std::byte*>(data + 2);
    if (data[0] == 255) {
        std::istringstream text(std::string(reinterpret_cast<const char*>(begin), size - 2));
        (void)palpate::io::peek_tiff_in(text);
        return 0;
    }
    ChunkedArray array = array_of(data[1]);
    array.codecs = pipelines()[data[0] % count];
    array.n5_blocks = data[0] / count % 2 == 1;
    check(array);
    const std::uint64_t skipped = data[0] / count / 2;  // as HDF5 leaves out filters
    try {
        const Bytes samples = unpacked_chunk(array, Bytes(begin, begin + (size - 2)), skipped);
        require(samples.size() == array.bytes_in_chunk());
    } catch (const DamagedChunk& damage) {
        require_one_line(damage.what());
    }
    return 0;
}
