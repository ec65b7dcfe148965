// Cuts the lattice's tetrahedra with the slice, and the triangles with the isovalue.
#include "apps/viewer/slices/contour.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "palpate/cubic.hpp"

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

namespace {

using Point = Eigen::Vector2d;  // from the cube's centre [samples]

constexpr double straight = 0.01;  // [samples] a line may be so far from the contour
constexpr int halvings = 4;        // of a line, at most

/// That contains the point [samples from the cube's centre], of this cube's, not of a neighbour's.
Tetrahedron tetrahedron_at(const Vec3& point) {
    return cubic::locate((1 - 1e-9) * point).tetrahedron;
}

/// The field in one tetrahedron of the cube, on the slice `w` from the cube's centre.
class Section {
  public:
    Section(const Tetrahedron& tetrahedron, const Neighbours& depths, double w)
        : tetrahedron_(tetrahedron), piece_(cubic::piece_of(tetrahedron, depths)), w_(w) {}

    double depth(const Point& at) const { return piece_(folded(at)); }

    /// Where the line from one side of the contour to the other meets it.
    Point root(const Point& inside, const Point& outside) const {
        double low = 0, high = 1;
        double at_low = depth(inside), at_high = depth(outside);
        double t = 0;
        for (int i = 0; i < 40 && high - low > 1e-6; ++i) {
            t = low + (high - low) * at_low / (at_low - at_high);
            if (i % 3 == 2 || !(low < t && t < high)) t = 0.5 * (low + high);
            const double value = depth(inside + t * (outside - inside));
            if (std::abs(value) <= 1e-9 * (std::abs(at_low) + std::abs(at_high))) break;
            (value > 0 ? low : high) = t;
            (value > 0 ? at_low : at_high) = value;
        }
        return inside + t * (outside - inside);
    }
    /// The nearest point of the contour, roughly, not farther than `most`.
    Point onto_contour(Point at, double most) const {
        const Point from = at;
        for (int i = 0; i < 4; ++i) {
            const cubic::Expansion here = piece_.at(folded(at));
            const Point slope = unfold(tetrahedron_, here.gradient).head<2>();
            if (!(slope.squaredNorm() > 0)) break;
            at -= here.value / slope.squaredNorm() * slope;
        }
        return (at - from).norm() <= most ? at : from;
    }

  private:
    Vec3 folded(const Point& at) const { return fold(tetrahedron_, {at[0], at[1], w_}); }

    Tetrahedron tetrahedron_;
    cubic::Piece piece_;
    double w_;
};

/// Draws the contour in the cube round the sample (u, v).
class SmoothCell {
  public:
    SmoothCell(const Neighbours& depths, double w, int u, int v, std::vector<ContourPiece>& pieces)
        : depths_(depths), w_(w), u_(u), v_(v), pieces_(pieces) {}

    void cut() {
        const double part = 0.5 - std::abs(w_);
        const CellCut cut = cut_of_cell({}, {}, part);
        for (const auto& [a, b, c] : triangles_at(part)) cut_triangle({cut[a], cut[b], cut[c]});
    }

  private:
    static Point place(const Corner& corner) { return {corner.u - 0.5, corner.v - 0.5}; }

    /// In four parts, so that less is hidden between corners.
    void cut_triangle(const std::array<Corner, 3>& corners) {
        const Point middle = (place(corners[0]) + place(corners[1]) + place(corners[2])) / 3;
        const Section section(tetrahedron_at({middle[0], middle[1], w_}), depths_, w_);
        std::array<Corner, 3> c = corners, half;
        for (std::size_t i = 0; i < 3; ++i) {
            const Corner &a = c[i], &b = c[(i + 1) % 3];
            half[i] = {0.5 * (a.u + b.u), 0.5 * (a.v + b.v), 0};
        }
        for (auto* set : {&c, &half}) {
            for (Corner& corner : *set) corner.depth = section.depth(place(corner));
        }
        const auto draw = [&](const Corner& lone, const Corner& p, const Corner& q) {
            bend(section, root(section, lone, p), root(section, lone, q), halvings);
        };
        march(half[0], half[1], half[2], draw);
        for (std::size_t i = 0; i < 3; ++i) march(c[i], half[i], half[(i + 2) % 3], draw);
    }
    static Point root(const Section& section, const Corner& a, const Corner& b) {
        return a.depth > 0 ? section.root(place(a), place(b)) : section.root(place(b), place(a));
    }
    void bend(const Section& section, const Point& a, const Point& b, int more) {
        const Point straight_middle = 0.5 * (a + b);
        const Point middle = section.onto_contour(straight_middle, 0.5 * (b - a).norm());
        if (more > 0 && (middle - straight_middle).norm() > straight) {
            bend(section, a, middle, more - 1);
            bend(section, middle, b, more - 1);
            return;
        }
        pieces_.push_back({static_cast<float>(u_ + a[0]), static_cast<float>(v_ + a[1]),
                           static_cast<float>(u_ + b[0]), static_cast<float>(v_ + b[1])});
    }

    const Neighbours& depths_;
    double w_, u_, v_;
    std::vector<ContourPiece>& pieces_;
};

}  // namespace

void append_smooth_contour(const SliceSamples& samples, double isovalue, const CellRange& cells,
                           std::vector<ContourPiece>& pieces) {
    const double sign = samples.field().sign();
    const int nearest = samples.fraction() > 0.5 ? 1 : 0;
    const double w = samples.fraction() - nearest;
    const int u0 = std::max(cells.u0, -1), u1 = std::min(cells.u1, samples.width() + 1);
    const int v0 = std::max(cells.v0, -1), v1 = std::min(cells.v1, samples.height() + 1);
    for (int v = v0; v < v1; ++v) {
        std::array<const float*, 9> rows;
        for (int i = 0; i < 9; ++i) rows[i] = samples.row(nearest + i / 3 - 1, v + i % 3 - 1);
        const auto depth = [&](int row, int u) { return sign * (double(rows[row][u]) - isovalue); };
        const auto solid = [&](int u) {  // how many of the nine above and below each other
            int count = 0;
            for (int row = 0; row < 9; ++row) count += int(depth(row, u) > 0);
            return count;
        };
        int left = u0 < u1 ? solid(u0 - 1) : 0, here = u0 < u1 ? solid(u0) : 0;
        for (int u = u0; u < u1; ++u) {
            const int right = solid(u + 1), all = left + here + right;
            left = here;
            here = right;
            if (all == 0 || all == 27) continue;
            Neighbours depths;
            for (int i = 0; i < 27; ++i) depths[i] = depth(i / 3, u + i % 3 - 1);
            SmoothCell(depths, w, u, v, pieces).cut();
        }
    }
}

}  // namespace palpate::viewer
