// The folders in which Palpate's helper programs may lie: in a build tree, under an installed
// prefix (moved or not), beside a program of somebody else's. docs/package.md gives the order.
#pragma once

#include <filesystem>
#include <vector>

namespace palpate::io {

/// First choice first, absolute, none twice. They need not exist.
std::vector<std::filesystem::path> helper_folders();

}  // namespace palpate::io
