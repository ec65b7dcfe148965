// The folder of the program or the library that holds this code. See helper_folders.hpp. Windows,
// where there are no helper programs, but the data files lie where they lie elsewhere.
#include <windows.h>

#include <array>

#include "io/process/helper_folders.hpp"

namespace palpate::io {
namespace {

namespace fs = std::filesystem;

const char in_this_library = 0;

fs::path folder_of_this() {
    HMODULE here = nullptr;
    ::GetModuleHandleExW(
        GET_MODULE_HANDLE_EX_FLAG_FROM_ADDRESS | GET_MODULE_HANDLE_EX_FLAG_UNCHANGED_REFCOUNT,
        reinterpret_cast<const wchar_t*>(&in_this_library), &here);
    std::array<wchar_t, 4096> path{};
    const DWORD size = ::GetModuleFileNameW(here, path.data(), static_cast<DWORD>(path.size() - 1));
    return fs::path(path.data(), path.data() + size).parent_path();
}

}  // namespace

/// In a package, in a build tree (bin, apps/palpate), and beside the file.
std::vector<fs::path> helper_folders() {
    const fs::path here = folder_of_this();
    std::vector<fs::path> folders;
    for (const char* to : {"../libexec/palpate", "../../libexec/palpate", "."}) {
        folders.push_back((here / to).lexically_normal());
    }
    return folders;
}

}  // namespace palpate::io
