// The view of a picture: where the camera is. Directions are the body's (LPS): the front is
// anterior (-y), its left is +x, its top superior (+z).
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "palpate/field.hpp"
#include "pictures/scene.hpp"

namespace palpate::pictures {

/// Two directions of a camera.
struct View {
    Vec3 towards_viewer = Vec3(0, -1, 0);
    Vec3 up = Vec3(0, 0, 1);
};

/// front, back, left, right, top, bottom, oblique. The sides are the body's: `left` looks at its
/// left side; `top` and `bottom` have its front above.
std::vector<std::string> view_names();
/// Throws std::invalid_argument, listing the names, for any other.
View view_named(std::string_view name);
/// `azimuth` [degrees]: 0 is the front, 90 the body's left side; `elevation` from -90 (below) to 90
/// (above). Throws std::invalid_argument for what is not finite or beyond.
View view_from(double azimuth, double elevation);
/// Turned clockwise by `degrees`.
View rolled(const View& view, double degrees);
/// The side that shows most: a slab on its broad side, aslant; anything else as `oblique`; turned
/// towards `towards` [physical, from the centre; zero: nowhere], so that what lies there is seen.
View natural_view(const Geometry& geometry, const Vec3& towards);

/// Directs the camera so that all surfaces, or where there are none all else, fill the picture.
/// `zoom` enlarges; with `at`, about that point: the larger, the nearer it comes to the middle.
void frame(PictureScene& scene, const View& view, double zoom = 1,
           const std::optional<Vec3>& at = {});

}  // namespace palpate::pictures
