// Maps samples of a slice to positions in a widget, and back.
#pragma once

#include <QPointF>
#include <QSizeF>

#include <algorithm>

#include "apps/viewer/slices/plane.hpp"

namespace palpate::viewer {

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
