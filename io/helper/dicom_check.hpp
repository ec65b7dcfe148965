// Checks a DICOM file before GDCM reads it: GDCM reads a cut-off file as a complete one, allocates
// whatever a damaged length says, and believes Rows and Columns more than the compressed image.
#pragma once

#include "io/helper/decode.hpp"

namespace palpate::io {

/// What the walk through the file found.
struct DicomExtent {
    std::string sop_class;  ///< from the file's meta information
    std::int64_t rows = 0, columns = 0;
    std::int64_t frames = 1;
    std::int64_t components = 1;  ///< values a pixel
    std::int64_t bits = 16;       ///< allocated for a value
    int shift = 0;                ///< unused bits below the samples
    bool deflated = false;        ///< the data set as a whole
    bool needs_copy = false;      ///< a library is to be given tidied_dicom() instead
    std::string compression;      ///< "JPEG 2000", "deflate", ...; empty if there is none
    std::vector<std::string> notes;

    /// Bytes of all frames, not compressed.
    std::uint64_t bytes() const;
};

/// Throws Failure, which names the file, if
/// - an element reaches beyond the end of the file, or there is no class of object at the start,
/// - there are fewer bytes of pixels than rows, columns, frames and bits ask for, or many more,
/// - a compressed image has another size, no end, or is not there for every frame,
/// - the deflated data are damaged, or unpack to more than the header declares.
DicomExtent check_dicom(const std::filesystem::path& file);

/// True for classes of objects that are known to have no image: reports, plans, the folder's index.
bool has_no_image(const std::string& sop_class);

/// The file as libraries read it as it is meant: a deflated one unpacked, in explicit little
/// endian; MONOCHROME1, which is about display only, as MONOCHROME2, so that no value is turned;
/// samples above the lowest of their bits with those below;
/// numbers of lengths as text of the usual type; without overlays that lie in unused bits of the
/// samples.
std::vector<std::byte> tidied_dicom(const std::filesystem::path& file);

}  // namespace palpate::io
