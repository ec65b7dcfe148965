// What a volume can be written as. Needs the core only.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include "palpate/volume.hpp"

namespace palpate::io {

/// The extensions that write_volume knows, with their dots: ".nrrd", ..., ".nii.gz", ...
std::span<const std::string_view> written_extensions();

/// The one of them that `path` ends with; empty if there is none. Lower case only: the formats'
/// libraries write what else they are given under a name of their own.
std::string_view written_extension_of(const std::filesystem::path& path);

/// What is wrong with writing a volume on this grid as `path`, one line that begins with the path:
/// an extension that is none of them, a format that would lose where the volume lies, or a data
/// file of another volume in its place. Empty if nothing is.
std::string why_not_written(const std::filesystem::path& path, const Geometry& geometry);

}  // namespace palpate::io
