// What every job of palpate-io-helper has in common: the program, its limits, and what can be said
// of a path before it starts.
#pragma once

#include <cstdint>
#include <filesystem>

#include "io/helper_process.hpp"

namespace palpate::io {

inline constexpr HelperProgram io_helper{
    "palpate-io-helper", "the format's library",
    "the file is damaged or not what its name says; export it again",
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

/// Checks a path without knowing the file's format. Throws InputError.
void check_readable(const std::filesystem::path& path);

/// "ball.nrrd: the helper gave no sensible answer; ...", an InputError.
[[noreturn]] void fail_without_answer(const std::filesystem::path& path);

}  // namespace palpate::io
