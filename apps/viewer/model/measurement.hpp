// Lengths and angles between points of a volume, and the unit and decimals for its positions.
#pragma once

#include <string>
#include <vector>

#include "palpate/volume.hpp"

namespace palpate::viewer {

enum class Measure : std::uint8_t { length, angle };

/// Automatic: the unit of the volume's positions (Ruler).
enum class LengthUnit : std::uint8_t {
    automatic,
    micrometres,
    millimetres,
    centimetres,
    inches,
    voxels,
    metres
};
/// What is preferred, but voxels where nothing gives the spacing. Never automatic.
LengthUnit unit_in(const Geometry& geometry, LengthUnit preferred = LengthUnit::millimetres);
/// "mm", or "voxel" where nothing gives the spacing. Windows translate this word, in the context
/// "Units".
const char* unit_word(const Geometry& geometry);
/// "12.3 mm". `voxel` is the word for that unit.
std::string length_text(double mm, LengthUnit unit, const std::string& voxel = "voxel");

/// A length between two points, or the angle at the middle one of three.
struct Measurement {
    Measure kind = Measure::length;
    std::vector<Vec3> points;  ///< [mm, physical] fewer than points_of(kind) while it is made

    bool operator==(const Measurement&) const = default;
};

std::size_t points_of(Measure kind);
/// "12.3 mm", "45.0°". Empty before all points are there, and for an angle without a side.
std::string text_of(const Measurement& measurement, LengthUnit unit = LengthUnit::automatic,
                    const std::string& voxel = "voxel");

/// With enough decimals for a fifth of the smallest spacing, and in micrometres if that is below
/// 10 µm, or in metres from 100 mm on.
struct Ruler {
    const char* unit = "mm";
    double per_mm = 1;
    int decimals = 1;

    /// The number without its unit, with at least so many decimals.
    std::string number(double mm, int least_decimals = 1) const;
};
Ruler ruler_of(const Geometry& geometry);

}  // namespace palpate::viewer
