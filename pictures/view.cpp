// Camera views, and framing a scene in them.
#include "pictures/view.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "palpate/names.hpp"

namespace palpate::pictures {
namespace {

struct NamedView {
    const char* name;
    View view;
};

const std::array<NamedView, 7>& named_views() {
    static const std::array<NamedView, 7> views{{
        {"front", {Vec3(0, -1, 0), Vec3(0, 0, 1)}},
        {"back", {Vec3(0, 1, 0), Vec3(0, 0, 1)}},
        {"left", {Vec3(1, 0, 0), Vec3(0, 0, 1)}},
        {"right", {Vec3(-1, 0, 0), Vec3(0, 0, 1)}},
        {"top", {Vec3(0, 0, 1), Vec3(0, -1, 0)}},
        {"bottom", {Vec3(0, 0, -1), Vec3(0, -1, 0)}},
        {"oblique", {Vec3(0.55, -1, 0.4), Vec3(0, 0, 1)}},
    }};
    return views;
}

/// Points of the scene's objects other than the surfaces.
std::vector<Vec3> points_of(const PictureScene& scene) {
    std::vector<Vec3> points;
    for (const Ball& b : scene.balls) points.push_back(b.centre);
    for (const Line& l : scene.lines) {
        points.insert(points.end(), l.points.begin(), l.points.end());
    }
    for (const Spring& s : scene.springs) points.insert(points.end(), {s.from, s.to});
    for (const Arrow& a : scene.arrows) points.insert(points.end(), {a.from, a.to});
    return points;
}

}  // namespace

std::vector<std::string> view_names() {
    std::vector<std::string> names;
    for (const NamedView& v : named_views()) names.emplace_back(v.name);
    return names;
}

View view_named(std::string_view name) {
    for (const NamedView& v : named_views()) {
        if (name == v.name) return v.view;
    }
    throw std::invalid_argument("there is no view '" + std::string(name) +
                                "': " + use_one_of(view_names(), name));
}

View view_from(double azimuth, double elevation) {
    if (!std::isfinite(azimuth) || !(std::abs(elevation) <= 90)) {
        throw std::invalid_argument("an azimuth is a number, an elevation from -90 to 90 degrees");
    }
    const double a = azimuth * std::numbers::pi / 180, e = elevation * std::numbers::pi / 180;
    const Vec3 level(std::sin(a), -std::cos(a), 0);
    const Vec3 above(0, 0, 1);
    return {std::cos(e) * level + std::sin(e) * above, std::cos(e) * above - std::sin(e) * level};
}

View rolled(const View& view, double degrees) {
    const Vec3 axis = view.towards_viewer.normalized();
    return {axis, Eigen::AngleAxisd(degrees * std::numbers::pi / 180, axis) * view.up};
}

View natural_view(const Geometry& geometry, const Vec3& towards) {
    const Vec3 extent = geometry.size.cast<double>().cwiseProduct(geometry.spacing);
    int thin = 0;
    const double least = extent.minCoeff(&thin);
    std::array<double, 3> sorted{extent[0], extent[1], extent[2]};
    std::ranges::sort(sorted);
    if (least < 0.4 * sorted[1]) {
        const Vec3 axis = geometry.direction.col(thin);
        const Vec3 up = geometry.direction.col((thin + 2) % 3);
        return {std::copysign(1.0, axis.dot(towards)) * axis +
                    0.25 * geometry.direction.col((thin + 1) % 3) - 0.35 * up,
                up};
    }
    View view = view_named("oblique");
    if (towards.norm() > 0) {
        view.towards_viewer = 0.6 * view.towards_viewer.normalized() + towards.normalized();
        if (view.towards_viewer.norm() < 0.5) view.towards_viewer = towards.normalized();
        // Straight from above or below there is no up.
        Vec3& v = view.towards_viewer;
        if (v.head<2>().norm() < 0.1 * std::abs(v[2])) v[1] = -0.1 * std::abs(v[2]);
    }
    return view;
}

void frame(PictureScene& scene, const View& view, double zoom, const std::optional<Vec3>& at) {
    const Vec3 forward = view.towards_viewer.normalized();
    const Vec3 right = view.up.cross(forward).normalized();
    const Vec3 up = forward.cross(right);
    Eigen::AlignedBox3d box;
    const auto extend = [&](const Vec3& p) {
        box.extend(Vec3(right.dot(p), up.dot(p), forward.dot(p)));
    };
    for (const Surface& s : scene.surfaces) std::ranges::for_each(s.mesh.vertices, extend);
    if (box.isEmpty()) std::ranges::for_each(points_of(scene), extend);
    if (box.isEmpty()) extend(Vec3::Zero());
    constexpr double margin = 1.12;
    const Vec3 half = 0.5 * box.sizes();
    const double aspect = double(scene.width) / scene.height;
    Camera& camera = scene.camera;
    camera.towards_viewer = forward;
    camera.up = up;
    camera.half_height = margin * std::max(half.x() / aspect, half.y());
    if (!(camera.half_height > 0)) camera.half_height = 1;
    camera.half_height /= zoom;
    const Vec3 middle = box.center();
    camera.focus = middle.x() * right + middle.y() * up + middle.z() * forward;
    if (at && zoom > 1) camera.focus += (1 - 1 / zoom) * (*at - camera.focus);
}

}  // namespace palpate::pictures
