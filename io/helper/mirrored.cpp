// Reads a mirror; see the header.
#include "io/helper/mirrored.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include "io/helper/protocol.hpp"

namespace palpate::io {
namespace {

bool used = false;
std::optional<MissingPart> missing;

}  // namespace

void use_mirror() {
    used = true;
}

bool uses_mirror() {
    return used;
}

std::uint64_t mirror_size() {
    struct stat status {};
    return fstat(mirror_descriptor, &status) == 0 ? static_cast<std::uint64_t>(status.st_size) : 0;
}

bool read_mirror(std::uint64_t offset, std::span<std::byte> to) {
    if (missing) return false;  // what follows from a part that is not here is of no use
    const std::uint64_t size = mirror_size();
    if (offset > size || to.size() > size - offset) return false;
    if (to.empty()) return true;
    const auto begin = static_cast<off_t>(offset);
    const bool here =
        lseek(mirror_descriptor, begin, SEEK_DATA) == begin &&
        lseek(mirror_descriptor, begin, SEEK_HOLE) >= static_cast<off_t>(offset + to.size());
    if (!here) {
        missing = MissingPart{offset, to.size()};
        return false;
    }
    return pread(mirror_descriptor, to.data(), to.size(), begin) == static_cast<ssize_t>(to.size());
}

std::optional<MissingPart> missing_part() {
    return missing;
}

}  // namespace palpate::io
