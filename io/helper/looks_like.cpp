// Which program a file is for, where its name does not say it, or says it to several.
#include <cstring>
#include <fstream>

#include "io/helper/readers.hpp"

namespace palpate::io {

namespace fs = std::filesystem;

bool looks_like_dicom(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    char start[132] = {};
    in.read(start, sizeof start);
    return in.gcount() == sizeof start && std::memcmp(start + 128, "DICM", 4) == 0;
}

bool looks_like_tiff(const fs::path& file) {
    const std::string extension = lower(file.extension().string());
    return extension == ".tif" || extension == ".tiff";
}

}  // namespace palpate::io
