// Camera navigation by mouse, in plain arithmetic. Pixels are the widget's (logical), x to the
// right and y down from its upper left corner, as in Qt.
#pragma once

#include "palpate/volume.hpp"
#include "pictures/scene.hpp"
#include "pictures/view.hpp"

namespace palpate::viewer {

using pictures::Camera;

struct ViewSize {
    double width = 1, height = 1;  ///< [pixels]
};
struct Pixel {
    double x = 0, y = 0;
};

/// Orthonormal axes of the picture, in physical space.
struct ViewAxes {
    Vec3 right, up, towards_viewer;
};
ViewAxes axes_of(const Camera& camera);

/// How many mm a pixel is.
double mm_per_pixel(const Camera& camera, const ViewSize& size);
/// The pixel at which a physical point is seen.
Pixel pixel_of(const Camera& camera, const ViewSize& size, const Vec3& physical);
/// The point seen at a pixel, in the plane through the focus.
Vec3 point_at(const Camera& camera, const ViewSize& size, const Pixel& pixel);
/// A drag on the screen as a displacement in the view plane [mm, physical].
Vec3 in_view_plane(const Camera& camera, const ViewSize& size, double right, double down);

/// A drag on the screen as a rotation vector [radians, physical axes] of a thing whose front side
/// goes with the pointer: half a turn for the smaller side.
Vec3 rotation_of_drag(const Camera& camera, const ViewSize& size, double right, double down);

/// A trackball about the focus: dragged once over the smaller side it turns by 180 degrees.
Camera turned(const Camera& camera, const ViewSize& size, double right, double down);
/// What was under the pointer stays under it.
Camera panned(const Camera& camera, const ViewSize& size, double right, double down);
/// Enlarged by `factor` > 0; what is at `about` stays there. Between 1e-6 and 1e9 mm of half
/// height.
Camera zoomed(const Camera& camera, const ViewSize& size, double factor, const Pixel& about);

/// The camera that shows a whole grid from `view`, with a margin.
Camera whole(const Geometry& geometry, const pictures::View& view, const ViewSize& size);

}  // namespace palpate::viewer
