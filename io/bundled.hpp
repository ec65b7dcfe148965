// Files that come with Palpate: a sample volume, sets of layers.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace palpate::io {

/// A file or folder of those that come with Palpate; none if it is not there.
std::optional<std::filesystem::path> bundled(const std::string& name);

}  // namespace palpate::io
