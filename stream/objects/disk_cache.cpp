// A folder with pieces of remote stores. See the header.
#include "stream/objects/disk_cache.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <functional>
#include <vector>

#include "io/process/helper_process.hpp"
#include "io/system/leftovers.hpp"
#include "io/system/open_file.hpp"
#include "io/system/system.hpp"
#include "palpate/io/error.hpp"

namespace palpate::stream {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t name_digits = 32, folder_digits = 2;  // of FOLDER/NAME

/// The beginning of an entry. Its name and bytes follow.
struct EntryHead {
    std::array<char, 8> magic = {'p', 'a', 'l', 'p', 'c', 'a', 'c', '1'};
    std::uint64_t bytes = 0;
    std::uint32_t name_bytes = 0;
    std::uint32_t checksum = 0;  ///< of name and bytes
};

std::uint32_t checksum_of(const std::string& name, const Bytes& bytes) {
    uLong sum = crc32_z(0, reinterpret_cast<const Bytef*>(name.data()), name.size());
    sum = crc32_z(sum, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size());
    return static_cast<std::uint32_t>(sum);
}

/// FNV-1a; two of them name a file.
std::uint64_t hash_of(const std::string& text, std::uint64_t hash) {
    for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3U;
    return hash;
}

std::string hex(std::uint64_t number) {
    std::string text;
    for (int shift = 60; shift >= 0; shift -= 4) text += "0123456789abcdef"[number >> shift & 15];
    return text;
}

bool read_all(int file, void* to, std::size_t bytes, std::uint64_t at) {
    return io::read_at(file, to, bytes, at) == static_cast<std::ptrdiff_t>(bytes);
}

template <class T>
std::string_view as_text(const T* first, std::size_t count) {
    return {reinterpret_cast<const char*>(first), count * sizeof(T)};
}

/// The bytes of an open entry, or nothing if it is not whole or another's.
std::optional<Bytes> entry_of(int file, const std::string& name) {
    struct stat status {};
    EntryHead head;
    const EntryHead right;
    if (fstat(file, &status) != 0 || !read_all(file, &head, sizeof head, 0)) return std::nullopt;
    const auto size = static_cast<std::uint64_t>(status.st_size);
    if (head.magic != right.magic || head.name_bytes != name.size() || head.bytes > size ||
        size != sizeof head + head.name_bytes + head.bytes) {
        return std::nullopt;
    }
    std::string stored(head.name_bytes, '\0');
    Bytes bytes(head.bytes);
    if (!read_all(file, stored.data(), stored.size(), sizeof head) ||
        !read_all(file, bytes.data(), bytes.size(), sizeof head + stored.size()) ||
        stored != name || checksum_of(name, bytes) != head.checksum) {
        return std::nullopt;
    }
    return bytes;
}

int new_file(const fs::path& path) {
    return ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, S_IRUSR | S_IWUSR);
}

struct Entry {
    fs::path path;
    fs::file_time_type used;
    std::uint64_t bytes;
};

bool is_hexadecimal(const std::string& name, std::size_t digits) {
    return name.size() == digits && name.find_first_not_of("0123456789abcdef") == std::string::npos;
}

/// Entries in the cache's folder, not all of them if it is stopped. Only files with the place and
/// name of an entry count, because others are not ours.
struct Scan {
    std::stop_token stop;
    std::vector<Entry> entries = {};
    std::set<fs::path> unread = {};  ///< folders of which not all could be read
    fs::file_time_type now = fs::file_time_type::clock::now();

    void add(const fs::directory_entry& file) {
        std::error_code error;
        if (!is_hexadecimal(file.path().filename().string(), name_digits - folder_digits) ||
            !fs::is_regular_file(file.symlink_status(error))) {
            return;
        }
        const auto used = file.last_write_time(error);
        const auto bytes = error ? 0 : file.file_size(error);
        if (error) return;
        // The clock was set back. Without this, such entries would outlive all that is used now.
        const bool of_the_future = used > now + std::chrono::seconds(2);
        entries.push_back({file.path(), of_the_future ? fs::file_time_type::min() : used, bytes});
    }

    /// `take` is called with each file in a folder that can be read.
    void read(const fs::path& folder, const std::function<void(const fs::directory_entry&)>& take) {
        std::error_code error;
        for (fs::directory_iterator file(folder, error), end;
             !error && file != end && !stop.stop_requested(); file.increment(error)) {
            take(*file);
        }
        if (error && error != std::errc::no_such_file_or_directory) unread.insert(folder);
    }

    Scan(const fs::path& cache, std::stop_token until) : stop(std::move(until)) {
        read(cache, [&](const fs::directory_entry& folder) {
            std::error_code error;
            if (is_hexadecimal(folder.path().filename().string(), folder_digits) &&
                fs::is_directory(folder.symlink_status(error))) {
                read(folder.path(), [&](const fs::directory_entry& file) { add(file); });
            }
        });
    }
};

/// After a power cut, a file may have its name and size without its bytes. Nothing but zeros is
/// nobody's data.
bool is_without_bytes(int file) {
    std::array<char, 4096> part{};
    for (std::uint64_t at = 0;; at += part.size()) {
        const std::ptrdiff_t got = io::read_at(file, part.data(), part.size(), at);
        if (got < 0 || std::any_of(part.begin(), part.begin() + got, [](char c) { return c != 0; }))
            return false;
        if (got < std::ssize(part)) return true;
    }
}

/// Removes an entry, unless it does not begin as one does.
void remove_entry(const fs::path& path) {
    const io::Descriptor file(io::open_file_in(AT_FDCWD, path.string()));
    if (file.number() < 0) return;
    EntryHead head;
    const bool is_own = read_all(file.number(), &head.magic, sizeof head.magic, 0) &&
                        head.magic == EntryHead{}.magic;
    if (is_own || is_without_bytes(file.number())) ::unlink(path.c_str());
}

}  // namespace

DiskCache::DiskCache(fs::path folder, std::uint64_t most_bytes)
    : folder_(std::move(folder)), most_(most_bytes) {
    std::error_code error;
    fs::create_directories(folder_, error);
    if (!error) io::remove_leftovers(folder_);
    const fs::path probe = io::temporary_in(folder_);
    if (io::Descriptor(new_file(probe)).number() < 0) {
        problem_ = "nothing is kept in the cache " + folder_.string() + " (" + io::reason(errno) +
                   "); choose a folder that you may write to";
    } else {
        ::unlink(probe.c_str());
        begin();
    }
}

/// What an earlier process with a higher limit left is removed now. The first put() counts anew,
/// because other processes may add entries until then.
void DiskCache::begin() {
    try {
        at_start_.emplace(1, [this](const std::stop_token& stop) {
            try {
                const std::lock_guard lock(mutex_);
                if (!known_) count(0, stop);
            } catch (const std::exception&) {  // no memory: the first put() does the same
            }
        });
    } catch (const std::system_error&) {  // no thread: the same
    }
}

fs::path DiskCache::path_of(const std::string& name) const {
    const std::string text =
        hex(hash_of(name, 0xcbf29ce484222325U)) + hex(hash_of(name, 0x9e3779b97f4a7c15U));
    return folder_ / text.substr(0, folder_digits) / text.substr(folder_digits);
}

std::optional<Bytes> DiskCache::find(const std::string& name) const noexcept {
    try {
        const fs::path path = path_of(name);
        const io::Descriptor file(io::open_file_in(AT_FDCWD, path.string()));
        if (file.number() < 0) return std::nullopt;
        auto bytes = entry_of(file.number(), name);
        if (bytes) {
            futimens(file.number(), nullptr);  // used now
        } else {
            remove_entry(path);
        }
        return bytes;
    } catch (const std::exception&) {
        return std::nullopt;
    }
}

void DiskCache::put(const std::string& name, const Bytes& bytes) const noexcept {
    if (bytes.size() > most_ / 8) return;
    try {
        if (make_room(path_of(name).parent_path(), bytes.size())) write(name, bytes);
    } catch (const std::exception&) {  // then it is not kept
    }
}

void DiskCache::write(const std::string& name, const Bytes& bytes) const {
    const fs::path path = path_of(name);
    std::error_code error;
    fs::create_directories(path.parent_path(), error);
    const fs::path made = io::temporary_in(folder_);
    const io::Descriptor file(new_file(made));
    if (file.number() < 0) return;
    const fs::path temporary = io::signed_temporary(made);
    EntryHead head;
    head.bytes = bytes.size();
    head.name_bytes = static_cast<std::uint32_t>(name.size());
    head.checksum = checksum_of(name, bytes);
    const bool whole = io::write_all(file.number(), as_text(&head, 1)) &&
                       io::write_all(file.number(), name) &&
                       io::write_all(file.number(), as_text(bytes.data(), bytes.size()));
    // Not synced, which would take longer than the request did: find() knows a whole entry by its
    // checksum.
    if (whole) fs::rename(temporary, path, error);
    if (!whole || error) ::unlink(temporary.c_str());
}

/// Another process may add a sixteenth of the limit before this one sees it, so two stay below it.
/// False for a folder that could not be read. It counts with what was known of it and gets no more,
/// because nothing in it can be removed.
bool DiskCache::make_room(const fs::path& folder, std::uint64_t bytes) const {
    const std::lock_guard lock(mutex_);
    if (!known_ || added_ > most_ / 16 || counted_ + added_ + bytes > full()) {
        count(bytes, {});
        known_ = true;
    }
    const std::uint64_t whole = bytes + sizeof(EntryHead) + 256;
    added_ += whole;
    if (unread_.contains(folder_) || unread_.contains(folder)) return false;
    held_[folder] += whole;
    return true;
}

/// Needs the lock. Counts the entries, and removes the oldest ones where so many bytes more would
/// be too many.
void DiskCache::count(std::uint64_t bytes, const std::stop_token& stop) const {
    Scan scan(folder_, stop);
    std::map<fs::path, std::uint64_t> held;
    for (const fs::path& unread : scan.unread) held[unread] = held_[unread];
    for (const Entry& entry : scan.entries) {
        const fs::path in = entry.path.parent_path();
        if (!scan.unread.contains(in)) held[in] += entry.bytes;
    }
    counted_ = 0;
    for (const auto& [in, all] : held) counted_ += all;
    held_ = std::move(held);
    if (counted_ + bytes > full()) {
        std::ranges::sort(scan.entries, {}, &Entry::used);
        for (const Entry& entry : scan.entries) {
            if (counted_ + bytes <= most_ - most_ / 8 || stop.stop_requested()) break;
            remove_entry(entry.path);
            counted_ -= entry.bytes;
        }
    }
    unread_ = std::move(scan.unread);
    added_ = 0;
}

}  // namespace palpate::stream
