// The volume that comes with Palpate: the head of a person, a CT scan of the Visible Human Project.
// What it is and whom to credit: data/README.md.
#pragma once

#include <filesystem>

namespace palpate::io {

/// Levels of its two surfaces [data units].
inline constexpr double sample_volume_skin = 35;
inline constexpr double sample_volume_bone = 100;

/// Where the file is: in the installed prefix that the running program belongs to, in the source
/// tree it was built from, or where this library was installed. Throws InputError if it is in none.
std::filesystem::path sample_volume_path();

}  // namespace palpate::io
