// Looks for helper folders relative to files that run, so that an installed prefix can be moved.
#include "io/process/helper_folders.hpp"

#include <dlfcn.h>
#include <link.h>

#include <algorithm>
#include <system_error>

/// Defined in programs that link this library as a static one (cmake/helper_folder.cpp.in).
extern "C" __attribute__((weak)) const char* palpate_helper_folder();

namespace palpate::io {
namespace {

namespace fs = std::filesystem;

const char in_this_library = 0;

fs::path program_folder() {
    std::error_code error;
    return fs::read_symlink("/proc/self/exe", error).parent_path();
}

/// The folder of the shared library that holds this code; empty if it is part of the program.
fs::path shared_library_folder() {
    Dl_info info;
    link_map* map = nullptr;
    const int found =
        dladdr1(&in_this_library, &info, reinterpret_cast<void**>(&map), RTLD_DL_LINKMAP);
    if (found == 0 || !map || !map->l_name || !*map->l_name) return {};
    std::error_code error;
    return fs::canonical(map->l_name, error).parent_path();
}

}  // namespace

std::vector<fs::path> helper_folders() {
    const fs::path program = program_folder(), library = shared_library_folder();
    std::vector<fs::path> folders{program};
    if (palpate_helper_folder) folders.emplace_back(palpate_helper_folder());
    if (library.empty()) {
        folders.push_back(program / PALPATE_LIBEXEC_FROM_BIN);
        folders.push_back(program / "../../libexec/palpate");  // programs in a build tree
        folders.push_back(program / "../../../libexec/palpate");
    } else {
        folders.push_back(library / PALPATE_LIBEXEC_FROM_LIB);
        folders.push_back(library / "../libexec/palpate");  // a library in a build tree
    }
    folders.emplace_back(PALPATE_LIBEXEC);
    std::vector<fs::path> once;
    for (const fs::path& folder : folders) {
        const fs::path plain = folder.lexically_normal();
        if (std::find(once.begin(), once.end(), plain) == once.end()) once.push_back(plain);
    }
    return once;
}

}  // namespace palpate::io
