// Opens TIFF files and keeps libtiff's errors. See the header.
#include "io/helper/tiff_library.hpp"

#include <algorithm>
#include <cstdarg>
#include <cstdio>
#include <cstring>

#include "io/helper/far_file.hpp"

namespace palpate::io {
namespace {

std::string first_error;
bool guessed_lengths = false;

extern "C" void keep_error(const char*, const char* format, va_list arguments) {
    if (!first_error.empty()) return;
    char text[200];
    std::vsnprintf(text, sizeof text, format, arguments);
    first_error = text;
}

/// Most warnings are about unknown tags.
extern "C" void keep_warning(const char*, const char* format, va_list) {
    guessed_lengths = guessed_lengths || std::strstr(format, "StripByteCounts") != nullptr;
}

/// The place at which libtiff reads next.
struct Reading {
    std::uint64_t at = 0;
};

tmsize_t read_part(thandle_t of, void* to, tmsize_t size) {
    auto& at = static_cast<Reading*>(of)->at;
    const std::uint64_t rest = far_size() - std::min(at, far_size());
    const std::uint64_t count = std::min(static_cast<std::uint64_t>(size), rest);
    if (!read_far(at, {static_cast<std::byte*>(to), count})) return 0;
    at += count;
    return static_cast<tmsize_t>(count);
}
tmsize_t refuse_to_write(thandle_t, void*, tmsize_t) {
    return 0;
}
toff_t go_to(thandle_t of, toff_t offset, int from) {
    auto& at = static_cast<Reading*>(of)->at;
    at = offset + (from == SEEK_SET ? 0 : from == SEEK_CUR ? at : far_size());
    return at;
}
int end_reading(thandle_t of) {
    delete static_cast<Reading*>(of);
    return 0;
}
toff_t size_of_far(thandle_t) {
    return far_size();
}

Tiff open_far(const std::filesystem::path& file, const char* mode) {
    auto reading = std::make_unique<Reading>();
    Tiff tiff(TIFFClientOpen(file.c_str(), mode, reading.get(), read_part, refuse_to_write, go_to,
                             end_reading, size_of_far, nullptr, nullptr),
              &TIFFClose);
    if (tiff) (void)reading.release();
    return tiff;
}

}  // namespace

Tiff open_tiff(const std::filesystem::path& file, const char* mode) {
    first_error.clear();
    guessed_lengths = false;
    TIFFSetErrorHandler(keep_error);
    TIFFSetWarningHandler(keep_warning);
    if (is_far()) return open_far(file, mode);
    return {TIFFOpen(file.c_str(), mode), &TIFFClose};
}

const std::string& first_tiff_error() {
    return first_error;
}

bool guessed_tiff_lengths() {
    return guessed_lengths;
}

}  // namespace palpate::io
