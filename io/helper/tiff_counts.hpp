// How programs other than ImageJ count the pages of a TIFF file: Zeiss LSM, ScanImage and
// tifffile. They are times and channels as well as slices.
#pragma once

#include <array>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "io/helper/tiff_library.hpp"
#include "io/helper/tiff_page.hpp"
#include "palpate/volume.hpp"

namespace palpate::io {

struct CountedPages {
    std::string format;
    std::string order;                  ///< of the pages, such as "XYCZT"
    std::array<std::int64_t, 3> sizes;  ///< of z, channels, times
    Vec3 metres = Vec3::Zero();         ///< between samples along x, y, z; 0: it does not say
    double seconds = 0;                 ///< between times; 0: it does not say
};

/// tifffile's description, such as {"shape": [5, 7, 8], "axes": "ZYX"}; null if it is another one.
nlohmann::json told_by_tifffile(const std::string& description);

/// Its shape, such as "5x7x8".
std::string shape_in(const nlohmann::json& told);

/// How many samples such a description tells of; 0 for null.
double samples_in(const nlohmann::json& told);

/// Nothing if none of these programs says how the pages are counted. Throws Failure for other
/// counts than there are pages. `description`: that of the current page, which is the first.
/// `planes`: how many pages there are, without thumbnails.
std::optional<CountedPages> counted_pages(TIFF* tiff, const std::string& description,
                                          const TiffPage& first, std::size_t planes,
                                          std::vector<std::string>& notes);

}  // namespace palpate::io
