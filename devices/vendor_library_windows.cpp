// Opens vendor libraries. See vendor_library.hpp. Windows, where a library's symbols are its own.
#include <windows.h>

#include <array>
#include <filesystem>
#include <system_error>

#include "devices/vendor_library.hpp"

namespace palpate::devices {
namespace {

std::string path_of(HMODULE library) {
    std::array<wchar_t, 4096> path{};
    const DWORD size =
        ::GetModuleFileNameW(library, path.data(), static_cast<DWORD>(path.size() - 1));
    return std::filesystem::path(path.data(), path.data() + size).string();
}

}  // namespace

VendorLibrary::VendorLibrary(const std::vector<std::string>& names, const std::string& install) {
    std::string tried;
    for (const std::string& name : names) {
        const std::filesystem::path path(name);
        // The libraries that one needs may lie beside it, but only if it is named by its place.
        const DWORD beside = path.is_absolute() ? LOAD_WITH_ALTERED_SEARCH_PATH : 0;
        handle_ = ::LoadLibraryExW(path.c_str(), nullptr, beside);
        if (handle_) break;
        const auto error = static_cast<int>(::GetLastError());
        tried += (tried.empty() ? "" : "; ") + name + ": " + std::system_category().message(error);
    }
    if (!handle_) throw DeviceError("cannot open its library (" + tried + "): " + install);
    path_ = path_of(static_cast<HMODULE>(handle_));
}

void* VendorLibrary::symbol(const char* name) const noexcept {
    return reinterpret_cast<void*>(::GetProcAddress(static_cast<HMODULE>(handle_), name));
}

std::string VendorLibrary::lacks(const char* name) const {
    return path_ + " has no function " + name +
           ": it is another library, or of a version that is not supported; install the vendor's "
           "current one";
}

}  // namespace palpate::devices
