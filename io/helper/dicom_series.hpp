// Sorts DICOM slices into series, and lists these if one has to be chosen. Uses no library.
#pragma once

#include "io/helper/dicom_slice.hpp"

namespace palpate::io {

/// What there is to know of it before its samples are read.
SeriesInfo info_of(const DicomSeries& series);
/// The slice halfway along the normal.
const DicomSlice& middle_of(const DicomSeries& series);

/// Sorts slices into series, in the order of their UIDs.
std::vector<DicomSeries> series_of(std::vector<DicomSlice> slices);

/// The series that `chosen` names by number (from 1) or UID, or the only one there is. Otherwise
/// throws ChooseSeries, without pictures.
const DicomSeries& choose_series(const std::vector<DicomSeries>& all, const std::string& chosen);

/// [mm] of its slices along the normal, in order; empty where slices have no place.
std::vector<double> places_along(const DicomSeries& series);

/// [mm] Slices of the series that are nearer to each other lie at one place.
double same_place_mm(const DicomSeries& series);

}  // namespace palpate::io
