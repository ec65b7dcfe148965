// Compares the pixels of a DICOM file with the size that its header declares, before a decoder does
// or does not.
#pragma once

#include "io/helper/dicom_bytes.hpp"
#include "io/helper/dicom_check.hpp"

namespace palpate::io {

/// Where the pixels lie.
struct DicomPixels {
    bool found = false;
    std::uint64_t element = 0, at = 0;   ///< where the element and its value begin
    std::optional<std::uint64_t> plain;  ///< bytes, if they are not compressed
    struct Fragment {
        std::uint64_t at, length;
    };
    std::vector<Fragment> fragments;  ///< of compressed ones; the first is a table of the frames
};

/// Throws Failure unless there are as many bytes that are not compressed as declared, or a few
/// more.
void check_plain_size(const std::filesystem::path& file, std::uint64_t bytes,
                      const DicomExtent& declared);

/// The same, by what the bytes are; a note if there are more than declared.
std::optional<std::string> check_plain_pixels(const std::filesystem::path& file,
                                              const DicomBytes& bytes, const DicomPixels& pixels,
                                              const DicomExtent& declared);

/// What is stored for each frame: its fragments joined, without what follows the end of an image.
struct DicomStreams {
    std::vector<std::vector<std::byte>> frames;
    std::uint64_t surplus = 0;  ///< bytes behind the ends, other than a few of padding
};
DicomStreams streams_of(const DicomBytes& bytes, const DicomPixels& pixels,
                        const DicomExtent& declared);

/// A frame as a decoder or we ourselves go on with it: a code stream, or samples that were deflated
/// or lay in a fragment as they are. Throws Failure.
std::vector<std::byte> frame_of(const std::filesystem::path& file, std::vector<std::byte> stream,
                                const DicomExtent& declared);

/// Whether a transfer syntax is one of the standard's that we know.
bool is_known_syntax(const std::string& syntax);

/// Every frame's own size and end; takes down the name of the compression, and notes. Throws
/// Failure.
void check_compressed_pixels(const std::filesystem::path& file, const DicomBytes& bytes,
                             const DicomPixels& pixels, DicomExtent& declared);

}  // namespace palpate::io
