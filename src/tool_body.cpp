// Computes a tool's distances: unsigned ones to points or triangles, and on which side of a closed
// shape each place lies by counting what a line through it crosses.
#include "palpate/tool.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "mesh_tool/joined.hpp"

namespace palpate {
namespace {

constexpr std::size_t most_triangles = 20'000;
constexpr double most_places = 4'000'000;
constexpr double shortest = 1e-6, longest = 1e6;  // [mm]

bool is_closed(std::span<const MeshTriangle> triangles) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
    for (const MeshTriangle& t : triangles) {
        for (std::size_t i = 0; i < 3; ++i) ++edges[std::minmax(t[i], t[(i + 1) % 3])];
    }
    return std::ranges::all_of(edges, [](const auto& edge) { return edge.second % 2 == 0; });
}

double distance_to_edge(const Vec3& p, const Vec3& a, const Vec3& b) {
    const Vec3 way = b - a;
    const double squared = way.squaredNorm();
    const double along = squared > 0 ? std::clamp((p - a).dot(way) / squared, 0.0, 1.0) : 0;
    return (p - a - along * way).norm();
}

/// A triangle with what its distance from points needs.
class Facet {
  public:
    Facet(const Vec3& a, const Vec3& b, const Vec3& c)
        : corners_{a, b, c}, middle_((a + b + c) / 3) {
        for (const Vec3& corner : corners_)
            radius_ = std::max(radius_, slack * (corner - middle_).norm());
        const Vec3 across = (b - a).cross(c - a);
        const double twice = across.norm();
        flat_ = !(twice > 0);
        if (flat_) return;
        normal_ = across / twice;
        for (std::size_t i = 0; i < 3; ++i) {
            inwards_[i] = normal_.cross(corners_[(i + 1) % 3] - corners_[i]);
        }
    }
    /// Whether no point of it is nearer to p than that, by the ball around it; false may be wrong.
    bool is_beyond(const Vec3& p, double distance) const {
        const double apart = distance + radius_;
        return (p - middle_).squaredNorm() > apart * apart;
    }
    double distance(const Vec3& p) const {
        bool above = !flat_;
        for (std::size_t i = 0; above && i < 3; ++i)
            above = (p - corners_[i]).dot(inwards_[i]) >= 0;
        if (above) return std::abs((p - corners_[0]).dot(normal_));
        return std::min({distance_to_edge(p, corners_[0], corners_[1]),
                         distance_to_edge(p, corners_[1], corners_[2]),
                         distance_to_edge(p, corners_[2], corners_[0])});
    }
    Vec3 low() const { return corners_[0].cwiseMin(corners_[1]).cwiseMin(corners_[2]); }
    Vec3 high() const { return corners_[0].cwiseMax(corners_[1]).cwiseMax(corners_[2]); }
    const std::array<Vec3, 3>& corners() const { return corners_; }

    /// The height at which a line along z crosses it; false where it does not. An edge that two
    /// triangles share counts for exactly one of them, so a line enters as often as it leaves.
    bool crosses(double x, double y, double& z) const {
        bool inside = false;
        for (std::size_t i = 0; i < 3; ++i)
            inside ^= passes(corners_[i], corners_[(i + 1) % 3], x, y);
        if (!inside) return false;
        const double low = this->low()[2], high = this->high()[2];
        z = std::abs(normal_[2]) > 0 ? corners_[0][2] - ((x - corners_[0][0]) * normal_[0] +
                                                         (y - corners_[0][1]) * normal_[1]) /
                                                            normal_[2]
                                     : low;
        z = std::clamp(z, low, high);
        return true;
    }

  private:
    /// Whether an edge passes beside a point of the plane, on the side of greater x. The same bits
    /// from both triangles.
    static bool passes(Vec3 a, Vec3 b, double x, double y) {
        if ((a[1] > y) == (b[1] > y)) return false;
        if (a[1] > b[1]) std::swap(a, b);
        return x < a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0]);
    }

    static constexpr double slack = 1 + 1e-6;  // more than distances of floats are off by

    std::array<Vec3, 3> corners_;
    Vec3 middle_;
    double radius_ = 0;
    Vec3 normal_ = Vec3::Zero();
    std::array<Vec3, 3> inwards_{};
    bool flat_ = false;
};

/// Places on a grid in tool axes.
struct Places {
    Vec3 first;
    double step;
    Index3 size;

    Vec3 at(const Index3& i) const { return first + step * i.cast<double>(); }
    std::size_t number(const Index3& i) const {
        return (static_cast<std::size_t>(i[2]) * size[1] + i[1]) * size[0] + i[0];
    }
    Index3 above(const Vec3& p) const {
        return ((p - first) / step).array().ceil().cast<int>().max(0);
    }
    Index3 below(const Vec3& p) const {
        return ((p - first) / step).array().floor().cast<int>().min(size.array() - 1);
    }
    template <class Visit>
    void visit(const Vec3& low, const Vec3& high, Visit&& visit) const {
        for_each_index({above(low), below(high)}, visit);
    }
};

/// Changes the sign of all distances inside.
void turn_inside(const Places& places, std::span<const Facet> facets,
                 std::vector<float>& distances) {
    std::vector<bool> turns(distances.size());
    for (const Facet& facet : facets) {
        // One layer of places: the lines that may cross it, and one more on each side. A line along
        // an edge could be lost by rounding for one of its two triangles.
        Vec3 low = facet.low() - Vec3::Constant(places.step);
        Vec3 high = facet.high() + Vec3::Constant(places.step);
        low[2] = high[2] = places.first[2];
        places.visit(low, high, [&](const Index3& foot) {
            const Vec3 line = places.at(foot);
            double z = 0;
            if (!facet.crosses(line[0], line[1], z)) return;
            const int k = places.above({line[0], line[1], z})[2];
            if (k >= places.size[2]) return;
            const std::size_t n = places.number({foot[0], foot[1], k});
            turns[n] = !turns[n];
        });
    }
    for (int j = 0; j < places.size[1]; ++j) {
        for (int i = 0; i < places.size[0]; ++i) {
            bool inside = false;
            for (int k = 0; k < places.size[2]; ++k) {
                const std::size_t n = places.number({i, j, k});
                inside ^= turns[n];
                if (inside) distances[n] = -distances[n];
            }
        }
    }
}

/// The facets of the tool's shape; none where it is not closed.
std::vector<Facet> facets_of(const ToolShape& shape) {
    if (shape.triangles.size() > most_triangles) {
        throw std::invalid_argument(
            "the tool's mesh has more than 20000 triangles: simplify it to edit with its shape");
    }
    if (shape.triangles.empty()) return {};
    const std::vector<MeshTriangle> triangles = joined(shape.vertices, shape.triangles);
    if (!is_closed(triangles)) return {};
    std::vector<Facet> facets;
    facets.reserve(triangles.size());
    for (const MeshTriangle& t : triangles) {
        facets.emplace_back(shape.vertices[t[0]], shape.vertices[t[1]], shape.vertices[t[2]]);
    }
    return facets;
}

/// Distances from facets, below 0 inside, or where there are none from points.
std::vector<float> distances_from(std::span<const Facet> facets, std::span<const Vec3> points,
                                  const Places& places, double reach) {
    std::vector<float> distances(static_cast<std::size_t>(places.size.cast<double>().prod()),
                                 static_cast<float>(reach));
    const Vec3 all = Vec3::Constant(reach);
    // Facets from all over the shape come first, so that most places soon know that others are
    // beyond.
    std::size_t stride = facets.size() * 5 / 8 + 1;
    while (std::gcd(stride, facets.size()) > 1) ++stride;
    for (std::size_t n = 0; n < facets.size(); ++n) {
        const Facet& facet = facets[n * stride % facets.size()];
        places.visit(facet.low() - all, facet.high() + all, [&](const Index3& i) {
            float& least = distances[places.number(i)];
            const Vec3 p = places.at(i);
            if (!facet.is_beyond(p, least))
                least = std::min(least, static_cast<float>(facet.distance(p)));
        });
    }
    if (!facets.empty()) {
        turn_inside(places, facets, distances);
        return distances;
    }
    for (const Vec3& point : points) {
        places.visit(point - all, point + all, [&](const Index3& i) {
            float& least = distances[places.number(i)];
            least = std::min(least, static_cast<float>((places.at(i) - point).norm()));
        });
    }
    return distances;
}

}  // namespace

ToolBody::ToolBody(std::shared_ptr<const Tool> tool, double step, double reach)
    : tool_(std::move(tool)), asked_step_(step), reach_(reach), step_(step) {
    const auto fits = [](double length) { return length >= shortest && length <= longest; };
    if (!fits(step) || !fits(reach) || !(reach / step <= 500'000)) {
        throw std::invalid_argument(
            "a tool's body needs a step and a reach from 1e-6 to 1e6 mm, at most 500000 steps");
    }
    const std::vector<Facet> facets = facets_of(tool_->shape());
    closed_ = !facets.empty();
    low_ = closed_ ? facets.front().low() : tool_->points().front();
    high_ = low_;
    const auto hold = [&](const Vec3& low, const Vec3& high) {
        low_ = low_.cwiseMin(low);
        high_ = high_.cwiseMax(high);
    };
    for (const Facet& facet : facets) hold(facet.low(), facet.high());
    for (const Vec3& point : tool_->points()) {
        if (!closed_) hold(point, point);
    }
    // Places beyond the reach, too, so that distances up to it are between known ones.
    const auto held = [&] { return reach + 2 * step_; };
    const auto steps = [&] {
        const Vec3 extent = high_ - low_ + Vec3::Constant(2 * held());
        return Vec3((extent / step_).array().ceil() + 2);
    };
    while (steps().prod() > most_places) step_ *= 1.1;
    size_ = steps().cast<int>();
    first_ = 0.5 * (low_ + high_ - step_ * (size_ - Index3::Ones()).cast<double>());
    distances_ = distances_from(facets, tool_->points(), {first_, step_, size_}, held());
}

double ToolBody::distance(const Vec3& point) const {
    const Vec3 at = (point - first_) / step_;
    const Vec3 last = (size_ - Index3::Ones()).cast<double>();
    const Vec3 held = at.cwiseMax(0).cwiseMin(last);
    const double outside = step_ * (at - held).norm();
    if (outside > 0) return reach_ + outside;
    const Index3 i = held.cast<int>().cwiseMin(size_ - Index3::Constant(2));
    const Vec3 w = held - i.cast<double>();
    const std::ptrdiff_t row = size_[0], layer = row * size_[1];
    const float* d = &distances_[static_cast<std::size_t>(i[2] * layer + i[1] * row + i[0])];
    const auto along = [&](std::ptrdiff_t n) { return d[n] + w[0] * (double(d[n + 1]) - d[n]); };
    const double y0 = along(0) + w[1] * (along(row) - along(0));
    const double y1 = along(layer) + w[1] * (along(layer + row) - along(layer));
    return y0 + w[2] * (y1 - y0);
}

}  // namespace palpate
