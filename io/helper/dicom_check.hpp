// Checks the structure of a DICOM file before GDCM reads it: GDCM reads a cut-off file as a
// complete one and allocates whatever a damaged length says.
#pragma once

#include <optional>

#include "io/helper/decode.hpp"

namespace palpate::io {

/// What the walk found.
struct DicomExtent {
    std::string sop_class;                    ///< from the file's meta information
    std::optional<std::uint64_t> pixel_data;  ///< bytes, if there are any and not compressed
};

/// Throws Failure if an element reaches beyond the end of the file, compressed pixel data have no
/// end, or there is no class of object at the start.
DicomExtent check_dicom(const std::filesystem::path& file);

/// True for classes of objects that are known to have no image: reports, plans, the folder's index.
bool has_no_image(const std::string& sop_class);

}  // namespace palpate::io
