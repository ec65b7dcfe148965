// Unpacks gzip and zlib streams to their very end, so that their checksums are verified: the
// libraries that read volumes skip that. Needs zlib only.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <stdexcept>
#include <vector>

namespace palpate::io {

/// A stream that is damaged, ends early or is too long; what() says which, without a file's name.
class DamagedStream : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

/// One that unpacks to more than StreamPlace::at_most.
class OversizedStream : public DamagedStream {
  public:
    using DamagedStream::DamagedStream;
};

/// Where a compressed stream lies in a file.
struct StreamPlace {
    std::uint64_t offset = 0;            ///< first byte of the stream
    std::uint64_t length = UINT64_MAX;   ///< bytes, or up to the end of the file
    std::uint64_t at_most = UINT64_MAX;  ///< unpacked bytes; more is an error (a guard on bombs)
};

using ByteSink = std::function<void(std::span<const std::byte>)>;

/// Unpacks the gzip (any number of members) or zlib stream in `file`, passes the bytes to `sink` in
/// order (it may be empty) and returns their number. Throws DamagedStream.
std::uint64_t inflate_checked(const std::filesystem::path& file, const StreamPlace& place,
                              const ByteSink& sink);

/// The same for a stream in memory, of at most so many unpacked bytes.
std::uint64_t inflate_checked(std::span<const std::byte> stream, std::uint64_t at_most,
                              const ByteSink& sink = {});

/// The first `bytes` of what is unpacked, or all if there are fewer. Throws DamagedStream.
std::vector<std::byte> inflate_start(const std::filesystem::path& file, std::size_t bytes);

/// True for a file that starts with gzip's two magic bytes.
bool is_gzip(const std::filesystem::path& file);

}  // namespace palpate::io
