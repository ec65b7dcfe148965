// Puts a complete file in its place, in an order in which a power cut does no harm.
#include <filesystem>

#include "io/system/system.hpp"

namespace palpate::io {

bool replace_synced(const std::filesystem::path& from, const std::filesystem::path& to) {
    if (!synchronise_file(from) || !replace(from, to)) return false;
    synchronise_folder(to.has_parent_path() ? to.parent_path() : ".");
    return true;
}

}  // namespace palpate::io
