// One DICOM file at a time through GDCM and ITK, checked before and within bounds of memory.
#pragma once

#include "io/helper/dicom_stack.hpp"

namespace palpate::io {

/// What the header says, after check_dicom(). Without rows: a file that has no image. Throws
/// Failure.
DicomSlice slice_from(const std::filesystem::path& file);

struct Decoded {
    Stored stored = Stored::uint8;
    std::vector<std::byte> samples;
    std::string decoder_said;  ///< warnings of the decoder of a compressed image, one line
    Geometry geometry;         ///< as ITK sees it; used for a file with several frames only
};

/// The samples, slope and intercept applied. Throws Failure, or the library's exception.
Decoded decode(const DicomSlice& slice, const Request& request);

}  // namespace palpate::io
