// A folder with pieces of remote stores: bounded, safe for several processes and for kills at any
// time. Nothing here throws: a cache that does not work is empty. Private to stream/.
#pragma once

#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <string>

#include "stream/objects/objects.hpp"
#include "stream/small_threads.hpp"

namespace palpate::stream {

/// An entry is a file with its name, its bytes and their checksum, written under another name and
/// then renamed. It is not synced: after a power cut its bytes may be missing, which the checksum
/// tells each time it is read. A damaged one is removed when it is met. When the folder is nearly
/// full, those that were not used for the longest time go. Other files in the folder are left
/// alone, except for files in an entry's place that hold nothing but zeros.
class DiskCache {
  public:
    /// If the folder has more than `most_bytes`, a thread removes the oldest entries.
    DiskCache(std::filesystem::path folder, std::uint64_t most_bytes);

    /// Why nothing is kept, in a sentence; empty if files can be made in the folder.
    const std::string& problem() const { return problem_; }
    std::optional<Bytes> find(const std::string& name) const noexcept;
    void put(const std::string& name, const Bytes& bytes) const noexcept;

  private:
    void begin();
    std::filesystem::path path_of(const std::string& name) const;
    void write(const std::string& name, const Bytes& bytes) const;
    bool make_room(const std::filesystem::path& folder, std::uint64_t bytes) const;
    void count(std::uint64_t bytes, const std::stop_token& stop) const;
    /// Bytes from which on the oldest entries go.
    std::uint64_t full() const { return most_ - most_ / 16; }

    std::filesystem::path folder_;
    std::uint64_t most_;
    std::string problem_;
    mutable std::mutex mutex_;
    mutable std::uint64_t counted_ = 0;  ///< bytes when last counted
    mutable std::uint64_t added_ = 0;    ///< bytes since then, by this process
    mutable bool known_ = false;         ///< false: not yet counted
    mutable std::map<std::filesystem::path, std::uint64_t> held_;  ///< bytes in each folder
    mutable std::set<std::filesystem::path> unread_;  ///< folders that could not be read
    std::optional<SmallThreads> at_start_;            ///< last: it uses all of the above
};

}  // namespace palpate::stream
