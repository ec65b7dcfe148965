// Output files that are complete or absent: written beside the target under a temporary name and
// renamed when complete. Every writer of the project uses this. POSIX.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "palpate/io/error.hpp"

namespace palpate::io {

/// The program that reads standard output has ended, for example `head`.
class ReaderGone : public OutputError {
    using OutputError::OutputError;
};

/// A signal arrived during the wait for the reader of a pipe, to open it or to read on.
class WaitEnded : public OutputError {
    using OutputError::OutputError;
};

/// Throws OutputError if a file cannot be written here: no such folder, no permission, a folder has
/// its name, or no files can be made in its folder, as in /proc. It leaves nothing behind, so a
/// long run can begin with this check. PendingFile does it, too.
void check_output(const std::filesystem::path& path);

/// True for two names of one file, through links and relative paths. Neither need exist. Devices
/// and pipes are never the same: they can be shared.
bool is_same_file(const std::filesystem::path& a, const std::filesystem::path& b);

/// "a.zarr/" is "a.zarr": the slash that completion puts after a folder.
inline std::filesystem::path without_slash(const std::filesystem::path& path) {
    return path.has_filename() ? path : path.parent_path();
}

/// A file being written: `.palpate-PID-N-INODE.part` beside the target. Files and folders of this
/// kind that killed processes have left in the folder are removed when a process opens its first
/// file there. Without commit() the target stays unchanged and nothing is left behind. A target
/// that exists and is not a regular file (/dev/stdout, a pipe, /dev/full) and "-", the standard
/// output, are written directly instead: they cannot be replaced, and their reader is waiting. A
/// reader that has not opened a pipe, or does not read on, is waited for, and a signal ends that
/// (WaitEnded). A symbolic link is followed. Everything here throws OutputError.
class PendingFile {
  public:
    /// Opens the temporary file, so that errors are known before the work is done.
    explicit PendingFile(const std::filesystem::path& target);
    ~PendingFile();
    PendingFile(const PendingFile&) = delete;
    PendingFile& operator=(const PendingFile&) = delete;

    /// Appends; buffered.
    void write(std::string_view bytes);
    /// Flushes to the disk and puts the file in its target's place. Nothing can be written after.
    void commit();
    /// The same for several outputs of one run: all appear, or none. After an error, each target
    /// has its previous content again, except for streams. All files are closed then.
    static void commit_together(const std::vector<PendingFile*>& files);

  private:
    void open_temporary();
    void flush();
    void complete();
    void put_in_place(bool for_good);
    void take_back() noexcept;
    void keep() noexcept;
    [[noreturn]] void fail(const std::string& problem);
    [[noreturn]] void fail_to_write(int error);
    void discard() noexcept;

    std::filesystem::path target_;
    std::filesystem::path temporary_;  // empty where the target is written directly
    bool in_place_ = false;  // temporary_ then holds the previous content of the target, if any
    int descriptor_ = -1;
    int lock_ = -1;  // held until the file is in place, so that other processes do not remove the
                     // temporary file
    std::string buffer_;
};

/// A file with these bytes, whole or not at all: a PendingFile in one go.
void write_file(const std::filesystem::path& path, std::string_view bytes);

}  // namespace palpate::io
