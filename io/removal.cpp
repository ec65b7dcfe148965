// Removes files and folders without following symbolic links; see the header. Linux: each step is
// relative to a folder that is open, so that a link that is put in its place meanwhile is harmless.
#include "io/removal.hpp"

#include <dirent.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <exception>
#include <memory>

#include "io/helper_process.hpp"

namespace palpate::io {
namespace {

constexpr int open_folder = O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC;

/// Removes a name in `folder`; folders of other devices (mount points) stay.
bool remove_from(int folder, const std::string& name, dev_t device) {
    if (::unlinkat(folder, name.c_str(), 0) == 0 || errno == ENOENT) return true;
    if (errno != EISDIR && errno != EPERM) return false;
    const Descriptor inner(::openat(folder, name.c_str(), open_folder));
    struct stat about {};
    if (inner.number() < 0 || ::fstat(inner.number(), &about) != 0 || about.st_dev != device) {
        return false;
    }
    bool all = true;
    for (const std::string& each : names_in(inner.number())) {
        all = remove_from(inner.number(), each, device) && all;
    }
    return all && ::unlinkat(folder, name.c_str(), AT_REMOVEDIR) == 0;
}

}  // namespace

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
        struct stat about {};
        return ::fstat(folder, &about) == 0 && remove_from(folder, name, about.st_dev);
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
