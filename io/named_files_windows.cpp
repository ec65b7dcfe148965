// Reads in this process which files headers name. See the header.
#include "io/named_files.hpp"

#include "io/helper/headers.hpp"

namespace palpate::io {

std::vector<std::filesystem::path> files_read_with(
    const std::vector<std::filesystem::path>& files) {
    std::vector<std::filesystem::path> found;
    for (const std::filesystem::path& file : files) {
        for (auto& named : files_read_with(file)) found.push_back(std::move(named));
    }
    return found;
}

}  // namespace palpate::io
