// How a slice across a grid axis is shown: by the body's axes in the radiological convention,
// whatever the grid's direction. Also where it lies in a widget.
#pragma once

#include <QPointF>
#include <QSizeF>

#include <algorithm>
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

std::array<int, 2> samples_of(const SlicePlane& plane, const Geometry& geometry);
/// [mm] between samples along u and v.
std::array<double, 2> spacing_of(const SlicePlane& plane, const Geometry& geometry);

/// (u, v, slice), the slice counted from 0 along the grid axis, from index space and back.
Vec3 slice_from_index(const SlicePlane& plane, const Geometry& geometry, const Vec3& index);
Vec3 index_from_slice(const SlicePlane& plane, const Geometry& geometry, const Vec3& slice);

/// Where a slice lies along its axis, as "S 12.5 mm": millimetres from the physical origin towards
/// the body's side that the letter names.
std::string position_text(const SlicePlane& plane, const Geometry& geometry, const Vec3& physical);

/// The part of a slice that is shown.
struct SliceView {
    double zoom = 1;  ///< 1: the whole slice fits
    QPointF moved{0,
                  0};  ///< [mm] how far the slice's middle lies from the widget's, right and down
};

/// (u, v) to pixels of the widget; a millimetre is as many pixels along both.
struct SliceMap {
    QPointF first;                ///< [pixels] middle of sample (0, 0)
    double per_u = 1, per_v = 1;  ///< [pixels] between samples
    double per_mm = 1;            ///< [pixels]

    QPointF pixel(double u, double v) const {
        return {first.x() + u * per_u, first.y() + v * per_v};
    }
    QPointF sample(const QPointF& pixel) const {
        return {(pixel.x() - first.x()) / per_u, (pixel.y() - first.y()) / per_v};
    }
};

/// The slice in a widget of `size`, with `margin` pixels left free round it at zoom 1.
inline SliceMap slice_map(const SlicePlane& plane, const Geometry& geometry, const SliceView& view,
                          const QSizeF& size, double margin) {
    const auto [nu, nv] = samples_of(plane, geometry);
    const auto [mm_u, mm_v] = spacing_of(plane, geometry);
    const double fit = std::min(std::max(size.width() - 2 * margin, 8.0) / (nu * mm_u),
                                std::max(size.height() - 2 * margin, 8.0) / (nv * mm_v));
    SliceMap map;
    map.per_mm = fit * view.zoom;
    map.per_u = map.per_mm * mm_u;
    map.per_v = map.per_mm * mm_v;
    map.first =
        QPointF(0.5 * size.width() + map.per_mm * view.moved.x() - 0.5 * (nu - 1) * map.per_u,
                0.5 * size.height() + map.per_mm * view.moved.y() - 0.5 * (nv - 1) * map.per_v);
    return map;
}

/// The map of another grid with the same directions, drawn in the same place.
inline SliceMap map_of(const Geometry& other, const SlicePlane& plane, const Geometry& geometry,
                       const SliceMap& map) {
    if (other == geometry) return map;
    const Vec3 first = physical_from_index(other, index_from_slice(plane, other, Vec3::Zero()));
    const Vec3 at = slice_from_index(plane, geometry, index_from_physical(geometry, first));
    const auto [mm_u, mm_v] = spacing_of(plane, other);
    return {map.pixel(at[0], at[1]), map.per_mm * mm_u, map.per_mm * mm_v, map.per_mm};
}

}  // namespace palpate::viewer
