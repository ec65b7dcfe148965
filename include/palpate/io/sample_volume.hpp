// The volume that comes with Palpate: the head of a person, a CT scan of the Visible Human Project.
// data/README.md describes it and its origin.
#pragma once

#include <filesystem>

namespace palpate::io {

/// Levels of its two surfaces [data units].
inline constexpr double sample_volume_skin = 35;
inline constexpr double sample_volume_bone = 100;

/// Finds the file in the installed prefix of the running program, in the source tree that it was
/// built from, or in the prefix of this library. Throws InputError if it is in none of them.
std::filesystem::path sample_volume_path();

}  // namespace palpate::io
