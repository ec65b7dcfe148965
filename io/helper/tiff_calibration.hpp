// The spacing of a TIFF stack, as microscopy software agrees on it. XResolution and YResolution
// hold pixels per length. The description holds the distance between slices and the unit, as ImageJ
// and Fiji write them.
#pragma once

#include <string>

#include "io/helper/decode.hpp"
#include "io/helper/ome_xml.hpp"
#include "io/helper/tiff_library.hpp"
#include "palpate/volume.hpp"

namespace palpate::io {

/// Enters the spacing of the current page, if ImageJ wrote its description. An axis may have a unit
/// of its own.
void set_image_j_spacing(OmeImage& image, TIFF* tiff, const std::string& description);

/// What a stored number means. ImageJ keeps signed 16-bit images as unsigned samples with such a
/// calibration. Notes a calibration that is not a straight line, which is ignored.
ValueMap image_j_values(const std::string& description, Stored stored,
                        std::vector<std::string>& notes);

/// How many planes ImageJ's description tells of; 1 if it does not say.
double image_j_planes(const std::string& description);

/// Into how many moments, one after the other, ImageJ's description divides the pages, and each
/// slice of them into channels, or each channel into slices.
struct Moments {
    std::int64_t count = 1, channels = 1;
    std::string order = "XYCZT";  ///< of the pages
    FrameTimes times;
};
/// Throws Failure where it has channels of a single slice, or other counts than there are pages.
Moments image_j_moments(const std::string& description, std::size_t pages,
                        std::vector<std::string>& notes);

/// Writes the spacing [mm] of a stack into its first page, which is the current one.
void write_image_j_spacing(TIFF* tiff, const Vec3& spacing, int slices);

/// Writes the part of the spacing that lies in the page's plane; for every page.
void set_resolution(TIFF* tiff, const Vec3& spacing);

}  // namespace palpate::io
