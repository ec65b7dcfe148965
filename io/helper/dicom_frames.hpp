// Makes slices of the frames of a DICOM file, with their places or moments.
#pragma once

#include "io/helper/dicom_group.hpp"
#include "io/helper/dicom_slice.hpp"

namespace palpate::io {

/// Each frame of `file` with the place, the stack and the moment that its functional groups give it
/// (PS3.3 C.7.6.16); without these, frames that the header counts by time are moments of one slice,
/// and others lie one behind the other. Throws Failure.
std::vector<DicomSlice> frames_in(const DicomSlice& file, const DicomGroup& data);

}  // namespace palpate::io
