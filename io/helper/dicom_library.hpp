// DICOM files through ITK, one at a time, after dicom_check.hpp and within bounds of memory.
#pragma once

#include "io/helper/dicom_stack.hpp"

namespace palpate::io {

/// The samples of one file, or of one frame of it.
struct Decoded {
    Stored stored = Stored::uint8;
    std::vector<std::byte> samples;
    std::string decoder_said;         ///< warnings of the decoder of a compressed image, one line
    double slope = 1, intercept = 0;  ///< that have been applied
};

/// The samples of some slices, each with its own slope and intercept applied. A file with several
/// frames is decoded once. Throws Failure, or the library's exception.
std::vector<Decoded> decode(const std::vector<DicomSlice>& slices, const Request& request);

}  // namespace palpate::io
