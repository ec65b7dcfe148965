// Finds the volume that comes with Palpate.
#include "palpate/io/sample_volume.hpp"

#include <string>

#include "io/bundled.hpp"
#include "palpate/io/error.hpp"

namespace palpate::io {

std::filesystem::path sample_volume_path() {
    const char* const name = "visible_human_head.nrrd";
    if (const auto file = bundled(name)) return *file;
    throw InputError(std::string(name) +
                     ": the sample head was not found; reinstall Palpate, or name a volume");
}

}  // namespace palpate::io
