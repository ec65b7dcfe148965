// The bytes of boxes of samples. See the header.
#include "stream/box_bytes.hpp"

#include <cstring>

namespace palpate::stream {

bool is_stored_in_rows(const Level& level) {
    return level.chunk[1] == 1 && level.chunk[2] == 1;
}

Index3 piece_of(const Level& level) {
    constexpr std::int64_t few = 4096;
    const Index3& size = level.geometry.size;
    Index3 piece = level.chunk;
    while (piece.cast<std::int64_t>().prod() < few && (piece.array() < size.array()).any()) {
        int shortest = -1;
        for (int a = 0; a < 3; ++a) {
            const bool may_grow = piece[a] < size[a];
            if (may_grow && (shortest < 0 || piece[a] < piece[shortest])) shortest = a;
        }
        piece[shortest] += level.chunk[shortest];
    }
    return piece;
}

std::uint64_t bytes_of(const SampleBox& box, SampleType type) {
    const Index3 size = box.high - box.low + Index3::Ones();
    return static_cast<std::uint64_t>(size.cast<std::int64_t>().prod()) * size_of(type);
}

Volume volume_from(const Geometry& geometry, SampleType type, std::vector<std::byte> bytes) {
    const auto held = std::make_shared<const std::vector<std::byte>>(std::move(bytes));
    return {geometry, type, std::shared_ptr<const void>(held, held->data()), held->size()};
}

void copy_box(const SampleBox& from, const std::byte* source, const SampleBox& to,
              std::byte* target, std::size_t sample) {
    const Index3 low = from.low.cwiseMax(to.low), high = from.high.cwiseMin(to.high);
    const auto row = static_cast<std::size_t>(high[0] - low[0] + 1) * sample;
    for (int z = low[2]; z <= high[2]; ++z) {
        for (int y = low[1]; y <= high[1]; ++y) {
            const Index3 first(low[0], y, z);
            std::memcpy(target + place_in(to, first) * sample,
                        source + place_in(from, first) * sample, row);
        }
    }
}

}  // namespace palpate::stream
