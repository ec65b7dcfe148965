// Reads PLY (text, or binary in either byte order) without a library.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <vector>

namespace palpate::io {

struct PolygonMesh {
    std::vector<std::array<double, 3>> vertices;
    std::vector<std::vector<std::int64_t>> faces;  ///< numbers of vertices, not checked
};

/// Elements in any order, with any other properties and lists, which are passed over. Throws
/// Failure.
PolygonMesh ply_mesh(const std::filesystem::path& path);

}  // namespace palpate::io
