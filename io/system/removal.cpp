// Removes files and folders without following symbolic links. See the header. Linux: each step is
// relative to a folder that is open, so that a link that is put in its place meanwhile is harmless.
#include "io/system/removal.hpp"

#include <dirent.h>
#include <fcntl.h>
#include <linux/openat2.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <exception>
#include <memory>

#include "io/process/helper_process.hpp"

namespace palpate::io {
namespace {

constexpr int open_folder = O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC;

/// Removes a name in `folder`; mount points stay.
bool remove_from(int folder, const std::string& name) {
    if (::unlinkat(folder, name.c_str(), 0) == 0 || errno == ENOENT) return true;
    if (errno != EISDIR && errno != EPERM) return false;
    const Descriptor inner(open_inner(folder, name));
    if (inner.number() < 0) return false;
    bool all = true;
    for (const std::string& each : names_in(inner.number())) {
        all = remove_from(inner.number(), each) && all;
    }
    return all && ::unlinkat(folder, name.c_str(), AT_REMOVEDIR) == 0;
}

}  // namespace

int open_inner(int folder, const std::string& name) {
    open_how how{};
    how.flags = open_folder;
    how.resolve = RESOLVE_BENEATH | RESOLVE_NO_SYMLINKS | RESOLVE_NO_XDEV;
    const long opened = ::syscall(SYS_openat2, folder, name.c_str(), &how, sizeof how);
    if (opened >= 0 || (errno != ENOSYS && errno != EPERM)) return static_cast<int>(opened);
    // A kernel before 5.6, or a container that denies the call: mounts of another device show.
    const int inner = ::openat(folder, name.c_str(), open_folder);
    struct stat outside {
    }, inside{};
    if (inner < 0 || (::fstat(folder, &outside) == 0 && ::fstat(inner, &inside) == 0 &&
                      outside.st_dev == inside.st_dev)) {
        return inner;
    }
    ::close(inner);
    errno = EXDEV;
    return -1;
}

std::vector<std::string> names_in(int folder) {
    std::vector<std::string> names;
    // A descriptor of its own: fdopendir() takes the one that it gets.
    const int own = ::openat(folder, ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (own < 0) return names;
    const auto close = [](DIR* list) { ::closedir(list); };
    const std::unique_ptr<DIR, decltype(close)> list(::fdopendir(own), close);
    if (!list) {
        ::close(own);
        return names;
    }
    while (const dirent* entry = ::readdir(list.get())) {
        const std::string name = entry->d_name;
        if (name != "." && name != "..") names.push_back(name);
    }
    std::ranges::sort(names);
    return names;
}

bool remove_at(int folder, const std::string& name) noexcept {
    try {
        return remove_from(folder, name);
    } catch (const std::exception&) {  // no memory for the names
        return false;
    }
}

bool remove_tree(const std::filesystem::path& path) noexcept {
    try {
        const auto parent = path.has_parent_path() ? path.parent_path() : ".";
        const Descriptor folder(::open(parent.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
        if (folder.number() < 0) return errno == ENOENT;
        return path.has_filename() && remove_at(folder.number(), path.filename().string());
    } catch (const std::exception&) {
        return false;
    }
}

}  // namespace palpate::io
