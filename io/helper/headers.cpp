// Shared by the readers of headers: fields, lists of numbers, spacings.
#include "io/helper/headers.hpp"

#include <charconv>
#include <cmath>
#include <cstring>

namespace palpate::io {

std::string HeaderFields::value(const std::string& name) const {
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
    const std::string name = lower(path.filename().string());
    return name.ends_with(".nii.gz") ? ".nii.gz" : lower(path.extension().string());
}

ReadHeader* header_reader(const std::filesystem::path& path) {
    const std::string extension = extension_of(path);
    if (extension == ".nrrd" || extension == ".nhdr") return &nrrd_header;
    if (extension == ".mha" || extension == ".mhd") return &meta_image_header;
    if (extension == ".nii" || extension == ".nii.gz") return &nifti_header;
    return nullptr;
}

std::vector<double> numbers_in(const std::string& text, const std::string& field) {
    std::vector<double> numbers;
    const char* at = text.data();
    const char* const end = at + text.size();
    while (true) {
        while (at < end && std::strchr(" \t\r\n", *at) != nullptr) ++at;
        if (at == end) return numbers;
        if (*at == '+') ++at;
        double number = 0;
        const auto [next, error] = std::from_chars(at, end, number);
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

bool names_several_files(const std::string& name) {
    if (name.starts_with("LIST") && name.find_first_not_of(" \t0123456789", 4) == name.npos) {
        return true;
    }
    for (std::size_t at = 0; (at = name.find('%', at)) != name.npos; ++at) {
        const std::size_t letter = name.find_first_not_of("0123456789", at + 1);
        if (letter == name.npos || name[letter] != 'd') continue;
        const std::size_t last = name.find_last_not_of("-0123456789");
        if (last != name.npos && last > letter && last + 1 < name.size() && name[last] == ' ') {
            return true;
        }
    }
    return false;
}

}  // namespace palpate::io
