// Removes temporary files and folders whose process is dead. Linux.
#include "io/system/leftovers.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <csignal>
#include <mutex>
#include <set>
#include <string>
#include <system_error>

#include "io/system/number.hpp"
#include "io/system/own_names.hpp"
#include "io/system/removal.hpp"
#include "palpate/io/error.hpp"

namespace palpate::io {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view name_begin = ".palpate-", name_end = ".part";

bool only_digits(std::string_view text) {
    return !text.empty() && text.find_first_not_of("0123456789") == std::string_view::npos;
}

/// The process in ".palpate-PID-N.part", and in the names that earlier versions gave to folders,
/// ".palpate-PID.part" and ".palpate-PID-N"; 0 for any other name.
pid_t process_of(std::string_view name) {
    if (!name.starts_with(name_begin)) return 0;
    name.remove_prefix(name_begin.size());
    const bool has_end = name.ends_with(name_end);
    if (has_end) name.remove_suffix(name_end.size());
    const auto dash = name.find('-');
    const bool has_count = dash != std::string_view::npos;
    if (!has_end && !has_count) return 0;
    const std::string_view process = name.substr(0, dash);
    if (!only_digits(process) || (has_count && !only_digits(name.substr(dash + 1)))) return 0;
    return number_from<pid_t>(process).value_or(0);
}

bool is_dead(pid_t process) {
    return ::kill(process, 0) != 0 && errno == ESRCH;
}

bool is_marked(int folder) {
    struct stat about {};
    return ::fstatat(folder, temporary_marker, &about, AT_SYMLINK_NOFOLLOW) == 0 &&
           S_ISREG(about.st_mode) && about.st_uid == ::geteuid();
}

void remove_if_known(const fs::path& folder) {
    try {
        if (unknown_below(folder, OwnFolder::growing).empty()) {
            (void)remove_known(folder, OwnFolder::growing);
        }
    } catch (const OutputError&) {  // it cannot be read, so it stays
    }
}

/// A living process keeps a lock, so that one in another container counts as living, too.
void remove_one(const fs::path& path) {
    // O_NONBLOCK: a pipe of that name must not hold us up.
    const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
    if (descriptor < 0) return;
    struct stat about {};
    if (::fstat(descriptor, &about) == 0 && about.st_uid == ::geteuid() &&
        ::flock(descriptor, LOCK_EX | LOCK_NB) == 0) {
        if (S_ISREG(about.st_mode) || (S_ISDIR(about.st_mode) && is_marked(descriptor))) {
            remove_tree(path);
        } else if (S_ISDIR(about.st_mode)) {
            remove_if_known(path);
        }
    }
    ::close(descriptor);
}

/// Whether this process asks for the first time.
bool is_new(const fs::path& folder) {
    static std::mutex mutex;
    static std::set<fs::path> seen;
    std::error_code error;
    const fs::path whole = fs::canonical(folder, error);
    const std::lock_guard lock(mutex);
    return !error && seen.insert(whole).second;
}

}  // namespace

bool is_temporary(std::string_view name) {
    return process_of(name) > 0;
}

fs::path temporary_in(const fs::path& folder) {
    static std::atomic<unsigned> count = 0;
    const std::string begin = std::string(name_begin) + std::to_string(::getpid()) + "-";
    while (true) {
        const fs::path path = folder / (begin + std::to_string(count++) + std::string(name_end));
        struct stat about {};
        if (::lstat(path.c_str(), &about) != 0) return path;
    }
}

fs::path make_temporary_folder(const fs::path& folder, std::error_code& error) {
    while (true) {
        fs::path path = temporary_in(folder);
        // If the folder exists, another process has just made it, and it is not ours.
        if (fs::create_directory(path, error) || error) return path;
    }
}

int lock_temporary(const std::filesystem::path& path) {
    const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW);
    if (descriptor >= 0) (void)::flock(descriptor, LOCK_EX | LOCK_NB);
    return descriptor;
}

void remove_leftovers(const fs::path& folder) {
    if (!is_new(folder)) return;
    std::error_code error;
    for (fs::directory_iterator entry(folder, error), end; entry != end && !error;
         entry.increment(error)) {
        const pid_t process = process_of(entry->path().filename().string());
        if (process > 0 && is_dead(process)) remove_one(entry->path());
    }
}

}  // namespace palpate::io
