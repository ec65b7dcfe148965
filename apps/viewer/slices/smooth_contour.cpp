// Cuts each cube with the slice; in each triangle of the cut the field is one cubic.
#include "apps/viewer/slices/smooth_contour.hpp"

#include <algorithm>
#include <cmath>

#include "apps/viewer/slices/cell_cut.hpp"
#include "palpate/cubic.hpp"

namespace palpate::viewer {
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
