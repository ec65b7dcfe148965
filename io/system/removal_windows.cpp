// Removes files and folders. See removal.hpp. Windows.
#include <system_error>

#include "io/system/removal.hpp"

namespace palpate::io {

bool remove_tree(const std::filesystem::path& path) noexcept {
    std::error_code error;
    std::filesystem::remove_all(path, error);  // links in it go, not their ends
    return !error;
}

}  // namespace palpate::io
