// Shared by all jobs of palpate-io-helper: the program, its limits, and the checks of a path before
// it starts.
#pragma once

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <system_error>

#include "io/process/helper_process.hpp"
#include "palpate/io/error.hpp"

namespace palpate::io {

inline constexpr HelperProgram io_helper{
    "palpate-io-helper", "the format's library",
    "the file may be sound all the same: convert it with another program, or export it again",
    "close other programs or use a smaller volume",
    "files of its size take less; it is most likely damaged: export it again"};

/// Bytes of a file, or of all files in a folder.
double bytes_in(const std::filesystem::path& path);

/// Enough for any sound file on a slow machine: compressed files take the longest, less than a
/// tenth of this.
struct TimeLimits {
    double wall_s, processor_s;
    TimeLimits(double asked_s, double bytes)
        : wall_s(asked_s > 0 ? asked_s : 600 + 2e-6 * bytes),
          processor_s(asked_s > 0 ? asked_s : 120 + 2e-6 * bytes) {}
};

/// What a helper may allocate before a reader knows how large the samples are [bytes]: enough for
/// all that libraries make of a header of a file of so many bytes, each of which they may keep
/// `copies` times.
inline std::uint64_t own_memory(double bytes, double copies) {
    return static_cast<std::uint64_t>(std::min(0x1p30 + copies * bytes, 0x1p60));
}

/// Checks a path without knowing the file's format. Throws InputError.
void check_readable(const std::filesystem::path& path);

/// "ball.nrrd: the helper gave no sensible answer; ...", an InputError.
[[noreturn]] void fail_without_answer(const std::filesystem::path& path);

/// What a job that read this file says. Throws InputError with the helper's words where it failed.
HelperResult result_of(const std::filesystem::path& path, const HelperJob& job);

/// What ask() returns, which runs a job and makes something of its answer. What goes wrong there is
/// an InputError that names the file.
template <class Ask>
auto asked_of_helper(const std::filesystem::path& path, Ask&& ask) {
    try {
        return ask();
    } catch (const std::system_error& e) {
        throw InputError(path.string() + ": " + e.what());
    } catch (const std::invalid_argument& e) {
        throw InputError(path.string() + ": " + e.what());
    } catch (const std::bad_optional_access&) {
        fail_without_answer(path);
    } catch (const nlohmann::json::exception&) {
        fail_without_answer(path);
    }
}

}  // namespace palpate::io
