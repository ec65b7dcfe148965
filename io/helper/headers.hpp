// Our own look at NRRD, MetaImage and NIfTI headers before ITK gets the file: ITK loads cut-off and
// damaged files without a word. Each function checks header against file, the checksums of
// compressed data included, and throws Failure.
#pragma once

#include "io/helper/decode.hpp"

namespace palpate::io {

/// What a header says, as far as ITK's answer is compared with it.
struct HeaderFacts {
    std::vector<std::int64_t> sizes;  ///< every axis, the file's order
    Stored stored = Stored::uint8;
    /// The axis that counts volumes if it is not the last one (NRRD's "list" and "time" kinds).
    std::optional<std::size_t> list_axis;
    std::vector<std::string> notes;
    FrameTimes times;  ///< of a file with such an axis
};

HeaderFacts check_nrrd(const Request& request);
HeaderFacts check_meta_image(const Request& request);
HeaderFacts check_nifti(const Request& request);

/// How the samples lie in the file that holds them.
struct DataPlace {
    std::filesystem::path file;
    std::uint64_t offset = 0;           ///< of the first byte of data (or of the stream)
    std::uint64_t length = UINT64_MAX;  ///< bytes of a compressed stream, if the header says
    std::uint64_t skip = 0;             ///< bytes before the samples, after unpacking
    enum class Encoding { raw, compressed, text } encoding = Encoding::raw;
};

/// Checks that the data hold `bytes` (or, as text, `count` numbers), no less and, but for padding
/// up to 4096 bytes, no more; unpacks compressed data for it.
void check_data(const DataPlace& place, std::uint64_t bytes, std::uint64_t count,
                std::vector<std::string>& notes);

/// Numbers separated by blanks; throws Failure that names the `field`.
std::vector<double> numbers_in(const std::string& text, const std::string& field);
/// The same for sizes.
std::vector<std::int64_t> sizes_in(const std::string& text, const std::string& field);
/// Refuses a spacing that is not a finite number above 0.
void check_spacing(double spacing, const std::string& field);

}  // namespace palpate::io
