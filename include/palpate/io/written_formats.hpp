// The formats in which a volume can be written. Needs the core only.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include "palpate/volume.hpp"

namespace palpate::io {

/// The extensions that write_volume knows, with their dots: ".nrrd", ..., ".nii.gz", ...
std::span<const std::string_view> written_extensions();

/// The one of them that `path` ends with; empty if there is none. Lower case only, because the
/// formats' libraries change the names of files with other extensions.
std::string_view written_extension_of(const std::filesystem::path& path);

/// The file beside the header `path` (.nhdr, .mhd) to which write_volume writes the samples. Empty
/// for formats of one file.
std::filesystem::path data_file_of(const std::filesystem::path& path, bool compress);

/// Why files of this name are never compressed, in a sentence that begins with the extension. Empty
/// if they can be.
std::string why_not_compressed(const std::filesystem::path& path);

/// The reason why a volume on this grid cannot be written as `path`, in one line that begins with
/// the path. The extension may be unknown, the format may be unable to store the origin or
/// directions, or a data file of another volume would be replaced. Empty if it can be written.
std::string why_not_written(const std::filesystem::path& path, const Geometry& geometry,
                            bool compress = false);

}  // namespace palpate::io
