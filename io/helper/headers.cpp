// Shared by the readers of headers: fields, lists of numbers, spacings.
#include "io/helper/headers.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <optional>
#include <sstream>

#include "io/system/number.hpp"

namespace palpate::io {
namespace {

constexpr std::size_t most_files = 1 << 16;
constexpr std::size_t longest_path = 4096, longest_name = 255;  // of Linux

/// "a%03d.raw 1 9 2": files that are named by their numbers.
struct FilePattern {
    std::string before, after;
    std::size_t width = 0;
    char fill = ' ';
    std::int64_t first = 0, last = 0, step = 0;
};

/// Takes the last word off a text, if it is a whole number.
std::optional<std::int64_t> last_number(std::string& text) {
    const std::size_t blank = text.find_last_of(" \t");
    if (blank == text.npos) return std::nullopt;
    const auto number = number_from<std::int64_t>(text.substr(blank + 1));
    if (number) text = trimmed(text.substr(0, blank));
    return number;
}

/// Its numbers are the first one, the last one and the step. A fourth one (dimensions of a file)
/// says nothing that the sizes do not. MetaImage may leave out the last two or all of them: then
/// there is a file for each of `steps`.
std::optional<FilePattern> pattern_in(const std::string& name, std::int64_t steps) {
    std::string file = trimmed(name);
    std::vector<std::int64_t> numbers;
    while (numbers.size() < 4) {
        const auto number = last_number(file);
        if (!number) break;
        numbers.insert(numbers.begin(), *number);
    }
    const std::size_t at = file.find('%');
    const std::size_t letter = at == file.npos ? at : file.find_first_not_of("0123456789", at + 1);
    if (letter == file.npos || file[letter] != 'd') return std::nullopt;
    if (numbers.size() < 2 && steps > 0) {
        const std::int64_t first = numbers.empty() ? 1 : numbers[0];
        numbers = {first, first + steps - 1, 1};
    }
    if (numbers.size() < 3) return std::nullopt;
    const std::string width = file.substr(at + 1, letter - at - 1);
    FilePattern pattern{file.substr(0, at), file.substr(letter + 1), 0, ' ', numbers[0], numbers[1],
                        numbers[2]};
    pattern.width = number_from<unsigned char>(width).value_or(0);
    if (width.starts_with('0')) pattern.fill = '0';
    for (const std::int64_t number : numbers) {
        if (pattern.step != 0 && std::abs(number) <= std::int64_t{1} << 30) continue;
        throw Failure("its numbers of data files make no sense; correct the header");
    }
    return pattern;
}

/// The file of the same name in the folder of the header.
std::filesystem::path file_beside(const std::string& name, const std::filesystem::path& header) {
    return header.parent_path() / name.substr(name.find_last_of("/\\") + 1);
}

/// Finds a data file at the place that the header names, or beside the header. Files that come from
/// another folder or system ("C:\\scan\\a.raw") are usually put there.
std::filesystem::path data_file(const std::string& name, const std::filesystem::path& header,
                                std::vector<std::string>& notes) {
    const std::filesystem::path told = header.parent_path() / name;
    const std::filesystem::path beside = file_beside(name, header);
    std::error_code error;
    if (std::filesystem::exists(told, error) || !std::filesystem::is_regular_file(beside, error) ||
        beside == header) {
        return told;
    }
    add_note(notes, "its header names a data file that is not there ('" + name.substr(0, 200) +
                        "'): that of the same name beside it was taken");
    return beside;
}

}  // namespace

std::string HeaderFields::value(const std::string& name) const {
    if (disputed.contains(name)) {
        throw Failure("its header has the field '" + name.substr(0, 40) +
                      "' twice; remove the wrong one");
    }
    const auto found = values.find(name);
    return found == values.end() ? "" : found->second;
}

std::string HeaderFields::needed(const std::string& name) const {
    if (value(name).empty()) {
        throw Failure("its header has no field '" + name + "'; the header is damaged");
    }
    return value(name);
}

std::uint64_t VolumeHeader::samples() const {
    std::uint64_t count = 1;
    for (const auto size : sizes) count *= static_cast<std::uint64_t>(size);
    return count;
}

std::string extension_of(const std::filesystem::path& path) {
    const std::string last = lower(path.extension().string());
    return last == ".gz" ? lower(path.stem().extension().string()) + last : last;
}

std::vector<std::byte> start_of(const std::filesystem::path& file, std::size_t bytes) {
    std::vector<std::byte> start(bytes);
    if (is_gzip(file)) {
        try {
            return inflate_start(file, bytes);
        } catch (const DamagedStream& e) {
            throw Failure(std::string(e.what()) + "; copy or download it again");
        }
    }
    std::ifstream in(file, std::ios::binary);
    in.read(reinterpret_cast<char*>(start.data()), std::ssize(start));
    start.resize(static_cast<std::size_t>(in.gcount()));
    return start;
}

std::vector<std::filesystem::path> other_halves(const std::filesystem::path& path) {
    const std::string extension = extension_of(path);
    const bool is_header = extension == ".hdr" || extension == ".hdr.gz";
    if (!is_header && extension != ".img" && extension != ".img.gz") return {};
    std::string name = path.string();
    name.resize(name.size() - extension.size());
    std::vector<std::filesystem::path> halves;
    for (const std::string end : {".img", ".IMG", ".img.gz", ".hdr", ".HDR", ".hdr.gz"}) {
        if (lower(end).starts_with(is_header ? ".img" : ".hdr") &&
            std::filesystem::is_regular_file(name + end)) {
            halves.emplace_back(name + end);
        }
    }
    return halves;
}

ReadHeader* header_reader(const std::filesystem::path& path) {
    const std::string extension = extension_of(path);
    if (extension == ".nrrd" || extension == ".nhdr") return &nrrd_header;
    if (extension == ".mha" || extension == ".mhd") return &meta_image_header;
    if (extension == ".nii" || extension == ".nii.gz") return &nifti_header;
    if (extension == ".mgh" || extension == ".mgz" || extension == ".mgh.gz") return &mgh_header;
    if (extension == ".vtk") return &vtk_header;
    for (const char* end : {".mrc", ".map", ".rec", ".ccp4"}) {
        if (extension == end || extension == end + std::string(".gz")) return &mrc_header;
    }
    if (!other_halves(path).empty()) return &nifti_header;
    return nullptr;
}

std::vector<std::filesystem::path> files_read_with(const std::filesystem::path& header) {
    std::vector<std::filesystem::path> files = other_halves(header);
    Request request;
    request.path = header;
    try {
        if (ReadHeader* const read = header_reader(header)) {
            for (const DataPlace& place : read(request).places) files.push_back(place.file);
        }
    } catch (const Failure&) {  // said where it is read
    }
    return files;
}

std::vector<double> numbers_in(const std::string& text, const std::string& field) {
    std::vector<double> numbers;
    const char* at = text.data();
    const char* const end = at + text.size();
    while (true) {
        while (at < end && std::strchr(" \t\r\n", *at) != nullptr) ++at;
        if (at == end) return numbers;
        double number = 0;
        const auto [next, error] = read_number(at, end, number);
        if (error != std::errc{} || (next < end && std::strchr(" \t\r\n", *next) == nullptr)) {
            throw Failure("its header field '" + field + "' is not a list of numbers ('" +
                          text.substr(0, 60) + "'); correct the header");
        }
        numbers.push_back(number);
        at = next;
    }
}

std::vector<std::int64_t> sizes_in(const std::string& text, const std::string& field) {
    std::vector<std::int64_t> sizes;
    for (const double number : numbers_in(text, field)) {
        if (!(number >= 1 && number <= 1e9) || number != std::floor(number)) {
            throw Failure("its header field '" + field + "' has the size " + text_of(number) +
                          "; correct the header");
        }
        sizes.push_back(static_cast<std::int64_t>(number));
    }
    return sizes;
}

std::int64_t whole_number_in(const std::string& text, const std::string& field, double least) {
    const auto numbers = numbers_in(text, field);
    if (numbers.size() != 1 || !(numbers[0] >= least && numbers[0] < 1e15)) {
        throw Failure("its header field '" + field + "' makes no sense; correct the header");
    }
    return static_cast<std::int64_t>(numbers[0]);
}

bool is_list(const std::string& name) {
    return name.starts_with("LIST") && name.find_first_not_of(" \t0123456789D", 4) == name.npos;
}

std::vector<std::filesystem::path> data_files(const std::string& name, const HeaderFields& fields,
                                              const std::filesystem::path& header,
                                              std::vector<std::string>& notes, std::int64_t steps) {
    std::error_code error;
    for (const auto& file : {header.parent_path() / name, file_beside(name, header)}) {
        if (std::filesystem::is_regular_file(file, error)) steps = 0;  // its name is no pattern
    }
    std::vector<std::filesystem::path> files;
    const auto add = [&](const std::string& file) {
        files.push_back(data_file(file, header, notes));
        if (file.size() > longest_path || files.back().filename().string().size() > longest_name) {
            throw Failure("the name of a data file is too long; correct the header");
        }
        if (files.size() > most_files)
            throw Failure("it has more than 65536 data files; save it as one");
    };
    if (is_list(name)) {
        std::ifstream in(header, std::ios::binary);
        in.seekg(static_cast<std::streamoff>(fields.data_offset));
        std::string line(longest_path + 2, 0);
        while (in.getline(line.data(), std::ssize(line)) || in.gcount() > 0) {
            const std::string file = trimmed(line.c_str());
            if (!file.empty()) add(file);
        }
    } else if (const auto pattern = pattern_in(name, steps)) {
        const auto [before, after, width, fill, first, last, step] = *pattern;
        for (std::int64_t i = first; step > 0 ? i <= last : i >= last; i += step) {
            const std::string digits = std::to_string(i);
            add(before + std::string(width - std::min(width, digits.size()), fill) + digits +
                after);
        }
    } else {
        add(name);
    }
    if (files.empty()) throw Failure("its list of data files is empty; correct the header");
    return files;
}

std::vector<DataPlace> places_in(const std::vector<std::filesystem::path>& files,
                                 const DataPlace& like) {
    std::vector<DataPlace> places(files.size(), like);
    for (std::size_t i = 0; i < files.size(); ++i) places[i].file = files[i];
    return places;
}

void put_at_end(DataPlace& place, std::uint64_t bytes, const std::string& field) {
    if (place.encoding != DataPlace::Encoding::raw) {
        throw Failure("its " + field + " of -1 is for raw samples only; correct the header");
    }
    std::error_code error;
    const std::uint64_t size = std::filesystem::file_size(place.file, error);
    if (!error && size >= bytes + place.offset) place.offset = size - bytes;
}

std::uint64_t file_bytes(const VolumeHeader& header) {
    std::uint64_t slices = 1, bytes = 0;
    for (std::size_t a = 2; a < header.sizes.size(); ++a) {
        slices *= static_cast<std::uint64_t>(header.sizes[a]);
    }
    const std::size_t files = header.places.size();
    if (slices % files != 0) {
        throw Failure("its header names " + std::to_string(files) + " data files for " +
                      std::to_string(slices) + " slices; correct the header");
    }
    for (const DataPlace& place : header.places) {
        std::error_code error;
        const std::uint64_t size = std::filesystem::file_size(place.file, error);
        bytes += error ? 0 : size;
    }
    return bytes;
}

}  // namespace palpate::io
