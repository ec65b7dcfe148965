// Turns, pans and zooms a camera.
#include "apps/viewer/scene/navigation.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace palpate::viewer {

ViewAxes axes_of(const Camera& camera) {
    const Vec3 towards = camera.towards_viewer.normalized();
    const Vec3 right = camera.up.cross(towards).normalized();
    return {right, towards.cross(right), towards};
}

double mm_per_pixel(const Camera& camera, const ViewSize& size) {
    return 2 * camera.half_height / std::max(1.0, size.height);
}

Pixel pixel_of(const Camera& camera, const ViewSize& size, const Vec3& physical) {
    const ViewAxes axes = axes_of(camera);
    const Vec3 from = (physical - camera.focus) / mm_per_pixel(camera, size);
    return {0.5 * size.width + axes.right.dot(from), 0.5 * size.height - axes.up.dot(from)};
}

Vec3 in_view_plane(const Camera& camera, const ViewSize& size, double right, double down) {
    const ViewAxes axes = axes_of(camera);
    return mm_per_pixel(camera, size) * (right * axes.right - down * axes.up);
}

Vec3 point_at(const Camera& camera, const ViewSize& size, const Pixel& pixel) {
    return camera.focus +
           in_view_plane(camera, size, pixel.x - 0.5 * size.width, pixel.y - 0.5 * size.height);
}

Vec3 rotation_of_drag(const Camera& camera, const ViewSize& size, double right, double down) {
    const ViewAxes axes = axes_of(camera);
    const double angle = std::numbers::pi / std::max(1.0, std::min(size.width, size.height));
    return angle * (right * axes.up + down * axes.right);
}

Camera turned(const Camera& camera, const ViewSize& size, double right, double down) {
    const double distance = std::hypot(right, down);
    if (distance == 0) return camera;
    const ViewAxes axes = axes_of(camera);
    // The body follows the pointer, so the camera turns the opposite way.
    const Vec3 axis = (down * axes.right + right * axes.up) / distance;
    const double angle =
        distance * std::numbers::pi / std::max(1.0, std::min(size.width, size.height));
    const Eigen::AngleAxisd rotation(-angle, axis);
    Camera moved = camera;
    moved.towards_viewer = (rotation * axes.towards_viewer).normalized();
    moved.up = (rotation * axes.up).normalized();
    return moved;
}

Camera panned(const Camera& camera, const ViewSize& size, double right, double down) {
    Camera moved = camera;
    moved.focus -= in_view_plane(camera, size, right, down);
    return moved;
}

Camera zoomed(const Camera& camera, const ViewSize& size, double factor, const Pixel& about) {
    Camera moved = camera;
    moved.half_height = std::clamp(camera.half_height / factor, 1e-6, 1e9);
    moved.focus += point_at(camera, size, about) - point_at(moved, size, about);
    return moved;
}

Camera whole(const Geometry& geometry, const pictures::View& view, const ViewSize& size) {
    Camera camera{physical_centre(geometry), view.towards_viewer, view.up, 1};
    const ViewAxes axes = axes_of(camera);
    // With some margin, in which the box round the field lies as well, also that of a small grid.
    constexpr double margin = 1.08, box_samples = 2.2;
    const Vec3 samples = 0.5 * (geometry.size.array() - 1).max(1).cast<double>();
    const Vec3 half = geometry.spacing.cwiseProduct(
        (margin * samples).cwiseMax(samples + Vec3::Constant(box_samples)));
    // How far the box reaches along an axis of the picture.
    const auto reach = [&](const Vec3& axis) {
        return (geometry.direction.transpose() * axis).cwiseAbs().dot(half);
    };
    const double aspect = std::max(1.0, size.width) / std::max(1.0, size.height);
    camera.half_height = std::max(reach(axes.up), reach(axes.right) / aspect);
    camera.towards_viewer = axes.towards_viewer;
    camera.up = axes.up;
    return camera;
}

}  // namespace palpate::viewer
