// Opens vendor libraries, and implements the gate for forces.
#include "devices/vendor_library.hpp"

#include <dlfcn.h>
#include <link.h>

namespace palpate::devices {
namespace {

constexpr double farthest = 1e4;                                                      // [device mm]
constexpr auto longest_gap = static_cast<std::int64_t>(1e9 * Device::longest_force);  // [ns]

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

bool is_position(const Vec3& position) noexcept {
    return position.allFinite() && position.norm() <= farthest;
}

bool is_rotation(const Mat3& m) noexcept {
    return m.allFinite() && (m * m.transpose() - Mat3::Identity()).cwiseAbs().maxCoeff() < 1e-3 &&
           m.determinant() > 0;
}

void ForceGate::note(bool ready, std::int64_t now) noexcept {
    if (!ready || now - noted_ > longest_gap) ready_since_.reset();
    if (ready && !ready_since_) ready_since_ = now;
    noted_ = now;
}

Vec3 ForceGate::pass(const Vec3& force, double most, std::int64_t now) const noexcept {
    if (!ready_since_ || now - *ready_since_ < longest_gap || now - noted_ > longest_gap ||
        !force.allFinite()) {
        return Vec3::Zero();
    }
    const double size = force.norm();
    return size > most ? Vec3(force * (most / size)) : force;
}

}  // namespace palpate::devices
