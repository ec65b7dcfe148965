// The planes of a TIFF file by OME-XML, ImageJ's or tifffile's description: the page of each plane,
// their spacing, channels and times, and the meaning of their numbers. Reading it whole and reading
// it by the tile both use this. Functions throw Failure.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "io/helper/decode.hpp"
#include "io/helper/ome_xml.hpp"
#include "io/helper/tiff_library.hpp"

namespace palpate::io {

constexpr std::size_t most_tiff_levels = 64;

struct TiffLayout {
    OmeImage image;
    ValueMap values;
    /// Where each page's directory lies: libtiff finds a page by its number from the first one on.
    std::vector<std::uint64_t> directories = {};
    /// Pages of coarser levels, of a file of one plane with such pages instead of SubIFDs.
    std::vector<std::uint32_t> reduced = {};
    /// Where planes follow each other behind the only page, numbered by image.pages; 0: by pages.
    std::uint64_t plain_from = 0;
};

/// Leaves the first page as the current one.
TiffLayout layout_of(TIFF* tiff, const std::filesystem::path& file,
                     std::vector<std::string>& notes);

/// Images that tifffile wrote with one call, which describes the first one's page.
struct TiffSeries {
    std::size_t first = 0;  ///< of TiffPages::whole
    double planes = 1;
    std::string shape;  ///< such as "5x20x30"
};

/// Every page in the file's list but masks, and which of them are reduced ones; where the
/// directories of all lie.
struct TiffPages {
    std::vector<std::uint32_t> whole, reduced;
    std::vector<std::uint64_t> directories;
    std::vector<TiffSeries> series;
    bool is_circle = false;  ///< the last page leads back to an earlier one
};
TiffPages pages_of(TIFF* tiff, const std::filesystem::path& file);

/// The pages of the first of several series, which have nothing to do with each other. Otherwise,
/// or if each series is one page, as of slices that were written one by one: all of them.
std::vector<std::uint32_t> pages_of_first_series(const TiffPages& pages);

/// Offsets of the coarser levels of the current page.
std::vector<std::uint64_t> coarser_levels(TIFF* tiff);

/// The current page's description; empty if it has none.
std::string description_of(TIFF* tiff);

}  // namespace palpate::io
