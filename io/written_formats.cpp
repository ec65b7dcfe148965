// The extensions of the formats that are written. See the header.
#include "palpate/io/written_formats.hpp"

#include <array>

namespace palpate::io {

std::span<const std::string_view> written_extensions() {
    static constexpr std::array<std::string_view, 10> all = {
        ".nrrd", ".nhdr", ".mha", ".mhd", ".nii", ".nii.gz", ".vti", ".tif", ".tiff", ".raw"};
    return all;
}

std::string_view written_extension_of(const std::filesystem::path& path) {
    const std::string name = path.filename().string();
    for (const std::string_view extension : written_extensions()) {
        if (name.size() > extension.size() && name.ends_with(extension)) return extension;
    }
    return {};
}

namespace {

/// A .raw is the data file of a .mhd or .nhdr of the same name: writing one of them may replace
/// samples of the other.
std::string owner_of_data(const std::filesystem::path& path, std::string_view extension) {
    const auto sibling = [&](const char* other) {
        std::filesystem::path name = path;
        name.replace_extension(other);
        std::error_code error;
        return std::filesystem::exists(name, error) ? name.filename().string() : std::string();
    };
    if (extension == ".raw") {
        const std::string mhd = sibling(".mhd");
        return mhd.empty() ? sibling(".nhdr") : mhd;
    }
    if ((extension == ".mhd" || extension == ".nhdr") && sibling(extension.data()).empty()) {
        return sibling(".raw");
    }
    return {};
}

}  // namespace

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
    if (extension.starts_with(".nii") && geometry.size.maxCoeff() > 32767) {
        return path.string() + ": NIfTI holds at most 32767 samples along an axis: name it .nrrd";
    }
    if (extension == ".mhd" && path.stem().string().find('%') != std::string::npos) {
        return path.string() + ": in a .mhd, % stands for numbered files: name it .mha";
    }
    const bool placed =
        geometry.origin != Vec3::Zero() || geometry.direction != Eigen::Matrix3d::Identity();
    if (placed && (extension == ".raw" || extension == ".tif" || extension == ".tiff")) {
        return path.string() + ": " + std::string(extension) +
               " keeps no origin and no directions, and this volume has them: name it .nrrd";
    }
    const std::string owner = owner_of_data(path, extension);
    if (!owner.empty()) {
        return path.string() + ": would replace samples that belong to " + owner +
               " beside it: choose another name";
    }
    return {};
}

}  // namespace palpate::io
