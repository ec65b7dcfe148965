// Pictures without a display: the isosurface as the proxy meets it, seen by casting rays through
// the same lattice, with lines drawn into it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <vector>

#include "palpate/proxy.hpp"

namespace palpate::app {

struct Colour {
    std::uint8_t red = 0, green = 0, blue = 0;
};

/// Parallel projection on the volume's bounding sphere.
struct Camera {
    Vec3 centre;          ///< [mm, physical] middle of the picture
    Vec3 towards_viewer;  ///< unit
    Vec3 right, up;       ///< unit, in the picture
    double radius;        ///< [mm] half of the picture's shorter side
};
/// Looks at the isosurface from the side that `towards` [physical] points to, slantwise; a slab is
/// seen on its broad side. The surface fills the picture.
Camera camera_for(const Field& field, double isovalue, const Vec3& towards);

struct Picture {
    int width = 0, height = 0;
    std::vector<Colour> pixels;  ///< row by row from the top
    std::vector<float> depth;    ///< [mm] towards the viewer; -infinity: background

    Picture(int w, int h);
};

/// Casts a ray a pixel, on all processors; the same picture however many there are. `progress` is
/// called from the calling thread and may throw to stop.
void draw_isosurface(Picture& picture, const Camera& camera, const Field& field, double isovalue,
                     Colour colour, const std::function<void(double)>& progress = {});

/// A line through physical points [mm], hidden where it lies behind the surface by more than
/// `bias` [mm]; `width` in pixels.
void draw_line(Picture& picture, const Camera& camera, std::span<const Vec3> points, Colour colour,
               double bias, int width = 2);

/// Throws io::OutputError.
void write_png(const Picture& picture, const std::filesystem::path& path);

}  // namespace palpate::app
