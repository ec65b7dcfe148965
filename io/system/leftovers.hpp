// Temporary files and folders beside outputs: how they are called, how other processes see that
// they are in use, and how those of killed processes go. Private to io/ and programs.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string_view>
#include <system_error>

namespace palpate::io {

/// A path in `folder` for a temporary file or folder of this process, `.palpate-PID-N.part`, at
/// which there is nothing.
std::filesystem::path temporary_in(const std::filesystem::path& folder);

/// Gives a temporary file or folder that this process has just made a name that tells its inode,
/// `.palpate-PID-N-INODE.part`: the proof for remove_leftovers() that Palpate made it. Nothing that
/// is put or copied to that name has this inode. Returns the new path; the old one where that is
/// not possible, and on Windows.
std::filesystem::path signed_temporary(const std::filesystem::path& path);

/// Whether a name is such a one, of any process.
bool is_temporary(std::string_view name);

/// Whether a file or folder with such a name proves that Palpate made it: the name tells its inode,
/// or it is an empty file whose process was killed before it signed it. Linux.
bool is_own_temporary(std::string_view name, std::uint64_t inode, bool is_empty_file);

/// A file of this name and content in a folder with such a name says that Palpate made the folder.
inline constexpr const char* temporary_marker = ".palpate-temporary";
inline constexpr std::string_view temporary_marker_text =
    "Palpate made this folder for unfinished files. If its process is killed, the next one removes "
    "it with all that is in it.\n";

/// Makes a signed folder with such a name, readable as `folder` is by default; an error is left in
/// `error`.
std::filesystem::path make_temporary_folder(const std::filesystem::path& folder,
                                            std::error_code& error);

/// Why no file can be made in a folder: an error number, or 0. On Linux it tries: the user root may
/// write where no files can be made, as in /proc. Nothing with a name is left behind.
int why_no_file_in(const std::filesystem::path& folder);

/// Locks what this process has created as long as the descriptor returned is open: then a process
/// in another container or on another machine does not take it for a leftover. Below 0 where there
/// are no locks; nothing else depends on it.
int lock_temporary(const std::filesystem::path& path);

/// Removes what processes that were killed have left in `folder`: files and folders that have a
/// temporary name, belong to this user, are no symbolic links, and whose process neither lives nor
/// holds their lock. Of these, only folders with the marker, signed files, and signed folders in
/// which Palpate has written everything. What has no such proof stays. On Windows, only folders
/// with the marker. Looks into a folder once for each process; nothing is an error.
void remove_leftovers(const std::filesystem::path& folder);

}  // namespace palpate::io
