// Samples of a fine grid from those of a coarser one. Private to stream/.
#pragma once

#include "palpate/samples.hpp"

namespace palpate::stream {

/// The part of a level's grid as a grid of its own.
Geometry geometry_of(const Geometry& level, const SampleBox& box);

/// Where samples are put: that of the box's lowest corner, and how far apart neighbours are along
/// y and z [samples].
struct Target {
    std::byte* first;
    std::ptrdiff_t row, slice;
};

/// Trilinear values at the samples of a box of `fine`; outside the coarse grid those of its border.
/// `coarse` has x fastest. The grids have the same directions. Whole numbers are rounded to
/// nearest.
void upsample(const Geometry& coarse, const std::byte* samples, SampleType type,
              const Geometry& fine, const SampleBox& box, const Target& target);

}  // namespace palpate::stream
