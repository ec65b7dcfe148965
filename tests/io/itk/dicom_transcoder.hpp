// Compresses DICOM files with GDCM. No GDCM type is visible here.
#pragma once

#include <filesystem>

namespace palpate::io::test {

enum class Compression { jpeg_lossless, jpeg_ls, jpeg_2000, rle };

/// False if GDCM did not manage.
bool compress_dicom(const std::filesystem::path& from, const std::filesystem::path& to,
                    Compression compression);

}  // namespace palpate::io::test
