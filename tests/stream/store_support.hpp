// Boxes of stores compared with whole volumes.
#pragma once

#include <gtest/gtest.h>

#include <cstring>
#include <random>
#include <string>
#include <vector>

#include "io/stored.hpp"
#include "palpate/stream/store.hpp"
#include "support/scratch_folder.hpp"

namespace palpate::stream::test {

inline SampleBox random_box(std::mt19937& random, const Index3& size) {
    SampleBox box;
    for (int a = 0; a < 3; ++a) {
        const auto n = static_cast<unsigned>(size[a]);
        const int one = static_cast<int>(random() % n), other = static_cast<int>(random() % n);
        box.low[a] = std::min(one, other);
        box.high[a] = std::max(one, other);
    }
    return box;
}

inline std::size_t samples_in(const SampleBox& box) {
    std::size_t count = 1;
    for (int a = 0; a < 3; ++a) count *= static_cast<std::size_t>(box.high[a] - box.low[a] + 1);
    return count;
}

inline std::vector<std::byte> read_box(const Store& store, int level, const SampleBox& box) {
    std::vector<std::byte> samples(samples_in(box) * size_of(store.info().type));
    store.read(level, box, samples, {});
    return samples;
}

/// The same samples out of a volume.
inline std::vector<std::byte> box_of(const Volume& volume, const SampleBox& box) {
    std::vector<std::byte> samples;
    const std::size_t each = size_of(volume.type());
    const auto* const all = static_cast<const std::byte*>(volume.data());
    const Index3& size = volume.geometry().size;
    for (int z = box.low[2]; z <= box.high[2]; ++z) {
        for (int y = box.low[1]; y <= box.high[1]; ++y) {
            const std::size_t at =
                ((static_cast<std::size_t>(z) * size[1] + y) * size[0] + box.low[0]) * each;
            const std::size_t row = static_cast<std::size_t>(box.high[0] - box.low[0] + 1) * each;
            samples.insert(samples.end(), all + at, all + at + row);
        }
    }
    return samples;
}

/// One level of a store as a volume.
inline Volume volume_of(const Store& store, int level = 0) {
    const Geometry& grid = store.info().levels.at(static_cast<std::size_t>(level)).geometry;
    auto samples =
        std::make_shared<std::vector<std::byte>>(read_box(store, level, whole_box(grid)));
    return Volume(grid, store.info().type, std::shared_ptr<const void>(samples, samples->data()),
                  samples->size());
}

inline void expect_same_boxes(const Store& store, const Volume& volume, unsigned seed,
                              int level = 0) {
    ASSERT_EQ(store.info().type, volume.type());
    ASSERT_EQ(store.info().levels.at(static_cast<std::size_t>(level)).geometry.size,
              volume.geometry().size);
    EXPECT_EQ(read_box(store, level, whole_box(volume.geometry())),
              box_of(volume, whole_box(volume.geometry())));
    std::mt19937 random(seed);
    for (int i = 0; i < 40; ++i) {
        const SampleBox box = random_box(random, volume.geometry().size);
        ASSERT_EQ(read_box(store, level, box), box_of(volume, box))
            << box.low.transpose() << " to " << box.high.transpose();
    }
}

}  // namespace palpate::stream::test
