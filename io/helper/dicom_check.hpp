// Walks through a DICOM file before GDCM reads any of it. GDCM reads a cut-off file as a complete
// one and allocates whatever a damaged length says. It believes Rows and Columns more than the
// compressed image.
#pragma once

#include <functional>

#include "io/helper/decode.hpp"

namespace palpate::io {

/// What the walk through the file found.
struct DicomExtent {
    std::string sop_class;  ///< from the file's meta information
    std::int64_t rows = 0, columns = 0;
    std::int64_t frames = 1;
    std::int64_t components = 1;      ///< values a pixel
    std::int64_t bits = 16;           ///< allocated for a value
    std::int64_t stored_bits = 0;     ///< used of these; 0 if not given
    std::int64_t high_bit = -1;       ///< the highest of them; -1 if not given
    std::int64_t representation = 0;  ///< 1: signed
    bool is_subsampled = false;       ///< two pixels of three components share two of these (4:2:2)
    bool has_image = false, is_real = false;  ///< is_real: Float or Double Float Pixel Data
    std::size_t swapped_bytes = 1;            ///< of a big-endian word of samples; 1: none
    std::string syntax;                       ///< UID
    std::string compression;  ///< "JPEG 2000", "deflate", ...; empty if there is none
    std::string header;       ///< the file up to its pixels, never deflated
    std::vector<std::string> notes;

    /// Bytes of all frames, not compressed.
    std::uint64_t bytes() const;
    /// Unused bits below the samples of files that are not compressed.
    int shift() const;
    /// The samples are frames of a code stream.
    bool is_encapsulated() const { return !compression.empty() && compression != "deflate"; }
};

/// Throws Failure, which names the file, if
/// - an element reaches beyond the end of the file, or neither a class of object nor an image is
///   there,
/// - there are fewer bytes of pixels than rows, columns, frames and bits ask for, or many more,
/// - a compressed image has another size, no end, or is not there for every frame,
/// - the deflated data are damaged, or unpack to more than the header declares.
DicomExtent check_dicom(const std::filesystem::path& file);

/// Hands over frames as they are stored, in the order that is asked for: a code stream, or samples,
/// of which those of one bit have a byte each, 0 or 1.
using UseFrame = std::function<void(int frame, std::span<const std::byte> bytes)>;
void read_frames(const std::filesystem::path& file, const std::vector<int>& frames,
                 const std::function<void(const DicomExtent&)>& begin, const UseFrame& use);

/// True for classes of objects that are known to have no image: reports, plans, the folder's index.
bool has_no_image(const std::string& sop_class);

}  // namespace palpate::io
