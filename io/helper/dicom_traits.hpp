// Compares properties by which DICOM slices of one place may differ. Uses no library.
#pragma once

#include "io/helper/dicom_slice.hpp"

namespace palpate::io {

/// Slices by their numbers in a series; those at one place along the normal are one group.
using SlicesAtPlaces = std::vector<std::vector<std::size_t>>;

/// In order along the normal; empty where slices have no place.
SlicesAtPlaces slices_at_places(const DicomSeries& series);

/// For each slice, which of the different values of a property it has.
using TraitClasses = std::vector<std::size_t>;

/// One of each name that a slice has.
std::vector<DicomTrait> traits_in(const DicomSeries& series);

/// Numbers within 1 % are one value, as some scanners write what they measured for each slice.
TraitClasses classes_of(const DicomSeries& series, const char* name);

/// Whether there are several values at each place, and the same ones at all.
bool is_shared(const SlicesAtPlaces& places, const TraitClasses& classes);

/// The name of the property with its value.
std::string name_of(const DicomSlice& slice, const char* name);

/// The parts of a series that differ by name, which is added to the kinds of their slices.
std::vector<DicomSeries> divided(DicomSeries series, const std::vector<std::string>& names);

}  // namespace palpate::io
