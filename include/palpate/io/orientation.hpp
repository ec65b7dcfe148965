// Three letters for the sides of the body to which the axes of a grid run, and the replacement of a
// file's orientation and spacing by given ones. Needs the core only.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "palpate/volume.hpp"

namespace palpate::io {

/// The side of the body to which each index axis runs: "LPS" for a grid along those axes. For an
/// oblique axis it is the nearest of the sides that no axis before it names.
std::string orientation_of(const Geometry& geometry);

/// The inverse, as nibabel, ITK-SNAP and 3D Slicer write it: "RAS" means that the first axis runs
/// to the right, the second to the front, the third to the head. Throws std::invalid_argument.
Mat3 direction_from(std::string_view orientation);

/// Orientation and spacing that replace those of a file.
struct GivenGrid {
    std::optional<Vec3> spacing = {};  ///< [mm]
    std::string orientation = {};      ///< three letters, or empty for that of the file
};
/// Applies them. The first sample stays where it is. Throws as direction_from() does.
void put_in(const GivenGrid& given, Geometry& geometry);

}  // namespace palpate::io
