// Tools: their points and built-in shapes.
#include "palpate/tool.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace palpate {
namespace {

void require_length(double length) {
    if (!(length > 0 && length < 1e9)) {
        throw std::invalid_argument("a tool's lengths and the spacing of its points must be > 0");
    }
}

void check_number(double points) {
    if (points <= double(most_tool_points)) return;
    throw std::invalid_argument("a tool has at most 20000 points: space them farther apart");
}

/// How many equal steps of at most `spacing` a length has.
int steps_along(double length, double spacing) {
    require_length(length);
    require_length(spacing);
    const double steps = std::ceil(length / spacing - 1e-9);
    check_number(steps);
    return std::max(1, static_cast<int>(steps));
}

/// A profile turned round z: (distance from the axis, z) from one end to the other.
std::vector<Vec3> turned_profile(const std::vector<Eigen::Vector2d>& profile, double spacing) {
    std::vector<Vec3> points;
    const auto ring = [&](const Eigen::Vector2d& at) {
        const double around = 2 * std::numbers::pi * at[0];
        const int count = around > spacing ? steps_along(around, spacing) : 1;
        check_number(double(points.size()) + count);
        for (int i = 0; i < count; ++i) {
            const double angle = 2 * std::numbers::pi * i / count;
            const double r = count == 1 ? 0 : at[0];
            points.emplace_back(r * std::cos(angle), r * std::sin(angle), at[1]);
        }
    };
    ring(profile.front());
    for (std::size_t i = 1; i < profile.size(); ++i) {
        const Eigen::Vector2d way = profile[i] - profile[i - 1];
        const double length = std::sqrt(way[0] * way[0] + way[1] * way[1]);
        if (length == 0) continue;
        const int steps = steps_along(length, spacing);
        for (int k = 1; k <= steps; ++k) ring(profile[i - 1] + way * (double(k) / steps));
    }
    return points;
}

/// Appends an arc round (0, z) between two angles from the -z axis, in pieces that are short beside
/// the spacing.
void add_arc(std::vector<Eigen::Vector2d>& profile, double radius, double z, double from, double to,
             double spacing) {
    const int steps = steps_along(radius * std::abs(to - from), spacing);
    for (int i = 0; i <= steps; ++i) {
        const double angle = from + (to - from) * i / steps;
        profile.emplace_back(radius * std::sin(angle), z - radius * std::cos(angle));
    }
}

/// A profile turned round z, with a disc at each end: closed.
ToolShape turned_shape(const std::vector<Eigen::Vector2d>& profile) {
    constexpr std::uint32_t around = 32;
    ToolShape shape;
    for (const Eigen::Vector2d& at : profile) {
        for (std::uint32_t i = 0; i < around; ++i) {
            const double angle = 2 * std::numbers::pi * i / around;
            shape.vertices.emplace_back(at[0] * std::cos(angle), at[0] * std::sin(angle), at[1]);
        }
    }
    for (std::uint32_t ring = 0; ring + 1 < profile.size(); ++ring) {
        for (std::uint32_t i = 0; i < around; ++i) {
            const std::uint32_t a = ring * around + i, b = ring * around + (i + 1) % around;
            shape.triangles.push_back({a, b, a + around});
            shape.triangles.push_back({b, b + around, a + around});
        }
    }
    const auto close = [&](std::size_t ring) {
        if (profile[ring][0] == 0) return;  // a point already
        const auto middle = static_cast<std::uint32_t>(shape.vertices.size());
        const auto first = static_cast<std::uint32_t>(ring) * around;
        shape.vertices.emplace_back(0, 0, profile[ring][1]);
        for (std::uint32_t i = 0; i < around; ++i) {
            const std::uint32_t a = first + i, b = first + (i + 1) % around;
            shape.triangles.push_back(ring == 0 ? std::array<std::uint32_t, 3>{middle, b, a}
                                                : std::array<std::uint32_t, 3>{middle, a, b});
        }
    };
    close(0);
    close(profile.size() - 1);
    return shape;
}

constexpr double right_angle = std::numbers::pi / 2;
/// Step of arcs for pictures, in radii.
constexpr double fine = 0.1;

/// An arc round (0, z) from the -z axis to an angle, and on to the end of a shaft, turned round z.
/// Its depth along y is `depth` times as large.
Tool turned_tool(double radius, double z, double angle, const Eigen::Vector2d& end, double spacing,
                 double depth = 1) {
    const auto profile = [&](double step) {
        std::vector<Eigen::Vector2d> line;
        add_arc(line, radius, z, 0, angle, step);
        line.push_back(end);
        return line;
    };
    std::vector<Vec3> points = turned_profile(profile(spacing), spacing);
    ToolShape shape = turned_shape(profile(fine * radius));
    for (Vec3& point : points) point[1] *= depth;
    for (Vec3& vertex : shape.vertices) vertex[1] *= depth;
    return Tool(std::move(points), std::nullopt, true, std::move(shape));
}

/// Limits of a tool's points [mm]: no volume is larger, and below the other, turning moves nothing.
constexpr double longest_arm = 1e6, shortest_arm = 1e-6;

void check_shape(const ToolShape& shape) {
    for (const Vec3& vertex : shape.vertices) {
        if (vertex.norm() <= longest_arm) continue;
        throw std::invalid_argument("a tool's shape must lie within 1e6 mm of its origin");
    }
    for (const auto& triangle : shape.triangles) {
        for (const std::uint32_t i : triangle) {
            if (i < shape.vertices.size()) continue;
            throw std::invalid_argument("a triangle names a vertex that the tool's shape has not");
        }
    }
}

}  // namespace

Tool::Tool(std::vector<Vec3> points, std::optional<double> gyration, bool turns, ToolShape shape)
    : points_(std::move(points)), shape_(std::move(shape)) {
    if (points_.empty()) throw std::invalid_argument("a tool needs at least one point");
    check_number(double(points_.size()));
    double sum = 0;
    for (const Vec3& point : points_) {
        const double arm = point.norm();
        if (!(arm <= longest_arm)) {
            throw std::invalid_argument("a tool's points must lie within 1e6 mm of its origin");
        }
        sum += arm * arm;
        radius_ = std::max(radius_, arm);
    }
    const bool has_extent = radius_ >= shortest_arm;
    turns_ = turns && has_extent;
    gyration_ = gyration.value_or(has_extent ? std::sqrt(sum / double(points_.size())) : 1);
    if (!(gyration_ >= shortest_arm && gyration_ <= longest_arm)) {
        throw std::invalid_argument("a tool's radius of gyration must be from 1e-6 to 1e6 mm");
    }
    check_shape(shape_);
}

Tool point_tool() {
    return Tool({Vec3::Zero()});
}

Tool sphere_tool(double radius, double spacing) {
    require_length(radius);
    require_length(spacing);
    // Points of a spiral, each with the area of a hexagon.
    const double area = 4 * std::numbers::pi * radius * radius;
    const double count = std::ceil(area / (0.5 * std::sqrt(3.0) * spacing * spacing));
    check_number(count);
    const double golden_angle = std::numbers::pi * (3 - std::sqrt(5.0));
    std::vector<Vec3> points;
    const int n = std::max(4, static_cast<int>(count));
    for (int i = 0; i < n; ++i) {
        const double z = 1 - (2 * i + 1) / double(n);
        const double across = std::sqrt(1 - z * z), angle = golden_angle * i;
        points.emplace_back(radius * across * std::cos(angle), radius * across * std::sin(angle),
                            radius * z);
    }
    std::vector<Eigen::Vector2d> profile;
    add_arc(profile, radius, 0, 0, 2 * right_angle, fine * radius);
    return Tool(std::move(points), std::nullopt, false, turned_shape(profile));
}

Tool rod_tool(double length, double spacing) {
    const int steps = steps_along(length, spacing);
    std::vector<Vec3> points;
    for (int i = 0; i <= steps; ++i) points.emplace_back(0, 0, length * i / steps);
    return Tool(std::move(points));
}

Tool box_tool(const Vec3& size, double spacing) {
    const std::array<int, 3> steps{steps_along(size[0], spacing), steps_along(size[1], spacing),
                                   steps_along(size[2], spacing)};
    std::vector<Vec3> points;
    const double count =
        2.0 * (double(steps[0] + 1) * (steps[1] + 1) + double(steps[1] + 1) * (steps[2] + 1) +
               double(steps[2] + 1) * (steps[0] + 1));
    check_number(count);
    for (int z = 0; z <= steps[2]; ++z) {
        for (int y = 0; y <= steps[1]; ++y) {
            const bool inside = z > 0 && z < steps[2] && y > 0 && y < steps[1];
            for (int x = 0; x <= steps[0]; x += inside ? steps[0] : 1) {
                const Vec3 share(double(x) / steps[0], double(y) / steps[1], double(z) / steps[2]);
                points.push_back((share - Vec3::Constant(0.5)).cwiseProduct(size));
            }
        }
    }
    ToolShape shape;
    for (int i = 0; i < 8; ++i) {
        const Vec3 corner(i & 1, i >> 1 & 1, i >> 2);
        shape.vertices.push_back((corner - Vec3::Constant(0.5)).cwiseProduct(size));
    }
    shape.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                       {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    return Tool(std::move(points), std::nullopt, true, std::move(shape));
}

Tool needle_tool(double length, double radius, double spacing) {
    require_length(radius);
    require_length(spacing);
    if (!(length > radius)) throw std::invalid_argument("a needle must be longer than thick");
    return turned_tool(radius, radius, right_angle, {radius, length}, spacing);
}

Tool burr_tool(double radius, double spacing) {
    require_length(radius);
    require_length(spacing);
    constexpr double thin = 0.4;
    return turned_tool(radius, 0, std::numbers::pi - std::asin(thin), {thin * radius, 4 * radius},
                       spacing);
}

Tool fingertip_tool(double spacing, double scale) {
    require_length(spacing);
    require_length(scale);
    const double half_width = 8 * scale, half_depth = 6 * scale, length = 12 * scale;
    return turned_tool(half_width, 0, right_angle, {half_width, length}, spacing,
                       half_depth / half_width);
}

Vec3 rotation_between(const Quaternion& from, const Quaternion& to) {
    Quaternion q = to * from.conjugate();
    if (q.w() < 0) q.coeffs() = -q.coeffs();
    const double sine = q.vec().norm();
    if (sine < 1e-8) return 2 * q.vec();  // to all digits
    return q.vec() * (2 * std::atan2(sine, q.w()) / sine);
}

Quaternion turned(const Quaternion& from, const Vec3& rotation) {
    const double angle = rotation.norm();
    const double share = angle < 1e-8 ? 0.5 : std::sin(0.5 * angle) / angle;
    const Vec3 v = rotation * share;
    return (Quaternion(std::cos(0.5 * angle), v[0], v[1], v[2]) * from).normalized();
}

bool is_rotation(const Mat3& m, double tolerance) noexcept {
    const auto difference = [&] { return Mat3(m.transpose() * m - Mat3::Identity()); };
    return m.allFinite() && difference().cwiseAbs().maxCoeff() < tolerance && m.determinant() > 0;
}

}  // namespace palpate
