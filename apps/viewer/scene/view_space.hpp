// The space in which render threads and the widget draw, so that their depths compare: physical
// axes, millimetres, from the middle of the grid.
#pragma once

#include <vtkCamera.h>

#include <algorithm>

#include "palpate/volume.hpp"
#include "pictures/scene.hpp"

namespace palpate::viewer {

/// Radius about the middle of the grid [mm] outside of which nothing is drawn.
inline double reach_of(const Geometry& geometry) {
    const Vec3 extent = geometry.size.cast<double>().cwiseProduct(geometry.spacing);
    // Twice the grid's own: a probe beside it is seen, too.
    return std::max(1e-6, extent.norm());
}

/// Directs VTK's camera. `origin` is the middle of the grid [mm, physical].
inline void direct(vtkCamera& camera, const pictures::Camera& wanted, const Vec3& origin,
                   double reach) {
    const Vec3 towards = wanted.towards_viewer.normalized();
    const Vec3 focus = wanted.focus - origin;
    // The clipping planes are the same for all that is seen along one direction, whatever the
    // focus: depths do not change when a camera is panned.
    const Vec3 foot = focus - towards.dot(focus) * towards;
    camera.ParallelProjectionOn();
    camera.SetFocalPoint(Vec3(foot).data());
    camera.SetPosition(Vec3(foot + 1.05 * reach * towards).data());
    camera.SetViewUp(Vec3(wanted.up).data());
    camera.SetParallelScale(wanted.half_height);
    camera.SetClippingRange(0.05 * reach, 2.05 * reach);
}

/// The distance from `origin` towards the viewer [mm] of a point with this depth (0 near, 1 far).
inline double height_of(double depth, double reach) {
    return (1 - 2 * depth) * reach;
}

}  // namespace palpate::viewer
