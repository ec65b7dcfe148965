// Triangles whose corners are known by their places, so that neighbours share vertices.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "palpate/tool.hpp"

namespace palpate {

using MeshTriangle = std::array<std::uint32_t, 3>;

/// The triangles with a number for each place in space, so that neighbours are known in files that
/// repeat their vertices (STL). Those without an area are left out. Counts each triangle as an item
/// of `work`, if there is one. Throws std::invalid_argument for vertices that are not finite or not
/// there, and if no triangle is left.
std::vector<MeshTriangle> joined(std::span<const Vec3> vertices,
                                 std::span<const MeshTriangle> triangles,
                                 ReportedItems* work = nullptr);

}  // namespace palpate
