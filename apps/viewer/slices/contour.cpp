// Finds the cells that the contour may cross, and cuts the halves of their squares.
#include "apps/viewer/slices/contour.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <numeric>

namespace palpate::viewer {
namespace {

/// A point of the slice, and by how much it lies inside the solid [data units].
struct Node {
    double u = 0, v = 0, depth = 0;
};

/// Cuts a triangle in which the field is linear.
void cut_triangle(const Node& a, const Node& b, const Node& c, std::vector<ContourPiece>& pieces) {
    const bool in_a = a.depth > 0, in_b = b.depth > 0, in_c = c.depth > 0;
    if (in_a == in_b && in_b == in_c) return;
    const auto [lone, p, q] = in_b == in_c   ? std::array{a, b, c}
                              : in_a == in_c ? std::array{b, c, a}
                                             : std::array{c, a, b};
    const double to_p = lone.depth / (lone.depth - p.depth);
    const double to_q = lone.depth / (lone.depth - q.depth);
    pieces.push_back({static_cast<float>(lone.u + to_p * (p.u - lone.u)),
                      static_cast<float>(lone.v + to_p * (p.v - lone.v)),
                      static_cast<float>(lone.u + to_q * (q.u - lone.u)),
                      static_cast<float>(lone.v + to_q * (q.v - lone.v))});
}

/// `depth(u, v)`: of a point of the slice. `nodes`: room for the corners of the squares.
void cut_cell(int u, int v, int parts, const auto& depth, std::vector<Node>& nodes,
              std::vector<ContourPiece>& pieces) {
    nodes.clear();
    for (int j = 0; j <= parts; ++j) {
        for (int i = 0; i <= parts; ++i) {
            const double at_u = u + double(i) / parts, at_v = v + double(j) / parts;
            nodes.push_back({at_u, at_v, depth(at_u, at_v)});
        }
    }
    for (int j = 0; j < parts; ++j) {
        const Node* upper = nodes.data() + std::ptrdiff_t(j) * (parts + 1);
        const Node* lower = upper + parts + 1;
        for (int i = 0; i < parts; ++i, ++upper, ++lower) {
            cut_triangle(upper[0], upper[1], lower[1], pieces);
            cut_triangle(upper[0], lower[1], lower[0], pieces);
        }
    }
}

}  // namespace

void append_contour(const SliceSamples& samples, double isovalue, const CellRange& cells, int parts,
                    std::vector<ContourPiece>& pieces) {
    const Interpolation field =
        parts == 1 ? Interpolation::linear : samples.field().interpolation();
    const double sign = samples.field().sign();
    const auto depth = [&](double u, double v) {
        return sign * (samples.value(field, u, v) - isovalue);
    };
    const int u0 = std::max(cells.u0, -2), u1 = std::min(cells.u1, samples.width() + 1);
    const int v0 = std::max(cells.v0, -2), v1 = std::min(cells.v1, samples.height() + 1);
    if (u0 >= u1) return;
    const int beyond = field == Interpolation::cubic ? 1 : 0;  // samples that count in a cell
    const int wide = 2 + 2 * beyond;
    std::vector<std::uint8_t> solid(static_cast<std::size_t>(u1 - u0 + wide - 1));  // by column
    std::vector<Node> nodes;
    for (int v = v0; v < v1; ++v) {
        const std::vector<const float*> rows = samples.rows_of_cells(field, v);
        std::ranges::fill(solid, std::uint8_t{0});
        for (const float* row : rows) {
            row += u0 - beyond;
            for (std::uint8_t& count : solid) count += sign * (double(*row++) - isovalue) > 0;
        }
        for (int u = u0; u < u1; ++u) {
            const auto first = solid.begin() + (u - u0);
            const auto inside = std::accumulate(first, first + wide, std::size_t{0});
            if (inside == 0 || inside == rows.size() * static_cast<std::size_t>(wide)) continue;
            cut_cell(u, v, parts, depth, nodes, pieces);
        }
    }
}

}  // namespace palpate::viewer
