// Descriptions of TIFF files other than OME-XML. ImageJ, Zeiss LSM, ScanImage and tifffile count
// the pages as slices, channels and times. XResolution and YResolution hold pixels per length. The
// description holds the distance between slices and the unit, as ImageJ and Fiji write them, and
// the meaning of stored numbers.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "io/helper/decode.hpp"
#include "io/helper/ome_xml.hpp"
#include "io/helper/tiff_library.hpp"
#include "io/helper/tiff_page.hpp"

namespace palpate::io {

/// Enters the spacing of the current page, if ImageJ wrote its description. An axis may have a unit
/// of its own.
void set_image_j_spacing(OmeImage& image, TIFF* tiff, const std::string& description);

/// The meaning of numbers. ImageJ keeps signed 16-bit images as unsigned samples with such a
/// calibration. Notes a calibration that is not a straight line, which is ignored.
ValueMap image_j_values(const std::string& description, Stored stored,
                        std::vector<std::string>& notes);

/// How many planes ImageJ's description tells of; 1 if it does not say.
double image_j_planes(const std::string& description);

/// tifffile's description, such as {"shape": [5, 7, 8], "axes": "ZYX"}; null if it is another one.
nlohmann::json told_by_tifffile(const std::string& description);
/// Its shape, such as "5x7x8".
std::string shape_in(const nlohmann::json& told);
/// How many samples such a description tells of; 0 for null.
double samples_in(const nlohmann::json& told);

/// How the pages are counted: as slices, if no program says it. Throws Failure for other counts
/// than there are pages. `description`: that of the current page, which is the first. `planes`: how
/// many pages there are, without thumbnails.
CountedPages counted_pages(TIFF* tiff, const std::string& description, const TiffPage& first,
                           std::size_t planes, std::vector<std::string>& notes);

/// Writes the spacing [mm] of a stack into its first page, which is the current one.
void write_image_j_spacing(TIFF* tiff, const Vec3& spacing, int slices);
/// Writes the part of the spacing that lies in the page's plane; for every page.
void set_resolution(TIFF* tiff, const Vec3& spacing);

}  // namespace palpate::io
