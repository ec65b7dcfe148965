// Requests of io to the operating system beyond the standard library: memory, permissions, files by
// descriptor. system.cpp for Linux, system_windows.cpp for Windows. Errors are left in errno.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

namespace palpate::io {

/// [bytes]
std::uint64_t machine_memory();
/// [bytes] That this process has in memory; 0 where the system does not say.
std::uint64_t resident_memory();

/// From now on, large blocks of memory go back to the system when they are freed, whatever lies
/// behind them. (glibc would raise its limit as they are freed, and keep later ones.)
void return_large_blocks();

/// Memory that is zero, returned to the system as soon as nobody holds it. Throws std::bad_alloc.
std::shared_ptr<std::byte> fresh_memory(std::size_t bytes);

/// 0 if this user may read the file or list the folder, otherwise the error number.
int why_unreadable(const std::filesystem::path& path, bool folder);
/// The same for writing a file.
int why_unwritable(const std::filesystem::path& path);

/// Whether an error of writing says that there is no room: the disk, a quota, a limit.
bool means_full(int error) noexcept;

/// Gives a file the mode of one that it replaces. A file system without modes refuses that, and is
/// not asked where both are alike.
bool give_mode(const std::filesystem::path& file, std::filesystem::perms mode);

// Descriptors; below 0 where one cannot be opened.

/// A regular file. A pipe or a device holds nobody up: errno is EISDIR for a folder, ENXIO for all
/// else that is no file. Everything that is not meant for streams opens files by this.
int open_to_read(const std::filesystem::path& path);
/// A file that is there, or a stream. A pipe is waited for until it has a reader, or until a signal
/// comes to this thread. Then it throws WaitEnded. Meanwhile `wait`, which may throw, is called
/// twenty times a second.
int open_to_write(const std::filesystem::path& path, const std::function<void()>& wait = {});
/// A descriptor of its own.
int open_standard_output();
/// Of a file that is not there yet.
int create_to_write(const std::filesystem::path& path);

/// How many bytes were read from a place of a file, fewer only at its end; below 0 on an error.
std::ptrdiff_t read_at(int descriptor, void* to, std::size_t bytes, std::uint64_t at);
/// Changes when a file is replaced or written: its number, size and time.
std::string identity_of(int descriptor);
/// Writes them all, where a file or stream is written next. A signal to this thread ends the wait
/// for the reader of a stream: errno is EINTR. Meanwhile `wait`, which may throw, is called twenty
/// times a second.
bool write_all(int descriptor, std::string_view bytes, const std::function<void()>& wait = {});
/// The content of a file that is open to be written to the disk. File systems without this say so;
/// that is no loss of data.
bool synchronise(int descriptor);
/// The same for a file that this process need not be able to write.
bool synchronise_file(const std::filesystem::path& path);
/// The same for an open folder and all below it (or more: the whole file system).
bool synchronise_all(int folder);
bool truncate(int descriptor, std::int64_t bytes);

/// Renames `from` to `to`, in place of what was there.
bool replace(const std::filesystem::path& from, const std::filesystem::path& to);
/// The same for a complete file. It is synced first, so that a power cut never leaves a part of it
/// under that name, and then the folder.
bool replace_synced(const std::filesystem::path& from, const std::filesystem::path& to);
/// Renames `from` to `to` if nothing is there; else errno is EEXIST.
bool rename_new(const std::filesystem::path& from, const std::filesystem::path& to);
/// What had one name gets the other; false also where that cannot be done.
bool exchange(const std::filesystem::path& one, const std::filesystem::path& other);
/// So that the names in a folder survive a power cut.
void synchronise_folder(const std::filesystem::path& folder);

}  // namespace palpate::io
