// Requests of io to the operating system. See system.hpp. Windows, where files are opened for
// bytes, not for text.
#include <windows.h>
// After it:
#include <psapi.h>

#include <fcntl.h>
#include <io.h>
#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <new>
#include <system_error>

#include "io/system/system.hpp"

namespace palpate::io {
namespace {

constexpr int as_bytes = _O_BINARY | _O_NOINHERIT;

int opened(const std::filesystem::path& path, int flags) {
    return ::_wopen(path.c_str(), flags | as_bytes, _S_IREAD | _S_IWRITE);
}

/// The nearest number of <cerrno>.
int number_of(DWORD error) {
    switch (error) {
        case ERROR_FILE_NOT_FOUND:
        case ERROR_PATH_NOT_FOUND:
            return ENOENT;
        case ERROR_ACCESS_DENIED:
        case ERROR_SHARING_VIOLATION:
        case ERROR_WRITE_PROTECT:
            return EACCES;
        case ERROR_ALREADY_EXISTS:
        case ERROR_FILE_EXISTS:
            return EEXIST;
        case ERROR_DISK_FULL:
        case ERROR_HANDLE_DISK_FULL:
            return ENOSPC;
        default:
            return EIO;
    }
}

/// As many bytes as are read or written at a time.
unsigned part_of(std::size_t bytes) {
    return static_cast<unsigned>(std::min<std::size_t>(bytes, 1 << 30));
}

bool done(BOOL result) {
    if (!result) errno = number_of(::GetLastError());
    return result != 0;
}

}  // namespace

std::uint64_t resident_memory() {
    PROCESS_MEMORY_COUNTERS counters{};
    counters.cb = sizeof counters;
    if (!K32GetProcessMemoryInfo(GetCurrentProcess(), &counters, sizeof counters)) return 0;
    return counters.WorkingSetSize;
}

std::uint64_t machine_memory() {
    MEMORYSTATUSEX status{};
    status.dwLength = sizeof status;
    return ::GlobalMemoryStatusEx(&status) ? status.ullTotalPhys : UINT64_MAX;
}

void return_large_blocks() {}  // as always

std::shared_ptr<std::byte> fresh_memory(std::size_t bytes) {
    void* at = ::VirtualAlloc(nullptr, bytes, MEM_RESERVE | MEM_COMMIT, PAGE_READWRITE);
    if (!at) throw std::bad_alloc();
    return {static_cast<std::byte*>(at),
            [](std::byte* memory) { ::VirtualFree(memory, 0, MEM_RELEASE); }};
}

int why_unreadable(const std::filesystem::path& path, bool) {
    constexpr int for_reading = 4;
    return ::_waccess(path.c_str(), for_reading) == 0 ? 0 : errno;
}

int why_unwritable(const std::filesystem::path& path) {
    constexpr int for_writing = 2;
    return ::_waccess(path.c_str(), for_writing) == 0 ? 0 : errno;
}

bool give_mode(const std::filesystem::path& file, std::filesystem::perms mode) {
    std::error_code error;
    std::filesystem::permissions(file, mode, error);
    errno = error.value();
    return !error;
}

bool means_full(int error) noexcept {
    return error == ENOSPC || error == EFBIG;
}

int open_to_read(const std::filesystem::path& path) {
    return opened(path, _O_RDONLY);
}

int open_to_write(const std::filesystem::path& path, const std::function<void()>&) {
    return opened(path, _O_WRONLY);
}

int open_standard_output() {
    constexpr int standard_output = 1;
    const int descriptor = ::_dup(standard_output);
    if (descriptor >= 0) ::_setmode(descriptor, _O_BINARY);
    return descriptor;
}

int create_to_write(const std::filesystem::path& path) {
    return opened(path, _O_WRONLY | _O_CREAT | _O_EXCL);
}

std::string identity_of(int descriptor) {
    struct _stat64 status {};
    if (::_fstat64(descriptor, &status) != 0) return {};
    return std::to_string(status.st_size) + ' ' + std::to_string(status.st_mtime);
}

std::ptrdiff_t read_at(int descriptor, void* to, std::size_t bytes, std::uint64_t at) {
    const auto file = reinterpret_cast<HANDLE>(::_get_osfhandle(descriptor));
    std::size_t taken = 0;
    while (taken < bytes) {
        OVERLAPPED place{};
        place.Offset = static_cast<DWORD>(at + taken);
        place.OffsetHigh = static_cast<DWORD>((at + taken) >> 32);
        DWORD got = 0;
        if (!::ReadFile(file, static_cast<std::byte*>(to) + taken, part_of(bytes - taken), &got,
                        &place)) {
            const DWORD error = ::GetLastError();
            if (error == ERROR_HANDLE_EOF) break;
            errno = number_of(error);
            return -1;
        }
        if (got == 0) break;
        taken += got;
    }
    return static_cast<std::ptrdiff_t>(taken);
}

bool write_all(int descriptor, std::string_view bytes, const std::function<void()>&) {
    while (!bytes.empty()) {
        const int put = ::_write(descriptor, bytes.data(), part_of(bytes.size()));
        if (put < 0) return false;
        bytes.remove_prefix(static_cast<std::size_t>(put));
    }
    return true;
}

/// Not by _commit(), which gives one error number for all that can be wrong.
bool synchronise(int descriptor) {
    if (::FlushFileBuffers(reinterpret_cast<HANDLE>(::_get_osfhandle(descriptor)))) return true;
    const DWORD error = ::GetLastError();
    errno = number_of(error);
    return error == ERROR_INVALID_FUNCTION || error == ERROR_NOT_SUPPORTED;
}

/// Only what is open to be written can be synced here.
bool synchronise_file(const std::filesystem::path& path) {
    const int file = opened(path, _O_RDWR);
    if (file < 0) return false;
    const bool is_stored = synchronise(file);
    const int problem = errno;
    ::_close(file);
    errno = problem;
    return is_stored;
}

/// NTFS writes its journal by itself; what a file holds is on the disk by synchronise().
bool synchronise_all(int) {
    return true;
}

bool truncate(int descriptor, std::int64_t bytes) {
    return ::_chsize_s(descriptor, bytes) == 0;
}

bool replace(const std::filesystem::path& from, const std::filesystem::path& to) {
    return done(::MoveFileExW(from.c_str(), to.c_str(), MOVEFILE_REPLACE_EXISTING));
}

bool rename_new(const std::filesystem::path& from, const std::filesystem::path& to) {
    return done(::MoveFileExW(from.c_str(), to.c_str(), 0));
}

/// By a third name; where the second step fails, the first is taken back.
bool exchange(const std::filesystem::path& one, const std::filesystem::path& other) {
    std::filesystem::path third = one;
    third += L".old";
    if (!::MoveFileExW(other.c_str(), third.c_str(), 0)) return false;
    if (::MoveFileExW(one.c_str(), other.c_str(), 0)) {
        return ::MoveFileExW(third.c_str(), one.c_str(), 0) != 0;
    }
    ::MoveFileExW(third.c_str(), other.c_str(), 0);
    return false;
}

/// The file system's journal does that.
void synchronise_folder(const std::filesystem::path&) {}

}  // namespace palpate::io
