// A tree of axis-aligned boxes over triangles, for the first hit of a segment: what a proxy on an
// explicit mesh asks in every tick. Median split of the longest side, up to four triangles a leaf,
// 32 bytes a node. Standard library only.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace palpate::evaluation {

using Point3 = std::array<float, 3>;
using Triangle = std::array<std::uint32_t, 3>;

class AabbTree {
  public:
    /// Reorders the triangles; both arrays have to outlive the tree.
    AabbTree(std::span<const Point3> points, std::span<Triangle> triangles)
        : points_(points), triangles_(triangles) {
        if (!triangles.empty()) build();
    }

    /// How far along the segment, 0 to 1, it first meets a triangle; NaN without a hit.
    double first_hit(const std::array<double, 3>& from, const std::array<double, 3>& to) const;

    std::size_t bytes() const { return nodes_.size() * sizeof(Node); }

  private:
    struct Node {
        Point3 low, high;
        std::uint32_t first = 0;  // triangle of a leaf, else the left child; the right one follows
        std::uint32_t count = 0;  // triangles of a leaf, else 0
    };
    static constexpr std::uint32_t leaf_size = 4;
    static constexpr std::size_t deepest = 64;  // median splits: 2^32 triangles are 30 levels

    static constexpr double out_of_reach = std::numeric_limits<double>::infinity();

    struct Ray {
        std::array<double, 3> origin, direction, inverse;
    };

    /// Middle of a triangle and which one it is, side by side: what splitting reads.
    struct Item {
        Point3 middle;
        std::uint32_t triangle;
    };

    void build();
    std::vector<Item> split();
    void enclose();
    static double entry(const Node& node, const Ray& ray, double nearest);
    double hit(const Triangle& triangle, const Ray& ray, double nearest) const;

    std::span<const Point3> points_;
    std::span<Triangle> triangles_;
    std::vector<Node> nodes_;
};

/// Nodes without their boxes; the items in the order of the leaves.
inline std::vector<AabbTree::Item> AabbTree::split() {
    std::vector<Item> items(triangles_.size());
    for (std::uint32_t i = 0; i < items.size(); ++i) {
        const Triangle& t = triangles_[i];
        for (std::size_t a = 0; a < 3; ++a) {
            items[i].middle[a] = points_[t[0]][a] + points_[t[1]][a] + points_[t[2]][a];
        }
        items[i].triangle = i;
    }
    nodes_.push_back({{}, {}, 0, static_cast<std::uint32_t>(items.size())});
    // Children are appended behind the nodes that are still to be split, so this meets them all.
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
        const Node node = nodes_[i];
        if (node.count <= leaf_size) continue;
        const auto begin = items.begin() + node.first;
        Point3 low = begin->middle, high = low;
        for (auto item = begin; item != begin + node.count; ++item) {
            for (std::size_t a = 0; a < 3; ++a) {
                low[a] = std::min(low[a], item->middle[a]);
                high[a] = std::max(high[a], item->middle[a]);
            }
        }
        std::size_t axis = 0;
        for (std::size_t a = 1; a < 3; ++a) {
            if (high[a] - low[a] > high[axis] - low[axis]) axis = a;
        }
        const std::uint32_t half = node.count / 2;
        std::nth_element(
            begin, begin + half, begin + node.count,
            [&](const Item& l, const Item& r) { return l.middle[axis] < r.middle[axis]; });
        nodes_[i].first = static_cast<std::uint32_t>(nodes_.size());
        nodes_[i].count = 0;
        nodes_.push_back({{}, {}, node.first, half});
        nodes_.push_back({{}, {}, node.first + half, node.count - half});
    }
    return items;
}

/// The boxes, from the leaves up: children come behind their parents.
inline void AabbTree::enclose() {
    for (auto node = nodes_.rbegin(); node != nodes_.rend(); ++node) {
        node->low.fill(std::numeric_limits<float>::max());
        node->high.fill(std::numeric_limits<float>::lowest());
        const auto take_in = [&](const Point3& low, const Point3& high) {
            for (std::size_t a = 0; a < 3; ++a) {
                node->low[a] = std::min(node->low[a], low[a]);
                node->high[a] = std::max(node->high[a], high[a]);
            }
        };
        if (node->count == 0) {
            for (const std::uint32_t child : {node->first, node->first + 1}) {
                take_in(nodes_[child].low, nodes_[child].high);
            }
            continue;
        }
        for (const Triangle& triangle : triangles_.subspan(node->first, node->count)) {
            for (const std::uint32_t corner : triangle) take_in(points_[corner], points_[corner]);
        }
    }
}

inline void AabbTree::build() {
    nodes_.reserve(triangles_.size());
    const std::vector<Triangle> unordered(triangles_.begin(), triangles_.end());
    const std::vector<Item> items = split();
    for (std::size_t i = 0; i < items.size(); ++i) triangles_[i] = unordered[items[i].triangle];
    enclose();
}

/// Where the ray enters the box; infinity if it misses it or enters beyond `nearest`.
inline double AabbTree::entry(const Node& node, const Ray& ray, double nearest) {
    double in = 0, out = nearest;
    for (std::size_t a = 0; a < 3; ++a) {
        if (ray.direction[a] == 0) {
            if (ray.origin[a] < node.low[a] || ray.origin[a] > node.high[a]) return out_of_reach;
            continue;
        }
        const double to_low = (node.low[a] - ray.origin[a]) * ray.inverse[a];
        const double to_high = (node.high[a] - ray.origin[a]) * ray.inverse[a];
        in = std::max(in, std::min(to_low, to_high));
        out = std::min(out, std::max(to_low, to_high));
    }
    return in <= out ? in : out_of_reach;
}

/// Moeller and Trumbore 1997; infinity without a hit before `nearest`.
inline double AabbTree::hit(const Triangle& triangle, const Ray& ray, double nearest) const {
    using V = std::array<double, 3>;
    const auto minus = [](const auto& a, const auto& b) {
        return V{double(a[0]) - b[0], double(a[1]) - b[1], double(a[2]) - b[2]};
    };
    const auto cross = [](const V& a, const V& b) {
        return V{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
    };
    const auto dot = [](const V& a, const V& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; };
    const Point3& corner = points_[triangle[0]];
    const V side = minus(points_[triangle[1]], corner);
    const V other = minus(points_[triangle[2]], corner);
    const V p = cross(ray.direction, other);
    const double determinant = dot(side, p);
    if (determinant == 0) return out_of_reach;
    const V s = minus(ray.origin, corner);
    const double u = dot(s, p) / determinant;
    if (!(u >= 0 && u <= 1)) return out_of_reach;
    const V q = cross(s, side);
    const double v = dot(ray.direction, q) / determinant;
    if (!(v >= 0 && u + v <= 1)) return out_of_reach;
    const double t = dot(other, q) / determinant;
    return t >= 0 && t <= nearest ? t : out_of_reach;
}

inline double AabbTree::first_hit(const std::array<double, 3>& from,
                                  const std::array<double, 3>& to) const {
    Ray ray{from, {}, {}};
    for (std::size_t a = 0; a < 3; ++a) {
        ray.direction[a] = to[a] - from[a];
        ray.inverse[a] = 1 / ray.direction[a];
    }
    double nearest = 1;
    bool any = false;
    std::array<std::uint32_t, deepest> open;
    std::size_t count = 0;
    if (!nodes_.empty() && std::isfinite(entry(nodes_[0], ray, nearest))) open[count++] = 0;
    while (count > 0) {
        const Node& node = nodes_[open[--count]];
        if (node.count > 0) {
            for (const Triangle& triangle : triangles_.subspan(node.first, node.count)) {
                const double t = hit(triangle, ray, nearest);
                if (!std::isfinite(t)) continue;
                nearest = t;
                any = true;
            }
            continue;
        }
        const double left = entry(nodes_[node.first], ray, nearest);
        const double right = entry(nodes_[node.first + 1], ray, nearest);
        const bool left_first = left <= right;
        // The nearer one on top.
        if (std::isfinite(std::max(left, right))) open[count++] = node.first + (left_first ? 1 : 0);
        if (std::isfinite(std::min(left, right))) open[count++] = node.first + (left_first ? 0 : 1);
    }
    return any ? nearest : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace palpate::evaluation
