// Opens TIFF files and keeps libtiff's errors; see the header.
#include "io/helper/tiff_library.hpp"

#include <cstdarg>
#include <cstdio>

namespace palpate::io {
namespace {

std::string first_error;

extern "C" void keep_error(const char*, const char* format, va_list arguments) {
    if (!first_error.empty()) return;
    char text[200];
    std::vsnprintf(text, sizeof text, format, arguments);
    first_error = text;
}

}  // namespace

Tiff open_tiff(const std::filesystem::path& file, const char* mode) {
    TIFFSetErrorHandler(keep_error);
    TIFFSetWarningHandler(nullptr);
    return {TIFFOpen(file.c_str(), mode), &TIFFClose};
}

const std::string& first_tiff_error() {
    return first_error;
}

}  // namespace palpate::io
