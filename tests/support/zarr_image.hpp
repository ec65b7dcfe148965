// An image with levels, channels and times on disk.
#pragma once

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>

#include "palpate/volume.hpp"

namespace palpate::support {

/// An OME-Zarr 0.4 of 2 times, 2 channels and 2 levels, uncompressed: balls of another radius each.
inline void put_image(const std::filesystem::path& folder) {
    std::filesystem::create_directories(folder);
    std::ofstream(folder / ".zgroup") << R"({"zarr_format": 2})";
    std::ofstream(folder / ".zattrs") << R"({"multiscales": [{"version": "0.4", "axes": [
        {"name": "t", "type": "time", "unit": "second"}, {"name": "c", "type": "channel"},
        {"name": "z", "type": "space", "unit": "millimeter"},
        {"name": "y", "type": "space", "unit": "millimeter"},
        {"name": "x", "type": "space", "unit": "millimeter"}], "datasets": [
        {"path": "0", "coordinateTransformations": [{"type": "scale", "scale": [1, 1, 1, 1, 1]}]},
        {"path": "1", "coordinateTransformations": [{"type": "scale", "scale": [1, 1, 2, 2, 2]}]}]}]})";
    for (int level = 0; level < 2; ++level) {
        const int n = 32 >> level;
        const std::string size = std::to_string(n);
        const std::string grid = "[2, 2, " + size + ", " + size + ", " + size + "]";
        const std::string chunk = "[1, 1, " + size + ", " + size + ", " + size + "]";
        const auto array = folder / std::to_string(level);
        std::filesystem::create_directories(array);
        std::ofstream(array / ".zarray")
            << R"({"zarr_format": 2, "shape": )" << grid << R"(, "chunks": )" << chunk
            << R"(, "dtype": "|u1", "compressor": null, "fill_value": 0, "order": "C",)"
            << R"( "filters": null, "dimension_separator": "."})";
        for (int image = 0; image < 4; ++image) {
            const double radius = (6 + 2 * image) / (level + 1.0);
            std::string bytes;
            for (int i = 0; i < n * n * n; ++i) {
                const Vec3 at(i % n, i / n % n, i / (n * n));
                const double inside = radius - (at - Vec3::Constant(0.5 * (n - 1))).norm();
                bytes += static_cast<char>(
                    static_cast<unsigned char>(std::clamp(128 + 30 * inside, 0.0, 255.0)));
            }
            std::ofstream(
                array / (std::to_string(image / 2) + "." + std::to_string(image % 2) + ".0.0.0"),
                std::ios::binary)
                << bytes;
        }
    }
}

}  // namespace palpate::support
