// Gives equal corners of triangles one number.
#include "mesh_tool/joined.hpp"

#include <algorithm>
#include <map>
#include <stdexcept>

namespace palpate {

std::vector<MeshTriangle> joined(std::span<const Vec3> vertices,
                                 std::span<const MeshTriangle> triangles, ReportedItems* work) {
    const auto before = [](const Vec3& a, const Vec3& b) {
        return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
    };
    std::map<Vec3, std::uint32_t, decltype(before)> numbers(before);
    std::vector<MeshTriangle> result;
    for (MeshTriangle t : triangles) {
        if (work) work->done();
        for (std::uint32_t& i : t) {
            if (i >= vertices.size()) {
                throw std::invalid_argument("a triangle names a vertex that the mesh has not");
            }
            if (!vertices[i].allFinite()) {
                throw std::invalid_argument("a mesh must have finite vertices");
            }
            i = numbers.try_emplace(vertices[i], i).first->second;
        }
        if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) result.push_back(t);
    }
    if (result.empty()) throw std::invalid_argument("a tool's mesh needs at least one triangle");
    return result;
}

}  // namespace palpate
