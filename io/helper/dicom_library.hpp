// The samples of DICOM files, after dicom_check.hpp: of plain ones by ourselves, of compressed ones
// through GDCM, which sees a frame at a time and no header, within bounds of memory.
#pragma once

#include "io/helper/dicom_slice.hpp"

namespace palpate::io {

/// The samples of one file, or of one frame of it.
struct Decoded {
    Stored stored = Stored::uint8;
    std::vector<std::byte> samples;
    bool has_more_bits = false;  ///< bits other than the stored ones are set in some samples
    std::string decoder_said;    ///< warnings of the decoder of a compressed image, one line
};

/// The samples of some slices, each with its own slope and intercept, or its table, applied. A file
/// with several frames is opened once. Throws Failure, or the library's exception.
std::vector<Decoded> decode(const std::vector<DicomSlice>& slices, const Request& request);

}  // namespace palpate::io
