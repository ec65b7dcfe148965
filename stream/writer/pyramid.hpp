// Coarser levels of a grid: where they lie and their samples. Private to stream/.
#pragma once

#include <span>
#include <vector>

#include "palpate/samples.hpp"

namespace palpate::stream {

struct CoarserGrid {
    Geometry geometry;
    Index3 factor;  ///< samples of the finer level that one is the mean of, 1 or 2 along each axis
};
/// The next coarser level: half as fine along the axes with a spacing below twice the least one.
CoarserGrid coarser(const Geometry& finer);

/// The finest grid and the coarser ones, down to one that fits into a chunk.
std::vector<CoarserGrid> pyramid_of(const Geometry& finest, int chunk);

/// The samples of the finer grid that those of `box` are made of.
SampleBox finer_box(const SampleBox& box, const Index3& factor, const Geometry& finer);
/// Their means, rounded where the type is one of whole numbers. At the border of the grid, of the
/// samples that there are.
void take_means(SampleType type, std::span<const std::byte> finer, const SampleBox& finer_box,
                const Index3& factor, const SampleBox& box, std::span<std::byte> out);

}  // namespace palpate::stream
