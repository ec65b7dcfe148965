// How the bytes of stored pieces become samples of a store. See the header.
#include "stream/sample_bytes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "io/byte_order.hpp"
#include "stream/box_bytes.hpp"

namespace palpate::stream {

void SampleBytes::unpack(std::span<std::byte> raw, std::byte* to) const {
    if (swapped) io::swap_bytes(raw, size());
    io::convert(stored, raw.data(), type(), to, raw.size() / size(), values);
}

void note_finite(const SampleBytes& bytes, std::vector<std::string>& notes) {
    if (!io::is_real(bytes.stored) &&
        !(bytes.type() == SampleType::float32 && bytes.values.changes()))
        return;
    notes.emplace_back(
        "samples that are not finite (NaN or infinity), if there are any, become the least finite "
        "value");
}

double fitting_fill(double fill, const SampleBytes& bytes) {
    if (!std::isfinite(fill) || std::abs(fill) > std::numeric_limits<float>::max()) {
        return bytes.type() == SampleType::float32 ? std::nan("") : 0;
    }
    return with_type(bytes.type(), [&](auto zero) {
        using T = decltype(zero);
        const auto low = static_cast<double>(std::numeric_limits<T>::lowest());
        const auto high = static_cast<double>(std::numeric_limits<T>::max());
        return static_cast<double>(static_cast<T>(std::clamp(fill, low, high)));
    });
}

void check_request(const Geometry& grid, const SampleBox& box, SampleType type, std::size_t bytes) {
    if (box.empty() || (box.low.array() < 0).any() ||
        (box.high.array() >= grid.size.array()).any()) {
        throw std::invalid_argument("a box that is empty or not inside the grid");
    }
    if (bytes != bytes_of(box, type)) {
        throw std::invalid_argument("memory of another size than the box");
    }
}

}  // namespace palpate::stream
