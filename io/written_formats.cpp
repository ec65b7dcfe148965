// The extensions of the formats that are written. See the header.
#include "palpate/io/written_formats.hpp"

#include <algorithm>
#include <array>
#include <fstream>
#include <sstream>
#include <string>
#include <system_error>

#include "io/file_grid.hpp"

namespace palpate::io {

namespace fs = std::filesystem;

std::span<const std::string_view> written_extensions() {
    static constexpr std::array<std::string_view, 10> all = {
        ".nrrd", ".nhdr", ".mha", ".mhd", ".nii", ".nii.gz", ".vti", ".tif", ".tiff", ".raw"};
    return all;
}

std::string_view written_extension_of(const fs::path& path) {
    const std::string name = path.filename().string();
    for (const std::string_view extension : written_extensions()) {
        if (name.size() > extension.size() && name.ends_with(extension)) return extension;
    }
    return {};
}

namespace {

/// The ends of the names of data files beside headers.
struct DataEnds {
    std::string_view header, plain, compressed;
};

constexpr std::array<DataEnds, 2> data_ends = {{
    {".nhdr", ".raw", ".raw.gz"},
    {".mhd", ".raw", ".zraw"},
}};

bool is_taken(const fs::path& path) {
    std::error_code error;
    return fs::exists(fs::symlink_status(path, error));
}

/// The data file that a header names; empty if it names none or cannot be read.
fs::path data_file_named_in(const fs::path& header) {
    constexpr std::size_t longest = std::size_t{1} << 16;  // samples may follow a header
    std::error_code error;
    if (!fs::is_regular_file(header, error)) return {};
    std::string text(longest, '\0');
    std::ifstream in(header, std::ios::binary);
    in.read(text.data(), static_cast<std::streamsize>(text.size()));
    text.resize(static_cast<std::size_t>(in.gcount()));
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
        const std::size_t sign = std::min(line.find_first_of(":="), line.size());
        std::string field;
        for (const char c : line.substr(0, sign)) {
            if (c != ' ') field += c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c;
        }
        if (field != "datafile" && field != "elementdatafile") continue;
        const std::size_t first = line.find_first_not_of(" \t", sign + 1);
        const std::size_t last = line.find_last_not_of(" \t\r");
        if (first > last || first == line.npos) return {};
        return fs::path(line.substr(first, last - first + 1)).lexically_normal();
    }
    return {};
}

/// The file beside `path` whose samples would be replaced. A data file may be replaced only if the
/// header of this name is the only one that names it.
std::string owner_of_data(const fs::path& path, std::string_view extension, bool compress) {
    const fs::path data = extension == ".raw" ? path : data_file_of(path, compress);
    if (data.empty() || (extension != ".raw" && !is_taken(data))) return {};
    for (const DataEnds& ends : data_ends) {
        const fs::path header = fs::path(path).replace_extension(ends.header);
        if (ends.header == extension || !is_taken(header)) continue;
        const bool is_named = data_file_named_in(header).filename() == data.filename();
        if (extension == ".raw" || is_named) return header.filename().string();
    }
    const bool is_own = extension == ".raw" || data_file_named_in(path) == data.filename();
    return is_own ? std::string() : data.filename().string();
}

/// The header of two files names the one with the samples, in a line of text.
std::string why_not_in_header(const std::string& stem, std::string_view extension) {
    if (extension != ".nhdr" && extension != ".mhd") return {};
    const std::string one_file = extension == ".nhdr" ? ": name it .nrrd" : ": name it .mha";
    if (extension == ".mhd" && stem.find('%') != std::string::npos) {
        return ": in a .mhd, % stands for numbered files" + one_file;
    }
    const auto is_control = [](char c) { return static_cast<unsigned char>(c) < ' ' || c == 127; };
    const bool has_colon = extension == ".nhdr" && stem.find(':') != std::string::npos;
    if (!has_colon && !stem.starts_with(' ') && std::ranges::none_of(stem, is_control)) return {};
    return ": a " + std::string(extension) +
           " cannot name a file of samples that begins with a blank or contains a line end" +
           (extension == ".nhdr" ? " or a colon" : "") + one_file;
}

}  // namespace

fs::path data_file_of(const fs::path& path, bool compress) {
    const std::string_view extension = written_extension_of(path);
    for (const DataEnds& ends : data_ends) {
        if (ends.header != extension) continue;
        return fs::path(path).replace_extension(compress ? ends.compressed : ends.plain);
    }
    return {};
}

std::string why_not_compressed(const fs::path& path) {
    const std::string_view extension = written_extension_of(path);
    if (extension != ".nii" && extension != ".raw") return {};
    return std::string(extension) + " is never compressed: name it " +
           (extension == ".nii" ? ".nii.gz" : ".nrrd");
}

std::string why_not_written(const fs::path& path, const Geometry& geometry, bool compress) {
    const std::string_view extension = written_extension_of(path);
    if (extension.empty()) {
        const auto all = written_extensions();
        std::string text = path.string() + ": a volume is written as ";
        for (const std::string_view other : all.first(all.size() - 1)) {
            text.append(other).append(other == all[all.size() - 2] ? " or " : ", ");
        }
        return text.append(all.back()) + ": name one of these";
    }
    if (const std::string why = why_not_stored(geometry); !why.empty()) {
        return path.string() + ": " + why;
    }
    if (extension.starts_with(".nii") && geometry.size.maxCoeff() > 32767) {
        return path.string() + ": NIfTI holds at most 32767 samples along an axis: name it .nrrd";
    }
    if (const std::string why = why_not_in_header(path.stem().string(), extension); !why.empty()) {
        return path.string() + why;
    }
    const bool placed =
        geometry.origin != Vec3::Zero() || geometry.direction != Eigen::Matrix3d::Identity();
    if (placed && (extension == ".raw" || extension == ".tif" || extension == ".tiff")) {
        return path.string() + ": " + std::string(extension) +
               " keeps no origin and no directions, and this volume has them: name it .nrrd";
    }
    const std::string owner = owner_of_data(path, extension, compress);
    if (!owner.empty()) {
        return path.string() + ": would replace samples that belong to " + owner +
               " beside it: choose another name";
    }
    return {};
}

}  // namespace palpate::io
