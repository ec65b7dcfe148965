// Finds the data that come with Palpate by their place relative to the helper programs.
#include "io/bundled.hpp"

#include <system_error>

#include "io/process/helper_folders.hpp"

namespace palpate::io {

std::optional<std::filesystem::path> bundled(const std::string& name) {
    std::error_code error;
    for (const auto& folder : helper_folders()) {
        auto found = (folder / PALPATE_DATA_FROM_LIBEXEC / name).lexically_normal();
        if (std::filesystem::exists(found, error)) return found;
    }
    return std::nullopt;
}

}  // namespace palpate::io
