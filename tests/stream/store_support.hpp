// Boxes of stores compared with whole volumes, and stores that are damaged.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include "io/stored.hpp"
#include "io/volume_support.hpp"
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

/// Of all files in a folder.
inline std::uint64_t bytes_in(const std::filesystem::path& folder) {
    std::uint64_t bytes = 0;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
        if (entry.is_regular_file()) bytes += entry.file_size();
    }
    return bytes;
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

/// The samples of a .raw file with stored numbers, as `type`.
inline std::vector<std::byte> converted(const std::string& raw, io::Stored stored,
                                        SampleType type) {
    const std::size_t count = raw.size() / io::size_of(stored);
    std::vector<std::byte> samples(count * size_of(type));
    io::convert(stored, reinterpret_cast<const std::byte*>(raw.data()), type, samples.data(),
                count);
    return samples;
}

inline Volume expected_volume(const Geometry& grid, const std::string& raw, io::Stored stored) {
    const auto samples =
        std::make_shared<std::vector<std::byte>>(converted(raw, stored, io::kept_as(stored)));
    return Volume(grid, io::kept_as(stored), std::shared_ptr<const void>(samples, samples->data()),
                  samples->size());
}

/// The message that opening a store fails with; a test failure if it does not fail.
inline std::string refusal(const std::string& address, const StoreOptions& options = {}) {
    return support::message_of<io::InputError>([&] { (void)open_store(address, options); });
}

/// That its message has these words.
inline void expect_refusal(const std::string& words, const std::string& address,
                           const StoreOptions& options = {}) {
    const std::string message = refusal(address, options);
    EXPECT_TRUE(support::contains(message, words)) << message;
}

/// Opens and reads all of a store; true if it did, false if it was refused in one line.
inline bool read_or_refused(const std::filesystem::path& path) {
    try {
        const auto store = open_store(path);
        if (sample_count(store->info().levels[0].geometry) < 100'000) (void)volume_of(*store);
        return true;
    } catch (const io::InputError& error) {
        EXPECT_TRUE(io::test::one_line_about(error.what(), path) ||
                    support::contains(error.what(), path.string() + "/"))
            << error.what();
    }
    return false;
}

/// Damages one file of a store (a folder, or a file itself), `times` times: cut short, or with a
/// few bytes changed. How often it was refused; what is not refused is read.
inline int refused_of_damaged(const std::filesystem::path& store, int times, std::mt19937& random) {
    namespace fs = std::filesystem;
    std::vector<fs::path> files = {store};
    if (fs::is_directory(store)) {
        files.clear();
        for (const auto& entry : fs::recursive_directory_iterator(store)) {
            if (entry.is_regular_file()) files.push_back(entry.path());
        }
    }
    std::ranges::sort(files);
    int refused = 0;
    for (int i = 0; i < times; ++i) {
        const fs::path& file = files[random() % files.size()];
        const std::string good = support::bytes_of(file);
        std::string bad = good;
        if (i % 3 == 0) {
            bad.resize(random() % good.size());
        } else {
            for (int flips = 0; flips < 1 + i % 4; ++flips) {
                bad[random() % bad.size()] = static_cast<char>(random());
            }
        }
        support::put_bytes(file, bad);
        refused += !read_or_refused(store);
        support::put_bytes(file, good);
    }
    return refused;
}

}  // namespace palpate::stream::test
