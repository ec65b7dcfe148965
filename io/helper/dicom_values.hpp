// The meaning of the stored numbers of a DICOM image: slope and intercept, a dose, a table, units,
// the window and padding.
#pragma once

#include "io/helper/dicom_group.hpp"
#include "io/helper/dicom_slice.hpp"

namespace palpate::io {

/// RealWorldValueMappingSequence, which is not applied.
inline constexpr DicomTag value_mapping{0x0040, 0x9096};

/// All of a file. Throws Failure.
void set_values(DicomSlice& slice, const DicomGroup& data);
/// What depends on the slope and the units of the frame: padding, and whether a CT is in HU. Once
/// these are known.
void finish_values(DicomSlice& slice, const DicomGroup& data);

/// Of a frame, from its functional groups. Elements that are not there change nothing.
void set_rescale(DicomSlice& slice, const DicomGroup& transformation);
void set_window(DicomSlice& slice, const DicomGroup& group);
void note_value_mapping(DicomSlice& slice);

}  // namespace palpate::io
