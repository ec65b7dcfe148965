// The bytes of boxes of samples. See the header.
#include "stream/box_bytes.hpp"

#include <cstring>

namespace palpate::stream {

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
