// Arranges the slices of a DICOM series in a regular grid: sorts them along the normal, finds
// missing ones and shifts between them. Uses no library.
#pragma once

#include "io/helper/dicom_slice.hpp"

namespace palpate::io {

/// One slice and its position.
struct PlacedSlice {
    std::size_t slice = 0;  ///< which of the series
    double along = 0;       ///< [mm] from the first slice, along the normal
    std::size_t at = 0;     ///< the slice whose place counts, so that all time steps have one grid
    double u = 0, v = 0;    ///< shift within the plane against the first slice [pixels]
};

/// A grid slice: a slice unchanged, two of them blended (the second with `weight`), or zeros.
struct GridSlice {
    std::size_t first = 0, second = 0;  ///< which of Stack::slices
    double weight = 0;
    bool is_empty = false;
};

struct Stack {
    Geometry geometry;
    std::vector<PlacedSlice> slices;  ///< of the chosen time step, in order along the normal
    std::vector<GridSlice> grid;      ///< one for every slice of the geometry
    double first_u = 0, first_v = 0;  ///< where the grid's column 0 and row 0 lie [pixels]
    bool sheared = false;             ///< gantry tilt: the slices' shifts have to be undone
    int time_steps = 1;
    double seconds = 0;  ///< from one to the next; 0 if not given
    std::vector<std::string> notes;
};

/// Throws Failure where no sensible grid exists.
Stack stack_slices(const DicomSeries& series, const Request& request);

}  // namespace palpate::io
