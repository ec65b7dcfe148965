// Removes temporary files and folders whose process is dead. Linux.
#include "io/system/leftovers.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <mutex>
#include <set>
#include <string>
#include <system_error>
#include <vector>

#include "io/process/helper_process.hpp"
#include "io/system/number.hpp"
#include "io/system/open_file.hpp"
#include "io/system/own_names.hpp"
#include "io/system/removal.hpp"
#include "io/system/system.hpp"
#include "palpate/io/error.hpp"

namespace palpate::io {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view name_begin = ".palpate-", name_end = ".part";

bool only_digits(std::string_view text) {
    return !text.empty() && text.find_first_not_of("0123456789") == std::string_view::npos;
}

/// What the name of a temporary file or folder tells.
struct TemporaryName {
    pid_t process = 0;  ///< 0: it is no such name
    ino_t inode = 0;    ///< 0: it is not signed
};

/// In ".palpate-PID-N.part" and ".palpate-PID-N-INODE.part".
TemporaryName told_by(std::string_view name) {
    if (!name.starts_with(name_begin) || !name.ends_with(name_end)) return {};
    name.remove_prefix(name_begin.size());
    name.remove_suffix(std::min(name_end.size(), name.size()));
    std::vector<std::string_view> numbers;
    for (std::size_t at = 0; at <= name.size();) {
        const std::size_t dash = std::min(name.find('-', at), name.size());
        numbers.push_back(name.substr(at, dash - at));
        at = dash + 1;
    }
    if (numbers.size() < 2 || numbers.size() > 3) return {};
    if (!std::ranges::all_of(numbers, only_digits)) return {};
    TemporaryName told{number_from<pid_t>(numbers[0]).value_or(0)};
    if (numbers.size() == 3) told.inode = number_from<ino_t>(numbers[2]).value_or(0);
    return told;
}

bool is_dead(pid_t process) {
    return ::kill(process, 0) != 0 && errno == ESRCH;
}

bool is_marked(int folder) {
    const Descriptor file(open_file_in(folder, temporary_marker));
    struct stat about {};
    if (file.number() < 0 || ::fstat(file.number(), &about) != 0 || about.st_uid != ::geteuid()) {
        return false;
    }
    std::string text(temporary_marker_text.size() + 1, '\0');
    const auto got = read_at(file.number(), text.data(), text.size(), 0);
    return got >= 0 && text.substr(0, static_cast<std::size_t>(got)) == temporary_marker_text;
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
        const bool is_empty_file = S_ISREG(about.st_mode) && about.st_size == 0;
        const bool is_own = is_own_temporary(path.filename().native(), about.st_ino, is_empty_file);
        if ((S_ISREG(about.st_mode) && is_own) ||
            (S_ISDIR(about.st_mode) && is_marked(descriptor))) {
            remove_tree(path);
        } else if (S_ISDIR(about.st_mode) && is_own) {
            remove_if_known(path);
        } else if (S_ISDIR(about.st_mode) && told_by(path.filename().native()).inode == 0) {
            ::rmdir(path.c_str());  // made, but not yet signed: it goes only if it is empty
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
    return told_by(name).process > 0;
}

bool is_own_temporary(std::string_view name, std::uint64_t inode, bool is_empty_file) {
    const TemporaryName told = told_by(name);
    return told.process > 0 && (told.inode > 0 ? told.inode == inode : is_empty_file);
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

fs::path signed_temporary(const fs::path& path) {
    struct stat about {};
    if (::lstat(path.c_str(), &about) != 0) return path;
    fs::path to = path;
    to.replace_extension();
    to += "-" + std::to_string(about.st_ino) + std::string(name_end);
    return rename_new(path, to) ? to : path;
}

fs::path make_temporary_folder(const fs::path& folder, std::error_code& error) {
    while (true) {
        const fs::path path = temporary_in(folder);
        // If the folder exists, another process has just made it, and it is not ours.
        if (fs::create_directory(path, error)) return signed_temporary(path);
        if (error) return path;
    }
}

int why_no_file_in(const fs::path& folder) {
    if (const int problem = why_unwritable(folder)) return problem;
    const int nameless = ::open(folder.c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, 0600);
    if (nameless >= 0) {
        ::close(nameless);
        return 0;
    }
    // Not all file systems have files without a name.
    const fs::path path = temporary_in(folder);
    const int file = create_to_write(path);
    if (file < 0 && errno == EEXIST) return 0;
    if (file < 0) return errno == ENOENT ? ENOTSUP : errno;  // the folder is there
    ::close(file);
    ::unlink(path.c_str());
    return 0;
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
        const TemporaryName told = told_by(entry->path().filename().native());
        if (told.process > 0 && is_dead(told.process)) remove_one(entry->path());
    }
}

}  // namespace palpate::io
