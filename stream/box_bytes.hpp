// Boxes of samples: their bytes, x fastest, and the pieces that they lie in. Private to stream/.
#pragma once

#include <algorithm>
#include <vector>

#include "palpate/stream/store.hpp"

namespace palpate::stream {

/// An order of places, for maps and sets.
struct ByPlace {
    bool operator()(const Index3& a, const Index3& b) const {
        return std::ranges::lexicographical_compare(a, b);
    }
};

/// Whether stored pieces are rows, as in a plain file. Parts of rows can be read at no extra cost.
bool is_stored_in_rows(const Level& level);

/// Size of the pieces that readers request and keep [samples along each axis]. If stored pieces
/// have few samples, a piece consists of several, because each takes memory in addition to its
/// samples.
Index3 piece_of(const Level& level);

std::uint64_t bytes_of(const SampleBox& box, SampleType type);

Volume volume_from(const Geometry& geometry, SampleType type, std::vector<std::byte> bytes);

/// Calls visit(place, part) for each piece of `size` samples that a box has samples of, with these.
template <class Visit>
void for_each_piece(const Index3& size, const SampleBox& box, Visit&& visit) {
    for_each_index({box.low.cwiseQuotient(size), box.high.cwiseQuotient(size)},
                   [&](const Index3& place) {
                       const Index3 low = place.cwiseProduct(size);
                       const Index3 high = low + size - Index3::Ones();
                       visit(place, SampleBox{low.cwiseMax(box.low), high.cwiseMin(box.high)});
                   });
}

/// Where a sample of a box is among all its samples.
inline std::size_t place_in(const SampleBox& box, const Index3& at) {
    using Counts = Eigen::Matrix<std::size_t, 3, 1>;
    const Counts size = (box.high - box.low + Index3::Ones()).cast<std::size_t>();
    const Counts before = (at - box.low).cast<std::size_t>();
    return (before[2] * size[1] + before[1]) * size[0] + before[0];
}

/// Copies the part of `from` that lies in `to`; `sample` bytes each.
void copy_box(const SampleBox& from, const std::byte* source, const SampleBox& to,
              std::byte* target, std::size_t sample);

}  // namespace palpate::stream
