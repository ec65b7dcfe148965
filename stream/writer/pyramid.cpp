// Coarser levels of a grid. See the header.
#include "stream/writer/pyramid.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <type_traits>

#include "stream/box_bytes.hpp"

namespace palpate::stream {

CoarserGrid coarser(const Geometry& finer) {
    double least = std::numeric_limits<double>::infinity();
    for (int a = 0; a < 3; ++a) {
        if (finer.size[a] > 1) least = std::min(least, finer.spacing[a]);
    }
    CoarserGrid grid{finer, Index3::Ones()};
    Vec3 shift = Vec3::Zero();  // of sample 0 [mm, grid axes]
    for (int a = 0; a < 3; ++a) {
        if (finer.size[a] == 1 || finer.spacing[a] >= 2 * least) continue;
        grid.factor[a] = 2;
        grid.geometry.size[a] = (finer.size[a] + 1) / 2;
        grid.geometry.spacing[a] = 2 * finer.spacing[a];
        shift[a] = finer.spacing[a] / 2;
    }
    grid.geometry.origin += finer.direction * shift;
    return grid;
}

std::vector<CoarserGrid> pyramid_of(const Geometry& finest, int chunk) {
    std::vector<CoarserGrid> grids = {{finest, Index3::Ones()}};
    while ((grids.back().geometry.size.array() > chunk).any()) {
        grids.push_back(coarser(grids.back().geometry));
    }
    return grids;
}

SampleBox finer_box(const SampleBox& box, const Index3& factor, const Geometry& finer) {
    SampleBox wanted;
    for (int a = 0; a < 3; ++a) {
        wanted.low[a] = box.low[a] * factor[a];
        wanted.high[a] = std::min(box.high[a] * factor[a] + factor[a], finer.size[a]) - 1;
    }
    return wanted;
}

namespace {

template <class T>
T mean_of(double sum, int count) {
    const double mean = sum / count;
    if constexpr (std::is_integral_v<T>) return static_cast<T>(std::lround(mean));
    return static_cast<T>(mean);
}

}  // namespace

void take_means(SampleType type, std::span<const std::byte> finer, const SampleBox& finer_box,
                const Index3& factor, const SampleBox& box, std::span<std::byte> out) {
    with_type(type, [&](auto zero) {
        using T = decltype(zero);
        std::byte* to = out.data();
        for_each_index(box, [&](const Index3& at) {
            const Index3 low = at.cwiseProduct(factor);
            const Index3 high = (low + factor - Index3::Ones()).cwiseMin(finer_box.high);
            double sum = 0;
            for_each_index({low, high}, [&](const Index3& one) {
                T sample;
                std::memcpy(&sample, finer.data() + place_in(finer_box, one) * sizeof sample,
                            sizeof sample);
                sum += static_cast<double>(sample);
            });
            const T value = mean_of<T>(sum, (high - low + Index3::Ones()).prod());
            std::memcpy(to, &value, sizeof value);
            to += sizeof value;
        });
    });
}

}  // namespace palpate::stream
