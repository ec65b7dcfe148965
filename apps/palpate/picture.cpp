// Ray-cast pictures and PNG.
#include "apps/palpate/picture.hpp"

#include <png.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <limits>
#include <thread>

#include "io/output.hpp"

namespace palpate::app {
namespace {

constexpr float nowhere = -std::numeric_limits<float>::infinity();
constexpr double ambient = 0.25;

Colour shade(Colour colour, double light) {
    const auto channel = [&](std::uint8_t c) {
        return static_cast<std::uint8_t>(std::clamp(c * light, 0.0, 255.0));
    };
    return {channel(colour.red), channel(colour.green), channel(colour.blue)};
}

/// Pixel (x, y) to offsets in the picture plane [mm].
struct Plane {
    double mm_per_pixel, left, top;

    Plane(const Picture& p, const Camera& c)
        : mm_per_pixel(2 * c.radius / std::min(p.width, p.height)),
          left(-0.5 * mm_per_pixel * (p.width - 1)),
          top(0.5 * mm_per_pixel * (p.height - 1)) {}
};

void draw_row(Picture& picture, const Camera& camera, const Field& field, double isovalue,
              Colour colour, int y) {
    const Plane plane(picture, camera);
    const Vec3 light = (camera.towards_viewer + 0.5 * camera.up - 0.4 * camera.right).normalized();
    const Geometry& g = field.geometry();
    const double reach = g.size.cast<double>().cwiseProduct(g.spacing).norm() + g.spacing.norm();
    const Vec3 to_front = reach * camera.towards_viewer;  // from before the volume to behind it
    for (int x = 0; x < picture.width; ++x) {
        const Vec3 at = camera.centre + (plane.left + x * plane.mm_per_pixel) * camera.right +
                        (plane.top - y * plane.mm_per_pixel) * camera.up;
        const RayHit ray = cast_ray(field, isovalue, at + to_front, at - to_front);
        if (!ray.hit) continue;
        const auto pixel = static_cast<std::size_t>(y) * static_cast<std::size_t>(picture.width) +
                           static_cast<std::size_t>(x);
        const double facing = std::max(0.0, ray.normal.dot(light));
        picture.pixels[pixel] = shade(colour, ambient + (1.1 - ambient) * facing);
        picture.depth[pixel] =
            static_cast<float>((ray.point - camera.centre).dot(camera.towards_viewer));
    }
}

/// Moves and narrows the camera to what a coarse picture of the surface covers.
void fit(Camera& camera, const Field& field, double isovalue) {
    constexpr int coarse = 64;
    Picture picture(coarse, coarse);
    draw_isosurface(picture, camera, field, isovalue, {});
    const Plane plane(picture, camera);
    Eigen::AlignedBox2d covered;
    for (int i = 0; i < coarse * coarse; ++i) {
        if (picture.depth[static_cast<std::size_t>(i)] == nowhere) continue;
        covered.extend(Eigen::Vector2d(plane.left + (i % coarse) * plane.mm_per_pixel,
                                       plane.top - (i / coarse) * plane.mm_per_pixel));
    }
    if (covered.isEmpty()) return;
    camera.centre += covered.center().x() * camera.right + covered.center().y() * camera.up;
    constexpr double margin = 1.1;
    constexpr double wide = 1.25;  // of a picture, at least
    const Eigen::Vector2d half = 0.5 * covered.sizes();
    camera.radius = margin * std::max({half.x() / wide, half.y(), 2 * plane.mm_per_pixel});
}

}  // namespace

Picture::Picture(int w, int h)
    : width(w),
      height(h),
      pixels(static_cast<std::size_t>(w) * static_cast<std::size_t>(h)),
      depth(pixels.size(), nowhere) {
    for (int y = 0; y < h; ++y) {
        const auto grey = static_cast<std::uint8_t>(250 - 30 * y / h);
        std::fill_n(pixels.begin() + std::ptrdiff_t(y) * w, w, Colour{grey, grey, grey});
    }
}

Camera camera_for(const Field& field, double isovalue, const Vec3& towards) {
    const Geometry& g = field.geometry();
    const Vec3 extent = g.size.cast<double>().cwiseProduct(g.spacing);
    int thin = 0;
    const double least = extent.minCoeff(&thin);
    std::array<double, 3> sorted{extent[0], extent[1], extent[2]};
    std::ranges::sort(sorted);
    Camera camera;
    camera.centre = physical_centre(g);
    camera.radius = 0.5 * extent.norm();
    Vec3 up(0, 0, 1);
    Vec3 view(0.55, -1, 0.45);  // from the front (anterior), the left and above
    if (least < 0.4 * sorted[1]) {
        const Vec3 axis = g.direction.col(thin);
        up = g.direction.col((thin + 2) % 3);
        view = std::copysign(1.0, axis.dot(towards)) * axis +
               0.25 * g.direction.col((thin + 1) % 3) - 0.35 * up;
    } else if (towards.norm() > 0) {
        view = view.normalized() * 0.6 + towards.normalized();
    }
    camera.towards_viewer = view.normalized();
    camera.right = up.cross(camera.towards_viewer).normalized();
    camera.up = camera.towards_viewer.cross(camera.right);
    fit(camera, field, isovalue);
    return camera;
}

void draw_isosurface(Picture& picture, const Camera& camera, const Field& field, double isovalue,
                     Colour colour, const std::function<void(double)>& progress) {
    std::atomic<int> next{0};
    std::atomic<int> done{0};
    std::atomic<bool> stop{false};
    const auto work = [&] {
        for (int y = next++; y < picture.height && !stop; y = next++) {
            draw_row(picture, camera, field, isovalue, colour, y);
            ++done;
        }
    };
    std::vector<std::jthread> threads;
    const unsigned count = std::max(1U, std::thread::hardware_concurrency());
    for (unsigned i = 0; i < count; ++i) threads.emplace_back(work);
    try {
        while (done < picture.height) {
            std::this_thread::sleep_for(std::chrono::milliseconds(20));
            if (progress) progress(static_cast<double>(done) / picture.height);
        }
    } catch (...) {
        stop = true;
        throw;
    }
}

void draw_line(Picture& picture, const Camera& camera, std::span<const Vec3> points, Colour colour,
               double bias, int width) {
    const Plane plane(picture, camera);
    const auto dot = [&](const Vec3& point) {
        const Vec3 at = point - camera.centre;
        const double px = (at.dot(camera.right) - plane.left) / plane.mm_per_pixel;
        const double py = (plane.top - at.dot(camera.up)) / plane.mm_per_pixel;
        const double z = at.dot(camera.towards_viewer) + bias;
        const int x0 = static_cast<int>(std::lround(px - 0.5 * (width - 1)));
        const int y0 = static_cast<int>(std::lround(py - 0.5 * (width - 1)));
        for (int y = std::max(0, y0); y < std::min(picture.height, y0 + width); ++y) {
            for (int x = std::max(0, x0); x < std::min(picture.width, x0 + width); ++x) {
                const auto pixel = static_cast<std::size_t>(y) * std::size_t(picture.width) +
                                   static_cast<std::size_t>(x);
                if (z < picture.depth[pixel]) continue;
                picture.pixels[pixel] = colour;
            }
        }
    };
    for (std::size_t i = 1; i < points.size(); ++i) {
        const Vec3 way = points[i] - points[i - 1];
        const int dots = 1 + static_cast<int>(2 * way.norm() / plane.mm_per_pixel);
        for (int j = 0; j <= dots; ++j) dot(points[i - 1] + way * (double(j) / dots));
    }
}

void write_png(const Picture& picture, const std::filesystem::path& path) {
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    image.width = static_cast<png_uint_32>(picture.width);
    image.height = static_cast<png_uint_32>(picture.height);
    image.format = PNG_FORMAT_RGB;
    png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(image);
    std::string bytes(size, '\0');
    if (!png_image_write_to_memory(&image, bytes.data(), &size, 0, picture.pixels.data(), 0,
                                   nullptr)) {
        throw io::OutputError(path.string() +
                              ": the picture could not be packed: " + image.message);
    }
    io::PendingFile file(path);
    file.write(std::string_view(bytes).substr(0, size));
    file.commit();
}

}  // namespace palpate::app
