// Is there as much data as the header says? Shared by the checks of every format.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <fstream>

#include "io/helper/headers.hpp"
#include "io/inflate.hpp"

namespace palpate::io {
namespace {

constexpr std::uint64_t padding_allowed = 4096;

/// How many numbers a text file has after `offset`.
std::uint64_t count_numbers(const DataPlace& place) {
    std::ifstream in(place.file, std::ios::binary);
    in.seekg(static_cast<std::streamoff>(place.offset));
    std::uint64_t count = 0;
    double number = 0;
    while (in >> number) ++count;
    if (!in.eof()) {
        throw Failure("its data are not all numbers (after " + std::to_string(count) +
                      "); the file is damaged: export it again");
    }
    return count;
}

void compare(std::uint64_t have, std::uint64_t need, const std::string& what,
             std::vector<std::string>& notes) {
    const std::string numbers = "its header asks for " + std::to_string(need) + " " + what +
                                ", there are " + std::to_string(have);
    if (have < need) throw Failure(numbers + "; it is cut off: copy or download it again");
    if (have - need > padding_allowed) {
        throw Failure(numbers + "; correct the sizes or the type in its header");
    }
    if (have > need) notes.push_back(numbers + "; the rest was ignored");
}

}  // namespace

void check_data(const DataPlace& place, std::uint64_t bytes, std::uint64_t count,
                std::vector<std::string>& notes) {
    std::error_code error;
    const std::uint64_t file_bytes = std::filesystem::file_size(place.file, error);
    if (error) {
        throw Failure("its data file '" + place.file.filename().string() + "' cannot be read (" +
                      error.message() + "); put it beside the header");
    }
    const std::uint64_t after = file_bytes - std::min(place.offset, file_bytes);
    switch (place.encoding) {
        case DataPlace::Encoding::text:
            return compare(count_numbers(place), count, "numbers", notes);
        case DataPlace::Encoding::raw:
            return compare(after - std::min(place.skip, after), bytes, "bytes of samples", notes);
        case DataPlace::Encoding::compressed:
            break;
    }
    if (place.length != UINT64_MAX) compare(after, place.length, "compressed bytes", notes);
    std::uint64_t unpacked = 0;
    try {
        const std::uint64_t at_most = place.skip + bytes + padding_allowed;
        unpacked = inflate_checked(place.file, {place.offset, place.length, at_most}, {});
    } catch (const DamagedStream& e) {
        throw Failure(std::string(e.what()) + "; copy or download it again");
    }
    compare(unpacked - std::min(place.skip, unpacked), bytes, "bytes of samples", notes);
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

void check_spacing(double spacing, const std::string& field) {
    if (std::isfinite(spacing) && spacing > 0) return;
    throw Failure("its header field '" + field + "' gives a spacing of " + text_of(spacing) +
                  " mm; correct the header, spacings are above 0");
}

}  // namespace palpate::io
