// Locks temporary files and folders; see leftovers.hpp. By itself, because helper programs need it.
#include <fcntl.h>
#include <sys/file.h>

#include "io/leftovers.hpp"

namespace palpate::io {

int lock_temporary(const std::filesystem::path& path) {
    const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW);
    if (descriptor >= 0) (void)::flock(descriptor, LOCK_EX | LOCK_NB);
    return descriptor;
}

}  // namespace palpate::io
