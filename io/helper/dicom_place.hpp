// Reads the place of a DICOM image and the size of its pixels, from its elements or from those of a
// functional group.
#pragma once

#include "io/helper/dicom_group.hpp"
#include "io/helper/dicom_slice.hpp"

namespace palpate::io {

/// The functional groups of each frame, and SpacingBetweenSlices.
inline constexpr DicomTag groups_of_frames{0x5200, 0x9230}, between_tag{0x0018, 0x0088};

/// Elements that are not there change nothing. All of these throw Failure.
void set_place(DicomSlice& slice, const std::vector<double>& position,
               const std::vector<double>& axes);
void set_place(DicomSlice& slice, const DicomGroup& group);
void set_pixel(DicomSlice& slice, const DicomGroup& measures);

}  // namespace palpate::io
