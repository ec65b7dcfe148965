// Reads and writes headerless files, whose layout the caller gives. Private to io/; needs zlib
// only.
#pragma once

#include "palpate/io/volume_file.hpp"

namespace palpate::io {

/// options.raw with options.spacing. Throws InputError unless it makes sense, fits the memory limit
/// (0: none) and the file, if that is not packed, has exactly its bytes.
RawLayout checked_layout(const std::filesystem::path& path, const ReadOptions& options);

/// Of a file that says nothing: without orientation, and without spacing unless `raw` or `options`
/// have one.
Geometry geometry_of(const RawLayout& raw, const ReadOptions& options);

/// Reads options.raw's layout from `path`. The file must hold exactly its bytes: skip + samples.
/// Throws InputError.
VolumeFile read_raw(const std::filesystem::path& path, const ReadOptions& options);

/// Writes the samples and nothing else. Throws OutputError.
void write_raw(const Volume& volume, const std::filesystem::path& path, const Progress& progress);

}  // namespace palpate::io
