// A page of a TIFF file: its size and the kind of its samples. Functions throw Failure.
#pragma once

#include <string>
#include <vector>

#include "io/helper/decode.hpp"
#include "io/helper/tiff_library.hpp"

namespace palpate::io {

struct TiffPage {
    std::uint32_t width = 0, height = 0;
    Stored stored = Stored::uint8;                    ///< the narrowest type that holds `bits`
    std::uint16_t bits = 8;                           ///< of a sample; rows begin at whole bytes
    std::uint16_t orientation = ORIENTATION_TOPLEFT;  ///< of its rows and columns; not applied
    bool is_packed() const { return bits != 8 * size_of(stored); }
    /// Those that so many samples of a row take.
    std::size_t bytes_of(std::size_t samples) const { return (samples * bits + 7) / 8; }
    bool operator==(const TiffPage&) const = default;
};

/// With libtiff's first error.
[[noreturn]] void fail_damaged_tiff(const std::filesystem::path& file);

/// `more`: letters of TIFFOpen's mode.
Tiff open_to_read(const std::filesystem::path& file, const std::string& more = "");

/// The current page, of grey values.
TiffPage page_of(TIFF* tiff, const std::filesystem::path& file, std::vector<std::string>& notes);

std::string text_of(const TiffPage& page);

}  // namespace palpate::io
