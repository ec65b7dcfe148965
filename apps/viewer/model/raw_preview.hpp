// What a file without a header might hold: a first guess, and pictures of its slices.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

#include "palpate/io/series.hpp"
#include "palpate/io/volume_file.hpp"
#include "palpate/run/source.hpp"

namespace palpate::viewer {

/// Whether it is a file whose name says that it has no header (.raw, .bin, .dat, also packed), and
/// its layout was not given.
bool lacks_layout(const run::Source& source);

/// The layout that a file's name tells ("head_256x256x113_uint16.raw", "-be": big-endian), else a
/// cube that fits its `bytes`, else 256^3 samples of a byte.
io::RawLayout guessed_layout(const std::filesystem::path& path, std::uint64_t bytes);

/// Bytes that the samples and what is skipped before them take.
double bytes_of(const io::RawLayout& layout);

/// Slice `z` in grey: its least sample black, its greatest white. Nothing for a packed file, one
/// that ends before the slice does, or a slice of more than 256 MB.
std::optional<io::Thumbnail> raw_slice(const std::filesystem::path& path,
                                       const io::RawLayout& layout, int z);

}  // namespace palpate::viewer
