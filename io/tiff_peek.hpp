// A look at the first page of a TIFF file, to choose a reader. Private to io/,
// stream/ and run/.
#pragma once

#include <filesystem>
#include <istream>
#include <optional>
#include <string>

#include "io/words.hpp"

namespace palpate::io {

struct TiffPeek {
    bool tiled = false;
    bool has_levels = false;  ///< coarser ones, in SubIFDs
};

/// .tif or .tiff.
inline bool is_tiff_name(const std::filesystem::path& path) {
    const std::string extension = lower(path.extension().string());
    return extension == ".tif" || extension == ".tiff";
}

/// Nothing if the name does not end in .tif or .tiff or the file does not begin as such a file
/// does.
std::optional<TiffPeek> peek_tiff(const std::filesystem::path& path);

/// The same for what a stream holds, whatever its name.
std::optional<TiffPeek> peek_tiff_in(std::istream& in);

}  // namespace palpate::io
