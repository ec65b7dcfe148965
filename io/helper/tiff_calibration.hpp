// The spacing of a TIFF stack, in the one way that microscopy software agrees on: pixels a length
// in XResolution and YResolution, the distance between slices and the unit in the description, as
// ImageJ and Fiji write them.
#pragma once

#include <optional>
#include <string>

#include "io/helper/tiff_library.hpp"
#include "palpate/volume.hpp"

namespace palpate::io {

/// Of the page at hand [mm]; nothing unless ImageJ's description gives all three lengths.
std::optional<Vec3> image_j_spacing(TIFF* tiff);

/// Refuses what ImageJ's description makes of a file's pages if they are no slices of one volume:
/// channels, times, or more of them than there are (ImageJ's own files above 4 GB have one page).
/// Throws Failure.
void check_image_j_stack(TIFF* tiff, std::size_t pages);

/// Puts the spacing [mm] of a stack into its first page, the one at hand.
void set_image_j_spacing(TIFF* tiff, const Vec3& spacing, int slices);

/// Into every page: what of it lies in the page's plane.
void set_resolution(TIFF* tiff, const Vec3& spacing);

}  // namespace palpate::io
