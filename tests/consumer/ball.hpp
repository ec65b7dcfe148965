// The volume that the consumers feel: a file of their own, so that they need no data.
#pragma once

#include <bit>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "palpate/volume.hpp"

/// A NRRD file with a ball of radius 10 mm: the samples are ten times the depth below its surface.
inline void write_ball(const std::filesystem::path& path) {
    std::ofstream file(path, std::ios::binary);
    file << "NRRD0004\ntype: short\ndimension: 3\nsizes: 32 32 32\nendian: little\n"
            "space: left-posterior-superior\nspace directions: (1,0,0) (0,1,0) (0,0,1)\n"
            "space origin: (0,0,0)\nencoding: raw\n\n";
    for (int i = 0; i < 32 * 32 * 32; ++i) {
        const palpate::Vec3 at(i % 32, i / 32 % 32, i / 1024);
        const auto sample =
            static_cast<std::int16_t>(10 * (10 - (at - palpate::Vec3(16, 16, 16)).norm()));
        const auto bits = std::bit_cast<std::uint16_t>(sample);
        file.put(static_cast<char>(bits & 255)).put(static_cast<char>(bits >> 8));
    }
    if (!file.flush()) throw std::runtime_error("cannot write " + path.string());
}
