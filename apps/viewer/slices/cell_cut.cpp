// The corners: 0 in the middle, then four each: inner, upright, and where each side begins and
// ends.
#include "apps/viewer/slices/cell_cut.hpp"

namespace palpate::viewer {
namespace {

constexpr std::size_t inner = 1, upright = 5, side_begin = 9, side_end = 13;

using Triangle = std::array<std::uint8_t, 3>;

constexpr std::array<Triangle, 20> all_triangles() {
    std::array<Triangle, 20> triangles{};
    const auto number = [](std::size_t corner) { return static_cast<std::uint8_t>(corner); };
    for (std::size_t i = 0; i < 4; ++i) {
        const std::size_t j = (i + 1) % 4;
        const std::uint8_t in_i = number(inner + i), in_j = number(inner + j);
        const std::uint8_t from = number(side_begin + i), to = number(side_end + i);
        triangles[i] = {0, in_i, in_j};
        triangles[4 + 4 * i] = {in_i, in_j, from};
        triangles[5 + 4 * i] = {in_j, to, from};
        triangles[6 + 4 * i] = {number(upright + i), in_i, from};
        triangles[7 + 4 * i] = {number(upright + j), in_j, to};
    }
    return triangles;
}
constexpr std::array<Triangle, 20> triangles = all_triangles();

double mean(const Face& f) {
    return 0.25 * ((f[0] + f[1]) + (f[2] + f[3]));
}

Corner between(const Corner& a, const Corner& b, double part) {
    return {a.u + part * (b.u - a.u), a.v + part * (b.v - a.v),
            a.depth + part * (b.depth - a.depth)};
}

}  // namespace

CellCut cut_of_cell(const Face& near, const Face& far, double part) {
    const double in = 2 * part;  // towards the cell's centre, which is half a cell away
    const Corner centre{0.5, 0.5, 0.5 * (mean(near) + mean(far))};
    const auto on_face = [&](std::size_t i) {
        return Corner{corner_place[i][0], corner_place[i][1], near[i]};
    };
    CellCut cut;
    cut[0] = between({0.5, 0.5, mean(near)}, centre, in);
    for (std::size_t i = 0; i < 4; ++i) {
        const std::size_t j = (i + 1) % 4;
        const Corner a = on_face(i), b = on_face(j);
        const Corner side{0.5 * (a.u + b.u), 0.5 * (a.v + b.v),
                          0.25 * ((near[i] + near[j]) + (far[i] + far[j]))};
        cut[inner + i] = between(a, centre, in);
        cut[upright + i] = {a.u, a.v, near[i] + part * (far[i] - near[i])};
        cut[side_begin + i] = between(a, side, in);
        cut[side_end + i] = between(b, side, in);
    }
    return cut;
}

std::span<const Triangle> triangles_at(double part) {
    const std::span<const Triangle> all = triangles;
    return part == 0 ? all.first(4) : all;  // the tetrahedra at the face's edges are not cut
}

}  // namespace palpate::viewer
