// The slices of a DICOM file by its header: one, or one for each of its frames.
#pragma once

#include "io/helper/dicom_slice.hpp"

namespace palpate::io {

/// Of slices whose files have overlays among their samples.
inline constexpr const char* overlays_note = "overlays in unused bits of its samples were ignored";

/// The slices of a file, after check_dicom(); none if it has no image. Each frame of a file with
/// several is a slice, with the place, the stack and the moment that its functional groups give it
/// (PS3.3 C.7.6.16); without these, frames that the header counts by time are moments of one slice,
/// and others lie one behind the other. Throws Failure.
std::vector<DicomSlice> slices_from(const std::filesystem::path& file);

}  // namespace palpate::io
