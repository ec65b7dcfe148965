// Opens vendor libraries. See the header. Linux.
#include "devices/vendor_library.hpp"

#include <dlfcn.h>
#include <link.h>

namespace palpate::devices {
namespace {

std::string loader_says() {
    const char* error = dlerror();
    return error ? error : "unknown error";
}

}  // namespace

VendorLibrary::VendorLibrary(const std::vector<std::string>& names, const std::string& install) {
    std::string tried;
    for (const std::string& name : names) {
        handle_ = dlopen(name.c_str(), RTLD_NOW | RTLD_GLOBAL);
        if (handle_) break;
        tried += (tried.empty() ? "" : "; ") + loader_says();
    }
    if (!handle_) throw DeviceError("cannot open its library (" + tried + "): " + install);
    const link_map* map = nullptr;
    if (dlinfo(handle_, RTLD_DI_LINKMAP, &map) == 0 && map && map->l_name) path_ = map->l_name;
}

void* VendorLibrary::symbol(const char* name) const noexcept {
    return dlsym(handle_, name);
}

std::string VendorLibrary::lacks(const char* name) const {
    return path_ + " has no function " + name +
           ": it is another library, or of a version that is not supported; install the vendor's "
           "current one";
}

}  // namespace palpate::devices
