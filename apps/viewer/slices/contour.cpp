// Cuts the lattice's tetrahedra with the slice, and the triangles with the isovalue.
#include "apps/viewer/slices/contour.hpp"

#include <algorithm>
#include <array>

#include "apps/viewer/slices/cell_cut.hpp"
#include "apps/viewer/slices/smooth_contour.hpp"

namespace palpate::viewer {
namespace {

/// Draws the contour of fields that are linear in triangles, in the cell at (u, v).
class LinearCell {
  public:
    LinearCell(std::vector<ContourPiece>& pieces, int u, int v) : pieces_(pieces), u_(u), v_(v) {}

    void triangle(const Corner& a, const Corner& b, const Corner& c) {
        march(a, b, c, [this](const Corner& lone, const Corner& p, const Corner& q) {
            const auto [u0, v0] = root(lone, p);
            const auto [u1, v1] = root(lone, q);
            pieces_.push_back({u0, v0, u1, v1});
        });
    }

  private:
    std::array<float, 2> root(const Corner& a, const Corner& b) const {
        const double part = a.depth / (a.depth - b.depth);
        return {static_cast<float>(u_ + a.u + part * (b.u - a.u)),
                static_cast<float>(v_ + a.v + part * (b.v - a.v))};
    }

    std::vector<ContourPiece>& pieces_;
    double u_, v_;
};

void cut_cell(LinearCell& cell, const Face& near, const Face& far, double part) {
    const CellCut cut = cut_of_cell(near, far, part);
    for (const auto& [a, b, c] : triangles_at(part)) cell.triangle(cut[a], cut[b], cut[c]);
}

/// The same by two triangles.
void cut_square(LinearCell& cell, const Face& near, const Face& far, double part) {
    std::array<Corner, 4> c;
    for (std::size_t i = 0; i < 4; ++i) {
        c[i] = {corner_place[i][0], corner_place[i][1], near[i] + part * (far[i] - near[i])};
    }
    cell.triangle(c[0], c[1], c[2]);
    cell.triangle(c[0], c[2], c[3]);
}

}  // namespace

void append_contour(const SliceSamples& samples, double isovalue, const CellRange& cells,
                    ContourDetail detail, std::vector<ContourPiece>& pieces) {
    if (samples.field().interpolation() == Interpolation::cubic &&
        detail == ContourDetail::lattice) {
        append_smooth_contour(samples, isovalue, cells, pieces);
        return;
    }
    const double sign = samples.field().sign();
    const bool towards_next = samples.fraction() > 0.5;
    const int near_layer = towards_next ? 1 : 0;
    const double part = towards_next ? 1 - samples.fraction() : samples.fraction();
    const int far_layer = part > 0 ? 1 - near_layer : near_layer;
    const auto depth = [&](float value) { return sign * (double(value) - isovalue); };
    const int u0 = std::max(cells.u0, -1), u1 = std::min(cells.u1, samples.width());
    const int v0 = std::max(cells.v0, -1), v1 = std::min(cells.v1, samples.height());
    for (int v = v0; v < v1; ++v) {
        const float* const n0 = samples.row(near_layer, v);
        const float* const n1 = samples.row(near_layer, v + 1);
        const float* const f0 = samples.row(far_layer, v);
        const float* const f1 = samples.row(far_layer, v + 1);
        const auto solid = [&](int u) {  // how many of the four above and below each other
            return int(depth(n0[u]) > 0) + int(depth(n1[u]) > 0) + int(depth(f0[u]) > 0) +
                   int(depth(f1[u]) > 0);
        };
        int left = u0 < u1 ? solid(u0) : 0;
        for (int u = u0; u < u1; ++u) {
            const int right = solid(u + 1), both = left + right;
            left = right;
            if (both == 0 || both == 8) continue;
            const Face near{depth(n0[u]), depth(n0[u + 1]), depth(n1[u + 1]), depth(n1[u])};
            const Face far{depth(f0[u]), depth(f0[u + 1]), depth(f1[u + 1]), depth(f1[u])};
            LinearCell cell(pieces, u, v);
            if (detail == ContourDetail::lattice) {
                cut_cell(cell, near, far, part);
            } else {
                cut_square(cell, near, far, part);
            }
        }
    }
}

}  // namespace palpate::viewer
