// Puts a complete file in its place, in an order in which a power cut does no harm.
#include <unistd.h>

#include <cerrno>
#include <filesystem>

#include "io/system/system.hpp"

namespace palpate::io {

bool replace_synced(const std::filesystem::path& from, const std::filesystem::path& to) {
    const int file = open_to_read(from);
    if (file < 0) return false;
    const bool is_stored = synchronise(file);
    const int problem = errno;
    ::close(file);  // Windows renames no open file
    errno = problem;
    if (!is_stored || !replace(from, to)) return false;
    synchronise_folder(to.has_parent_path() ? to.parent_path() : ".");
    return true;
}

}  // namespace palpate::io
