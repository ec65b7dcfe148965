// Seeded volumes and small helpers for the tests of volume files.
#pragma once

#include <gtest/gtest.h>
#include <zlib.h>

#include <Eigen/Geometry>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include "palpate/io/volume_file.hpp"
#include "support/scratch_folder.hpp"

namespace palpate::io::test {

using support::bytes_of;
using support::contains;
using support::message_of;
using support::put_bytes;
using support::ScratchFolder;

inline double uniform(std::mt19937& random, double low, double high) {
    return low + (high - low) * (random() / 4294967296.0);
}

inline Geometry random_geometry(std::mt19937& random, bool oblique, bool mirrored) {
    Geometry g;
    for (int a = 0; a < 3; ++a) {
        g.size[a] = 2 + static_cast<int>(random() % 9);
        g.spacing[a] = uniform(random, 0.05, 4);
        g.origin[a] = uniform(random, -300, 300);
    }
    if (oblique) {
        const Vec3 axis = Vec3(uniform(random, -1, 1), uniform(random, -1, 1), 0.7).normalized();
        g.direction = Eigen::AngleAxisd(uniform(random, 0.1, 3), axis).toRotationMatrix();
    }
    if (mirrored) g.direction.col(2) *= -1;
    return g;
}

template <class T>
Volume random_volume(std::mt19937& random, const Geometry& geometry) {
    std::vector<T> samples(static_cast<std::size_t>(sample_count(geometry)));
    for (T& s : samples) {
        if constexpr (std::is_floating_point_v<T>) {
            s = static_cast<T>(uniform(random, -1e4, 1e4));
        } else {
            s = static_cast<T>(random());
        }
    }
    return Volume(geometry, std::move(samples));
}

inline Volume random_volume(std::mt19937& random, SampleType type, const Geometry& geometry) {
    return with_type(type,
                     [&](auto zero) { return random_volume<decltype(zero)>(random, geometry); });
}

inline bool same_samples(const Volume& a, const Volume& b) {
    return a.type() == b.type() && a.bytes() == b.bytes() &&
           std::memcmp(a.data(), b.data(), a.bytes()) == 0;
}

/// The message that reading `path` fails with; a test failure if it does not fail.
inline std::string refusal(const std::filesystem::path& path, const ReadOptions& options = {}) {
    return message_of<InputError>([&] { (void)read_volume(path, options); });
}

/// What there is to choose from; a test failure if there is no choice.
inline std::vector<SeriesInfo> choice_in(const std::filesystem::path& path,
                                         const ReadOptions& options = {}) {
    try {
        (void)read_volume(path, options);
    } catch (const SeriesChoice& choice) {
        EXPECT_EQ(choice.what(), refusal(path, options));
        return choice.series();
    }
    ADD_FAILURE() << "no choice";
    return {};
}

inline bool one_line_about(const std::string& message, const std::filesystem::path& path) {
    return message.rfind(path.string() + ": ", 0) == 0 && !contains(message, "\n") &&
           message.size() > path.string().size() + 10;
}

inline std::string all_notes(const VolumeFile& file) {
    std::string text;
    for (const auto& note : file.notes) text += note + "\n";
    return text;
}

/// The helper that is used unless another is named.
inline std::filesystem::path real_helper() {
    if (const char* const helper = std::getenv("PALPATE_IO_HELPER")) return helper;
    return std::filesystem::read_symlink("/proc/self/exe").parent_path() /
           "../../libexec/palpate/palpate-io-helper";
}

inline void put_gzip(const std::filesystem::path& path, const std::string& bytes) {
    gzFile file = gzopen(path.c_str(), "wb6");
    gzwrite(file, bytes.data(), static_cast<unsigned>(bytes.size()));
    gzclose(file);
}

/// Little-endian bytes of a number.
template <class T>
std::string little(T value) {
    std::string bytes(sizeof value, '\0');
    std::memcpy(bytes.data(), &value, sizeof value);
    return bytes;
}

}  // namespace palpate::io::test
