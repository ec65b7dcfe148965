// Compresses DICOM files with GDCM. No GDCM type is visible here.
#pragma once

#include <filesystem>
#include <ostream>

namespace palpate::io::test {

enum class Compression { jpeg_lossless, jpeg_ls, jpeg_2000, rle };

inline std::ostream& operator<<(std::ostream& out, Compression compression) {
    constexpr const char* names[] = {"jpeg_lossless", "jpeg_ls", "jpeg_2000", "rle"};
    return out << names[static_cast<int>(compression)];
}

/// False if GDCM did not manage.
bool compress_dicom(const std::filesystem::path& from, const std::filesystem::path& to,
                    Compression compression);

}  // namespace palpate::io::test
