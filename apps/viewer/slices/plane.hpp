// How a slice across a grid axis is shown: by the body's axes in the radiological convention,
// whatever the grid's direction. No Qt.
#pragma once

#include <array>
#include <string>

#include "palpate/volume.hpp"

namespace palpate::viewer {

/// A grid axis that runs along an edge of the screen.
struct ScreenAxis {
    int axis = 0;       ///< of the grid
    bool flip = false;  ///< the sample with the greatest index comes first
};

/// A family of slices across one grid axis. Points on a slice are (u, v): samples from its upper
/// left corner, u to the right, v down; the middle of the first sample is (0, 0).
struct SlicePlane {
    int axis = 2;            ///< of the grid: across
    ScreenAxis right, down;  ///< u and v
    int anatomical = 2;      ///< what `axis` is nearest to: 0 left-right, 1 front-back, 2 up-down
    std::string title;       ///< Sagittal, Coronal or Axial; YZ, XZ or XY of a grid not oriented
    /// What lies towards each edge of the screen: L, R, A, P, S, I (+X, -X, ...), the nearest
    /// first; a second or third letter where the grid lies aslant by more than 15 degrees.
    std::string at_left, at_right, at_top, at_bottom;
};

/// The slices across grid axis `axis` (0, 1, 2): the patient's left on the right, the front above
/// (axial) or on the left (sagittal), the head above (coronal, sagittal). Three axes of a grid get
/// three different titles.
SlicePlane slice_plane(const Geometry& geometry, int axis);

/// Samples along u and v.
std::array<int, 2> samples_of(const SlicePlane& plane, const Geometry& geometry);
/// [mm] between samples along u and v.
std::array<double, 2> spacing_of(const SlicePlane& plane, const Geometry& geometry);

/// (u, v, slice), the slice counted from 0 along the grid axis, from index space and back.
Vec3 slice_from_index(const SlicePlane& plane, const Geometry& geometry, const Vec3& index);
Vec3 index_from_slice(const SlicePlane& plane, const Geometry& geometry, const Vec3& slice);

/// Where a slice lies along its axis, as "S 12.5 mm": millimetres from the physical origin towards
/// the body's side that the letter names.
std::string position_text(const SlicePlane& plane, const Geometry& geometry, const Vec3& physical);

}  // namespace palpate::viewer
