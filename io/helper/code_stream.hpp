// The properties of a compressed image: the size in the headers of JPEG, JPEG-LS and JPEG 2000
// code streams, and how many samples an RLE segment holds. Decoders believe these, headers of files
// may say something else. Uses no library.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace palpate::io {

struct CodeStreamSize {
    std::int64_t columns = 0, rows = 0;
    int components = 0;
    int bits = 0;  ///< of a sample
};

/// True for the first bytes of a code stream.
bool begins_code_stream(std::span<const std::byte> bytes);

/// From the frame header of JPEG and JPEG-LS (SOF, ITU-T T.81 B.2.2, T.87 C.2.2) or the SIZ marker
/// of JPEG 2000 (T.800 A.5.1; also inside a JP2 file); nothing if there is none.
std::optional<CodeStreamSize> code_stream_size(std::span<const std::byte> stream);

/// Bytes up to its end marker (EOI, EOC) and with it, whatever follows; nothing if there is none.
std::optional<std::size_t> code_stream_length(std::span<const std::byte> stream);

/// Whether a frame in DICOM's RLE (PS3.5 annex G) has this many segments of this many bytes each:
/// no less, and no more but for padding.
bool is_rle_frame(std::span<const std::byte> frame, std::size_t segments, std::uint64_t bytes);

}  // namespace palpate::io
