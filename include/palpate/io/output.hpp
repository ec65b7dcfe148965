// Output files that are complete or absent: written beside the target under a temporary name and
// renamed when complete. Every writer of the project uses this. POSIX.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "palpate/io/error.hpp"

namespace palpate::io {

/// A file being written. Without commit() the target stays unchanged and nothing is left behind.
/// A target that exists and is not a regular file (/dev/stdout, a pipe, /dev/full) and "-", the
/// standard output, are written directly instead: they cannot be replaced, and their reader is
/// waiting. A symbolic link is followed. Everything here throws OutputError.
class PendingFile {
  public:
    /// Opens the temporary file, so what cannot be written is known before the work is done.
    explicit PendingFile(const std::filesystem::path& target);
    ~PendingFile();
    PendingFile(const PendingFile&) = delete;
    PendingFile& operator=(const PendingFile&) = delete;

    /// Appends; buffered.
    void write(std::string_view bytes);
    /// Flushes to the disk and puts the file in its target's place. Nothing can be written after.
    void commit();

  private:
    void open_temporary();
    void flush();
    [[noreturn]] void fail(const std::string& problem);
    void discard() noexcept;

    std::filesystem::path target_;
    std::filesystem::path temporary_;  // empty where the target is written directly
    int descriptor_ = -1;
    std::string buffer_;
};

}  // namespace palpate::io
