// Opens TIFF files with libtiff, whose errors are kept instead of printed.
#pragma once

#include <tiffio.h>

#include <filesystem>
#include <memory>
#include <string>

namespace palpate::io {

using Tiff = std::unique_ptr<TIFF, decltype(&TIFFClose)>;

/// TIFFOpen; null if that fails. `mode` as there: "r", "w", with letters after it.
Tiff open_tiff(const std::filesystem::path& file, const char* mode);

/// libtiff's first error since open_tiff(); empty if there was none.
const std::string& first_tiff_error();

/// Whether since then a page did not say how long its samples are, or something impossible: libtiff
/// goes by the size of the page and takes what lies there.
bool guessed_tiff_lengths();

}  // namespace palpate::io
