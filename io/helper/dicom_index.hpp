// The index of a folder of DICOM files (DICOMDIR, PS3.3 annex F), which lists them.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace palpate::io {

/// The images that `index` lists and that are none of `files`, as it names them. None if it lists
/// no image at all that is there, because the files have other names now. Throws Failure if the
/// index cannot be read.
std::vector<std::string> images_missing(const std::filesystem::path& index,
                                        const std::vector<std::filesystem::path>& files);

}  // namespace palpate::io
