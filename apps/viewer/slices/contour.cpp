// Cuts the lattice's tetrahedra with the slice, and the triangles with the isovalue.
#include "apps/viewer/slices/contour.hpp"

#include <algorithm>
#include <array>

namespace palpate::viewer {
namespace {

/// A corner of a triangle: where, and by how much it lies inside the solid [data units].
struct Corner {
    double u, v, depth;
};

Corner between(const Corner& a, const Corner& b, double part) {
    return {a.u + part * (b.u - a.u), a.v + part * (b.v - a.v),
            a.depth + part * (b.depth - a.depth)};
}

class Marching {
  public:
    Marching(std::vector<ContourPiece>& pieces, int u, int v) : pieces_(pieces), u_(u), v_(v) {}

    void triangle(const Corner& a, const Corner& b, const Corner& c) {
        const bool in_a = a.depth > 0, in_b = b.depth > 0, in_c = c.depth > 0;
        if (in_a == in_b && in_b == in_c) return;
        if (in_b == in_c) {
            piece(a, b, c);
        } else if (in_a == in_c) {
            piece(b, c, a);
        } else {
            piece(c, a, b);
        }
    }

  private:
    /// `lone` is on the other side than the two.
    void piece(const Corner& lone, const Corner& p, const Corner& q) {
        const Corner a = between(lone, p, lone.depth / (lone.depth - p.depth));
        const Corner b = between(lone, q, lone.depth / (lone.depth - q.depth));
        pieces_.push_back({static_cast<float>(u_ + a.u), static_cast<float>(v_ + a.v),
                           static_cast<float>(u_ + b.u), static_cast<float>(v_ + b.v)});
    }

    std::vector<ContourPiece>& pieces_;
    double u_, v_;
};

// The corners of a cell's face in the order in which one walks round it.
using Face = std::array<double, 4>;
constexpr std::array<std::array<double, 2>, 4> place{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};

double mean(const Face& f) {
    return 0.25 * ((f[0] + f[1]) + (f[2] + f[3]));
}

/// Cuts the tetrahedra of a cell `part` (0 to 1/2) of the distance from the face `near` to `far`.
/// Each corner of the cut lies on an edge of a tetrahedron, along which the field is linear.
void cut_cell(Marching& march, const Face& near, const Face& far, double part) {
    const double in = 2 * part;  // towards the cell's centre, which is half a cell away
    const Corner centre{0.5, 0.5, 0.5 * (mean(near) + mean(far))};
    const Corner middle = between({0.5, 0.5, mean(near)}, centre, in);
    std::array<Corner, 4> base, inner;
    for (std::size_t i = 0; i < 4; ++i) {
        base[i] = {place[i][0], place[i][1], near[i]};
        inner[i] = between(base[i], centre, in);
    }
    for (std::size_t i = 0; i < 4; ++i) {
        const std::size_t j = (i + 1) % 4;
        march.triangle(middle, inner[i], inner[j]);
        if (part == 0) continue;  // the tetrahedra at the face's edges are not cut
        const Corner side{0.5 * (base[i].u + base[j].u), 0.5 * (base[i].v + base[j].v),
                          0.25 * ((near[i] + near[j]) + (far[i] + far[j]))};
        const Corner side_i = between(base[i], side, in), side_j = between(base[j], side, in);
        march.triangle(inner[i], inner[j], side_i);
        march.triangle(inner[j], side_j, side_i);
        const auto upright = [&](std::size_t k) {
            return Corner{base[k].u, base[k].v, near[k] + part * (far[k] - near[k])};
        };
        march.triangle(upright(i), inner[i], side_i);
        march.triangle(upright(j), inner[j], side_j);
    }
}

/// The same by two triangles.
void cut_square(Marching& march, const Face& near, const Face& far, double part) {
    std::array<Corner, 4> c;
    for (std::size_t i = 0; i < 4; ++i) {
        c[i] = {place[i][0], place[i][1], near[i] + part * (far[i] - near[i])};
    }
    march.triangle(c[0], c[1], c[2]);
    march.triangle(c[0], c[2], c[3]);
}

}  // namespace

void append_contour(const SliceSamples& samples, double isovalue, const CellRange& cells,
                    ContourDetail detail, std::vector<ContourPiece>& pieces) {
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
            Marching march(pieces, u, v);
            if (detail == ContourDetail::lattice) {
                cut_cell(march, near, far, part);
            } else {
                cut_square(march, near, far, part);
            }
        }
    }
}

}  // namespace palpate::viewer
