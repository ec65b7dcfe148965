// The extensions of the formats that are written; see the header.
#include "io/written_formats.hpp"

#include <algorithm>
#include <array>
#include <cctype>

namespace palpate::io {

std::span<const std::string_view> written_extensions() {
    static constexpr std::array<std::string_view, 10> all = {
        ".nrrd", ".nhdr", ".mha", ".mhd", ".nii", ".nii.gz", ".vti", ".tif", ".tiff", ".raw"};
    return all;
}

std::string_view written_extension_of(const std::filesystem::path& path) {
    std::string name = path.filename().string();
    std::transform(name.begin(), name.end(), name.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    for (const std::string_view extension : written_extensions()) {
        if (name.ends_with(extension)) return extension;
    }
    return {};
}

std::string why_not_written(const std::filesystem::path& path, const Geometry& geometry) {
    const std::string_view extension = written_extension_of(path);
    if (extension.empty()) {
        const auto all = written_extensions();
        std::string text = path.string() + ": a volume is written as ";
        for (const std::string_view other : all.first(all.size() - 1)) {
            text.append(other).append(other == all[all.size() - 2] ? " or " : ", ");
        }
        return text.append(all.back()) + ": name one of these";
    }
    const bool placed =
        geometry.origin != Vec3::Zero() || geometry.direction != Eigen::Matrix3d::Identity();
    if (placed && (extension == ".raw" || extension == ".tif" || extension == ".tiff")) {
        return path.string() + ": " + std::string(extension) +
               " keeps no origin and no directions, and this volume has them: name it .nrrd";
    }
    return {};
}

}  // namespace palpate::io
