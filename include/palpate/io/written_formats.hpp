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

/// Why a volume on this grid cannot be written as `path`, one line that begins with the path: an
/// unknown extension, a format that cannot store the origin or directions, or a data file of
/// another volume that would be replaced. Empty if it can be written.
std::string why_not_written(const std::filesystem::path& path, const Geometry& geometry);

}  // namespace palpate::io
