// Removes files and folders, and tells what lies in a folder, without ever following a symbolic
// link. Private to io/, stream/ and programs.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace palpate::io {

/// Opens a folder in an open one. Below 0 for a link, a mount point, and all that is no folder.
int open_inner(int folder, const std::string& name);

/// Removes a file, a symbolic link (never what it points to), or a folder with all below it. Mount
/// points stay with all below them. False if something could not be removed; nothing there is no
/// error.
bool remove_tree(const std::filesystem::path& path) noexcept;

/// The same for a name in an open folder.
bool remove_at(int folder, const std::string& name) noexcept;

/// The names in an open folder, without "." and "..", sorted.
std::vector<std::string> names_in(int folder);

}  // namespace palpate::io
