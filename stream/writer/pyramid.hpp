// Coarser levels of a grid: where they lie and their samples. Private to stream/.
#pragma once

#include <cstdint>
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

/// The finest grid and the coarser ones, down to one that fits into a chunk, as far as files may
/// have them (io/file_grid.hpp).
std::vector<CoarserGrid> pyramid_of(const Geometry& finest, int chunk);

/// The samples of the finer grid that those of `box` are made of.
SampleBox finer_box(const SampleBox& box, const Index3& factor, const Geometry& finer);
/// Their means, rounded where the type is one of whole numbers. At the border of the grid, of the
/// samples that there are.
void take_means(SampleType type, std::span<const std::byte> finer, const SampleBox& finer_box,
                const Index3& factor, const SampleBox& box, std::span<std::byte> out);

/// How samples of a coarser level are made of the finer ones below them.
enum class Coarsening : std::uint8_t {
    mean,
    first,  ///< one of the finer ones, the first along each axis
    middle  ///< the one in the middle, of two the second
};
/// As take_means(), for any way.
void take_coarser(Coarsening how, SampleType type, std::span<const std::byte> finer,
                  const SampleBox& finer_box, const Index3& factor, const SampleBox& box,
                  std::span<std::byte> out);

/// Finds out from stored samples how the levels of an image were made.
class CoarseningSeen {
  public:
    /// Compares the samples `coarser` of `box` with those that are below them.
    void look(SampleType type, std::span<const std::byte> finer, const SampleBox& finer_box,
              const Index3& factor, const SampleBox& box, std::span<const std::byte> coarser);
    /// Whether the samples tell. Places where the finer ones are all equal do not.
    bool is_known() const;
    /// If that is not known: the first one if no stored sample has a value that is not below it, as
    /// a mean of labels would be a label of something else. Otherwise the mean.
    Coarsening found() const;

  private:
    std::size_t telling_ = 0;  // samples above finer ones that are not all equal
    std::size_t means_ = 0;    // of these
    bool all_first_ = true, all_middle_ = true, all_below_ = true;
};

}  // namespace palpate::stream
