// Finds the points that can be reached from outside without passing through the solid, which tells
// a proxy that fell through a wall from one that went round it.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "palpate/lattice.hpp"

namespace palpate::evaluation {

/// The free space that is connected with all that lies outside the grid, exactly: the field is
/// linear in each tetrahedron, so the free part of one is convex and holds its lowest corner, and
/// two free corners are joined by a free edge. Connected corners of the lattice (samples, face and
/// cell centres) are therefore connected free space. Takes a byte a voxel.
///
/// A smooth field's free space is not decided that way. For the smooth field of a closed shell,
/// whose density falls all the way from the middle of the wall to either side, a point goes down
/// along the gradient until it is clear of the wall, where the linear field of the same samples
/// tells.
class Outside {
  public:
    /// `alive` is called now and then and may throw, for a large volume takes some time. Throws
    /// std::invalid_argument where the background is solid: there is no outside then.
    Outside(const Field& field, double isovalue, const std::function<void()>& alive);

    /// Whether a free point belongs to it. (A point in the solid: whether the tetrahedron's lowest
    /// corner does.)
    bool holds(const Vec3& physical) const;
    /// The same for a point of the linear lattice.
    bool holds(const LatticePoint& point) const;

  private:
    double excess_at(const Index3& corner) const;
    bool within(const Index3& corner) const;
    bool reached(const Index3& corner) const;
    void reach(const Index3& corner);
    void flood(const std::function<void()>& alive);

    // Corners in half voxels: samples are even, centres odd along the axes that they halve. From
    // -2 (a sample of background) to 2 size.
    std::size_t bit_of(const Index3& corner) const;

    Field field_;
    double isovalue_;
    Index3 extent_;  ///< corners along each axis, counted in half voxels
    std::vector<std::uint64_t> bits_;
};

}  // namespace palpate::evaluation
