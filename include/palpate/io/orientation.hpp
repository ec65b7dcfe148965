// Names the sides of the body that the axes of a grid run to with three letters, and replaces the
// orientation and spacing of a file by those of a person. Needs the core only.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "palpate/volume.hpp"

namespace palpate::io {

/// The side that each index axis runs to: "LPS" for a grid along those axes. An oblique axis has
/// the nearest side of the body.
std::string orientation_of(const Geometry& geometry);

/// The inverse, as nibabel, ITK-SNAP and 3D Slicer write it: "RAS" means that the first axis runs
/// to the right, the second to the front, the third to the head. Throws std::invalid_argument.
Mat3 direction_from(std::string_view orientation);

/// Replaces the orientation and spacing that a file gives or lacks.
struct GivenGrid {
    std::optional<Vec3> spacing = {};  ///< [mm]
    std::string orientation = {};      ///< three letters, or empty for that of the file
};
/// Puts it in. The first sample stays where it is. Throws as direction_from().
void put_in(const GivenGrid& given, Geometry& geometry);

}  // namespace palpate::io
