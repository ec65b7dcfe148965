// How a slice across a grid axis is shown: by the body's axes in the radiological convention,
// whatever the grid's direction. Also where it lies in a widget.
#pragma once

#include <QPointF>
#include <QSizeF>

#include <string>

#include "palpate/volume.hpp"

namespace palpate::viewer {

/// A grid axis that runs along an edge of the screen.
struct ScreenAxis {
    int axis = 0;       ///< of the grid
    bool flip = false;  ///< the sample with the greatest index comes first
};

/// The slices across one axis of a grid. Points are (u, v, layer): u and v in samples from the
/// slice's upper left corner, u to the right, v down, the middle of the first sample at (0, 0); the
/// layer counts from 0 along the grid axis.
struct SlicePlane {
    Geometry grid;
    int axis = 2;            ///< of the grid: across
    ScreenAxis right, down;  ///< u and v
    int anatomical = 2;      ///< what `axis` is nearest to: 0 left-right, 1 front-back, 2 up-down
    std::string title;       ///< Sagittal, Coronal or Axial; YZ, XZ or XY of a grid not oriented
    /// What lies towards each edge of the screen: L, R, A, P, S, I (+X, -X, ...), the nearest
    /// first; a second or third letter where the grid lies aslant by more than 15 degrees.
    std::string at_left, at_right, at_top, at_bottom;

    int width() const { return grid.size[right.axis]; }  ///< samples along u
    int height() const { return grid.size[down.axis]; }  ///< samples along v
    int layers() const { return grid.size[axis]; }
    double mm_u() const { return grid.spacing[right.axis]; }  ///< between samples
    double mm_v() const { return grid.spacing[down.axis]; }
    Vec3 point(const Vec3& physical) const;
    Vec3 physical(const Vec3& point) const;
    /// The slices of another grid with the same directions.
    SlicePlane in(const Geometry& other) const;
};

/// The slices across grid axis `axis` (0, 1, 2): the patient's left on the right, the front above
/// (axial) or on the left (sagittal), the head above (coronal, sagittal). Three axes of a grid get
/// three different titles.
SlicePlane slice_plane(const Geometry& grid, int axis);

/// Where a slice lies along its axis, as "S 12.5 mm": millimetres from the physical origin towards
/// the body's side that the letter names.
std::string position_text(const SlicePlane& plane, const Vec3& physical);

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
SliceMap slice_map(const SlicePlane& plane, const SliceView& view, const QSizeF& size,
                   double margin);
/// Of the slices of another grid, drawn in the same place.
SliceMap map_in(const SlicePlane& other, const SlicePlane& plane, const SliceMap& map);

}  // namespace palpate::viewer
