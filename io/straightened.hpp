// Grids whose axes are not quite at right angles.
#pragma once

#include <optional>

#include "palpate/volume.hpp"

namespace palpate::io {

/// Greatest distance between the places of the same corner in two grids of one size [mm].
double distance_between(const Geometry& a, const Geometry& b);
/// A grid whose axes are unit vectors at right angles.
struct Straightened {
    Geometry grid;
    double moved = 0;  ///< by how much samples move at most [mm]
    bool is_changed = false;
    bool is_sheared = false;  ///< or it had other lengths only
};
/// The nearest such grid, or nothing if that is too far: some sample would move by more than half
/// of the smallest spacing of axes with several samples. Rounded directions and the remains of a
/// gantry tilt are that near. The lengths of the axes' vectors do not count, as formats give the
/// spacing apart from them. A grid that check() takes stays as it is.
std::optional<Straightened> straightened(const Geometry& geometry);

}  // namespace palpate::io
