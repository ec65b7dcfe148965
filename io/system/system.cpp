// Requests of io to the operating system. See the header. Linux.
#include "io/system/system.hpp"

#include <fcntl.h>
#include <malloc.h>
#include <poll.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <climits>
#include <cstdio>
#include <fstream>
#include <new>
#include <span>

#include "io/system/open_file.hpp"
#include "palpate/io/output.hpp"

namespace palpate::io {

std::uint64_t resident_memory() {
    std::ifstream file("/proc/self/statm");
    std::uint64_t pages = 0, resident = 0;
    file >> pages >> resident;
    return resident * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
}

std::uint64_t machine_memory() {
    return static_cast<std::uint64_t>(sysconf(_SC_PHYS_PAGES)) *
           static_cast<std::uint64_t>(sysconf(_SC_PAGE_SIZE));
}

void return_large_blocks() {
    mallopt(M_MMAP_THRESHOLD, 128 << 10);
}

std::shared_ptr<std::byte> fresh_memory(std::size_t bytes) {
    void* at = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (at == MAP_FAILED) throw std::bad_alloc();
    return {static_cast<std::byte*>(at), [bytes](std::byte* mapped) { munmap(mapped, bytes); }};
}

int why_unreadable(const std::filesystem::path& path, bool folder) {
    return access(path.c_str(), folder ? R_OK | X_OK : R_OK) == 0 ? 0 : errno;
}

int why_unwritable(const std::filesystem::path& path) {
    return access(path.c_str(), W_OK) == 0 ? 0 : errno;
}

int open_file_in(int folder, const std::string& name, int flags) {
    // O_NONBLOCK: the opening of a pipe would wait for its writer.
    const int file =
        ::openat(folder, name.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY | flags);
    struct stat about {};
    if (file < 0 || (::fstat(file, &about) == 0 && S_ISREG(about.st_mode))) return file;
    ::close(file);
    errno = S_ISDIR(about.st_mode) ? EISDIR : ENXIO;
    return -1;
}

bool give_mode(const std::filesystem::path& file, std::filesystem::perms mode) {
    constexpr mode_t all = 07777;
    const auto wanted = static_cast<mode_t>(mode) & all;
    struct stat about {};
    return (::stat(file.c_str(), &about) == 0 && (about.st_mode & all) == wanted) ||
           ::chmod(file.c_str(), wanted) == 0;
}

bool means_full(int error) noexcept {
    return error == ENOSPC || error == EDQUOT || error == EFBIG;
}

int open_to_read(const std::filesystem::path& path) {
    return open_file_in(AT_FDCWD, path.string(), 0);
}

namespace {

/// Of something that is waited for.
constexpr timespec between_looks{0, 50'000'000};

/// While it exists, signals come to this thread in wait() only, so that none between two waits is
/// missed. They restart open() and write(), but never this wait.
class SignalsInWaits {
  public:
    SignalsInWaits() {
        sigset_t all;
        ::sigfillset(&all);
        ::pthread_sigmask(SIG_SETMASK, &all, &before_);
    }
    SignalsInWaits(const SignalsInWaits&) = delete;
    SignalsInWaits& operator=(const SignalsInWaits&) = delete;
    ~SignalsInWaits() { ::pthread_sigmask(SIG_SETMASK, &before_, nullptr); }
    /// As ppoll().
    int wait(std::span<pollfd> descriptors, const timespec* most) const {
        return ::ppoll(descriptors.data(), descriptors.size(), most, &before_);
    }
    /// Drops the signal of a reader that has gone, which would end a program that does not expect
    /// it: write() tells.
    static void drop_broken_pipe() {
        sigset_t broken;
        ::sigemptyset(&broken);
        ::sigaddset(&broken, SIGPIPE);
        constexpr timespec at_once{};
        ::sigtimedwait(&broken, nullptr, &at_once);
    }

  private:
    sigset_t before_{};
};

/// In parts that a pipe takes at once when it is ready.
bool write_to_stream(int descriptor, std::string_view bytes, const std::function<void()>& wait) {
    const SignalsInWaits signals;
    pollfd reader{descriptor, POLLOUT, 0};
    while (!bytes.empty()) {
        const int ready = signals.wait({&reader, 1}, wait ? &between_looks : nullptr);
        if (ready < 0) return false;
        if (ready == 0) {
            wait();
            continue;
        }
        const ssize_t put =
            ::write(descriptor, bytes.data(), std::min<std::size_t>(bytes.size(), PIPE_BUF));
        if (put < 0 && errno == EAGAIN) continue;
        if (put < 0 && errno == EPIPE) {
            SignalsInWaits::drop_broken_pipe();
            errno = EPIPE;
        }
        if (put < 0) return false;
        bytes.remove_prefix(static_cast<std::size_t>(put));
    }
    return true;
}

}  // namespace

int open_to_write(const std::filesystem::path& path, const std::function<void()>& wait) {
    const auto lacks_reader = [&] {
        struct stat about {};
        const bool is_pipe = errno == ENXIO && ::stat(path.c_str(), &about) == 0;
        return is_pipe && S_ISFIFO(about.st_mode);
    };
    int file = -1, problem = 0;
    {
        const SignalsInWaits signals;
        while ((file = ::open(path.c_str(), O_WRONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY)) < 0) {
            problem = errno;
            if (!lacks_reader()) break;
            if (wait) wait();
            if (signals.wait({}, &between_looks) == 0) continue;
            problem = errno;
            break;
        }
    }
    if (file >= 0) ::fcntl(file, F_SETFL, ::fcntl(file, F_GETFL) & ~O_NONBLOCK);
    if (file < 0 && problem == EINTR) {
        throw WaitEnded(path.string() +
                        ": the wait for its reader was interrupted: start the reader first");
    }
    errno = problem;
    return file;
}

int open_standard_output() {
    return ::fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, 3);
}

int create_to_write(const std::filesystem::path& path) {
    return ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
}

std::string identity_of(int descriptor) {
    struct stat status {};
    if (::fstat(descriptor, &status) != 0) return {};
    return std::to_string(status.st_ino) + ' ' + std::to_string(status.st_size) + ' ' +
           std::to_string(status.st_mtim.tv_sec) + '.' + std::to_string(status.st_mtim.tv_nsec);
}

std::ptrdiff_t read_at(int descriptor, void* to, std::size_t bytes, std::uint64_t at) {
    std::size_t done = 0;
    while (done < bytes) {
        const ssize_t got = ::pread(descriptor, static_cast<std::byte*>(to) + done, bytes - done,
                                    static_cast<off_t>(at + done));
        if (got < 0 && errno == EINTR) continue;
        if (got < 0) return -1;
        if (got == 0) break;
        done += static_cast<std::size_t>(got);
    }
    return static_cast<std::ptrdiff_t>(done);
}

bool write_all(int descriptor, std::string_view bytes, const std::function<void()>& wait) {
    struct stat about {};
    const bool is_stream = ::fstat(descriptor, &about) == 0 && !S_ISREG(about.st_mode);
    if (is_stream) return write_to_stream(descriptor, bytes, wait);
    while (!bytes.empty()) {
        const ssize_t put = ::write(descriptor, bytes.data(), bytes.size());
        if (put < 0 && errno == EINTR) continue;
        if (put < 0) return false;
        bytes.remove_prefix(static_cast<std::size_t>(put));
    }
    return true;
}

bool synchronise(int descriptor) {
    return ::fsync(descriptor) == 0 || errno == EINVAL || errno == ENOTSUP || errno == ENOSYS;
}

bool synchronise_file(const std::filesystem::path& path) {
    const int file = open_to_read(path);
    if (file < 0) return false;
    const bool is_stored = synchronise(file);
    const int problem = errno;
    ::close(file);
    errno = problem;
    return is_stored;
}

bool synchronise_all(int folder) {
    return ::syncfs(folder) == 0 || errno == ENOSYS;
}

bool truncate(int descriptor, std::int64_t bytes) {
    return ::ftruncate(descriptor, bytes) == 0;
}

bool replace(const std::filesystem::path& from, const std::filesystem::path& to) {
    return ::rename(from.c_str(), to.c_str()) == 0;
}

bool rename_new(const std::filesystem::path& from, const std::filesystem::path& to) {
    if (::renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_NOREPLACE) == 0) {
        return true;
    }
    if (errno != EINVAL && errno != ENOSYS) return false;
    struct stat about {};
    if (::lstat(to.c_str(), &about) == 0) {
        errno = EEXIST;
        return false;
    }
    return ::rename(from.c_str(), to.c_str()) == 0;  // fails for a folder that is not empty
}

bool exchange(const std::filesystem::path& one, const std::filesystem::path& other) {
    return ::renameat2(AT_FDCWD, one.c_str(), AT_FDCWD, other.c_str(), RENAME_EXCHANGE) == 0;
}

void synchronise_folder(const std::filesystem::path& folder) {
    const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (descriptor < 0) return;
    (void)synchronise(descriptor);
    ::close(descriptor);
}

}  // namespace palpate::io
