// Which part of a store a picture deserves at which level of detail, as far as memory and requests
// allow. Pure functions; the reader is stream/detail.hpp.
#pragma once

#include <optional>
#include <vector>

#include "palpate/stream/detail.hpp"

namespace palpate::viewer {

/// A store as it is seen.
struct SeenStore {
    const stream::StoreInfo* info = nullptr;
    int finest = 0;     ///< level that is felt: pictures show nothing finer
    Geometry overview;  ///< what is there at once
};

/// A box along the grid's axes, between two of its corners, and how finely it is seen.
struct SeenBox {
    Vec3 from = Vec3::Zero(), to = Vec3::Zero();  ///< [mm, physical]
    double pixel_mm = 1;                          ///< of a device pixel

    bool operator==(const SeenBox&) const = default;
};

struct DetailLimits {
    std::int64_t most_samples = 0;  ///< of a box
    std::uint64_t most_bytes = 0;   ///< of the pieces that it lies in, unpacked
    std::int64_t most_pieces = 0;   ///< pieces, or rows of a plain file
};

/// The samples of a level that lie in the box, and `margin` more on each side; inside its grid.
SampleBox samples_in(const Geometry& level, const SeenBox& seen, const Index3& margin);

/// True if a box of a level is within the limits.
bool fits(const SeenStore& store, int level, const SampleBox& box, const DetailLimits& limits);
/// Levels that are finer than the overview, the one first that has about a sample a pixel (or the
/// finest allowed), coarser ones after it.
std::vector<int> finer_levels(const SeenStore& store, double pixel_mm);

/// The coarsest level with about a sample a pixel, else the finest that is allowed and within the
/// limits. Nothing where that is not finer than the overview.
std::optional<int> level_for(const SeenStore& store, const SeenBox& seen,
                             const DetailLimits& limits);

/// The box at every second level from the overview's to this one, coarse to fine. `box` is of
/// `level`.
std::vector<stream::DetailBox> coarse_to_fine(const SeenStore& store, int level,
                                              const SampleBox& box);

/// The box of a slice across `axis`: wider than what is seen, so that a small move needs nothing
/// new, and thicker. Pieces that are thick anyway give more layers.
SampleBox slice_box(const SeenStore& store, int level, const SeenBox& seen, int axis);
/// True if such a box still has what is seen, and the layers that a slice needs.
bool has_slice(const SeenStore& store, const stream::DetailBox& box, const SeenBox& seen, int axis);

}  // namespace palpate::viewer
