// Which program a file is for, where its name does not say it, or says it to several.
#include <algorithm>
#include <cstring>
#include <fstream>

#include "io/byte_order.hpp"
#include "io/helper/readers.hpp"

namespace palpate::io {

namespace fs = std::filesystem;

namespace {

/// The first two elements of a data set or of the meta information, in little endian, without what
/// comes before them in most files.
bool begins_with_elements(std::span<const char> bytes) {
    const auto number = [&](std::size_t at) -> unsigned {
        return little_endian<std::uint16_t>(std::as_bytes(bytes.subspan(at)));
    };
    const unsigned group = number(0), element = number(2);
    if ((group != 0x0002 && group != 0x0008) || element > 0x0020) return false;
    const auto is_upper = [](char c) { return c >= 'A' && c <= 'Z'; };
    const bool is_explicit = is_upper(bytes[4]) && is_upper(bytes[5]);
    if (!is_explicit && number(6) != 0) return false;  // the length's upper half
    const std::size_t next = 8 + number(is_explicit ? 6 : 4);
    if (next + 4 > bytes.size()) return false;
    return number(next) == group && number(next + 2) > element;
}

}  // namespace

bool is_hidden(const fs::path& file) {
    return file.filename().native().starts_with('.');
}

bool is_shown_file(const fs::directory_entry& entry) {
    std::error_code error;  // of links that lead nowhere
    return entry.is_regular_file(error) && !is_hidden(entry.path());
}

bool is_dangling_link(const fs::directory_entry& entry) {
    std::error_code error;
    return entry.is_symlink(error) && !entry.exists(error) && !is_hidden(entry.path());
}

bool begins_as_dicom(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    char start[256] = {};
    in.read(start, sizeof start);
    const auto size = static_cast<std::size_t>(in.gcount());
    if (size >= 132 && std::memcmp(start + 128, "DICM", 4) == 0) return true;
    const bool has_letters = std::memcmp(start, "DICM", 4) == 0;  // without what precedes them
    return size == sizeof start &&
           begins_with_elements(std::span(start).subspan(has_letters ? 4 : 0));
}

bool looks_like_dicom(const fs::path& file) {
    return !is_hidden(file) && begins_as_dicom(file);
}

bool has_dicom_name(const fs::path& file) {
    const fs::path name = lower(file.filename().string());
    const std::string extension = (name.extension() == ".gz" ? name.stem() : name).extension();
    return extension == ".dcm" || extension == ".dicom" || extension == ".ima";
}

bool is_dicom_index(const fs::path& file) {
    return lower(file.filename().string()) == "dicomdir";
}

bool has_dicom_index(const fs::path& folder) {
    const auto is_index = [](const fs::directory_entry& entry) {
        return is_shown_file(entry) && is_dicom_index(entry.path());
    };
    return std::ranges::any_of(fs::directory_iterator(folder), is_index);
}

bool begins_as_hdf5(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    std::string start(8, ' ');
    in.read(start.data(), 8);
    return start == "\x89HDF\r\n\x1a\n";
}

bool begins_as_tiff(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    std::string start(4, ' ');
    in.read(start.data(), 4);
    for (const char version : {'*', '+'}) {  // classic and BigTIFF
        if (start == std::string{'I', 'I', version, '\0'}) return true;
        if (start == std::string{'M', 'M', '\0', version}) return true;
    }
    return false;
}

}  // namespace palpate::io
