// A look at the first page of a TIFF file, to choose a reader. Private to io/,
// stream/ and run/.
#pragma once

#include <algorithm>
#include <array>
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

/// .tif, .tiff, or those of OME-TIFF above 4 GB.
inline bool is_tiff_name(const std::filesystem::path& path) {
    const std::string extension = lower(path.extension().string());
    constexpr std::array names = {".tif", ".tiff", ".tf2", ".tf8", ".btf"};
    return std::ranges::find(names, extension) != names.end();
}

/// Nothing if the name is not that of TIFF or the file does not begin as such a file does.
std::optional<TiffPeek> peek_tiff(const std::filesystem::path& path);

/// The same for what a stream holds, whatever its name.
std::optional<TiffPeek> peek_tiff_in(std::istream& in);

}  // namespace palpate::io
