// Exceptions to exit status.
#include "apps/options/exit_status.hpp"

#include <cstdio>
#include <new>
#include <stdexcept>
#include <utility>

#include "palpate/devices/error.hpp"
#include "palpate/io/error.hpp"
#include "palpate/io/series.hpp"

namespace palpate::app {

namespace {

template <class E>
bool is(const std::exception& exception) {
    return dynamic_cast<const E*>(&exception) != nullptr;
}

/// A numbered line each.
std::string list_of(const std::vector<io::SeriesInfo>& series) {
    std::string text;
    for (std::size_t i = 0; i < series.size(); ++i) {
        text += "\n  " + std::to_string(i + 1) + "  " + io::text_of(series[i]);
    }
    return text;
}

}  // namespace

std::string one_line(std::string text) {
    return io::one_line(std::move(text), 5500, 500);  // a path has up to 4096 bytes
}

Failure failure_of(const std::exception& exception) {
    if (is<std::bad_alloc>(exception)) {
        return {bad_input, "not enough memory: use a smaller volume, or one of fewer bits"};
    }
    const std::string text = one_line(io::without_secrets(exception.what()));
    if (is<devices::DeviceError>(exception)) return {no_device, text};
    if (is<io::OutputError>(exception)) return {bad_output, text};
    if (is<std::invalid_argument>(exception)) return {wrong_use, text};
    if (const auto* choice = dynamic_cast<const io::SeriesChoice*>(&exception)) {
        return {bad_input, text + list_of(choice->series())};
    }
    return {bad_input, text};
}

int fail(const std::string& text, int status) {
    std::fprintf(stderr, "palpate: %s\n", io::without_secrets(text).c_str());
    return status;
}

}  // namespace palpate::app
