// Finds the volume that comes with Palpate.
#include "palpate/io/sample_volume.hpp"

#include <string>
#include <system_error>

#include "io/helper_folders.hpp"
#include "palpate/io/error.hpp"

namespace palpate::io {

std::filesystem::path sample_volume_path() {
    const char* const name = "visible_human_head.nrrd";
    std::error_code error;
    for (const auto& folder : helper_folders()) {
        const auto file = (folder / PALPATE_DATA_FROM_LIBEXEC / name).lexically_normal();
        if (std::filesystem::is_regular_file(file, error)) return file;
    }
    throw InputError(std::string(name) +
                     ": the sample volume was not found; reinstall Palpate, or name a volume");
}

}  // namespace palpate::io
