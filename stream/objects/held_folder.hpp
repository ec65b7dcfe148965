// A folder that is being written, held open: its files go there whatever happens to its name.
// Linux. Private to stream/.
#pragma once

#include <cstddef>
#include <filesystem>
#include <mutex>
#include <span>
#include <string>

#include "io/process/helper_process.hpp"

namespace palpate::stream {

/// Names are relative to the folder. All of this may be called by several threads.
class HeldFolder {
  public:
    /// Holds the folder if it is there; else it is held once it is needed. Makes nothing.
    explicit HeldFolder(std::filesystem::path path);
    ~HeldFolder();
    HeldFolder(const HeldFolder&) = delete;
    HeldFolder& operator=(const HeldFolder&) = delete;

    const std::filesystem::path& path() const { return path_; }
    /// Makes the folder if none is held. If that fails, so does put().
    void make();
    /// Writes a whole small file, and the folders on the way to it. While it is written its name
    /// ends in `temporary`. Throws io::OutputError, also if the folder has lost its name.
    void put(const std::filesystem::path& name, std::span<const std::byte> bytes,
             const std::string& temporary = ".part");
    /// A file to read, below 0 if there is none: links and pipes are none.
    io::Descriptor open(const std::filesystem::path& name);

  private:
    int held();

    std::filesystem::path path_;
    std::mutex mutex_;
    int held_ = -1;
};

/// What io::OutputError says where the folder that is written has gone.
[[noreturn]] void fail_without(const std::filesystem::path& folder);

}  // namespace palpate::stream
