// Shared by backends that use a vendor's library: opening the library at run time, and the gate
// that decides which forces reach the vendor's call.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "palpate/device.hpp"
#include "palpate/devices/error.hpp"

namespace palpate::devices {

/// How a vendor's library is called and installed on this system.
struct VendorWords {
    std::vector<std::string> names;  ///< of its files, in the order to try
    std::string usual;               ///< those that users know
    // Ends of messages.
    std::string how_to_install, how_to_attach;
};

/// A vendor's shared library. It is never unloaded: drivers keep threads and device state in it,
/// and OpenHaptics must not be unloaded and loaded again. Its symbols are visible to the libraries
/// that it loads (RTLD_GLOBAL), as those expect.
class VendorLibrary {
  public:
    /// Opens the first of `names` (file names, or paths) that the system's loader finds. Throws
    /// DeviceError with the names tried, the loader's message and `install`.
    VendorLibrary(const std::vector<std::string>& names, const std::string& install);
    /// Opens `path`; if that is empty, the usual names.
    VendorLibrary(const std::string& path, const VendorWords& words)
        : VendorLibrary(path.empty() ? words.names : std::vector<std::string>{path},
                        words.how_to_install) {}

    /// Sets a pointer to a function of this library or of those it loads. Throws DeviceError if
    /// there is no function of this name.
    template <class F>
    void need(F*& function, const char* name) const {
        function = reinterpret_cast<F*>(symbol(name));
        if (!function) throw DeviceError(lacks(name));
    }
    /// The same; null if there is none.
    template <class F>
    void take(F*& function, const char* name) const noexcept {
        function = reinterpret_cast<F*>(symbol(name));
    }

    /// Where the loader found it.
    const std::string& path() const { return path_; }

  private:
    void* symbol(const char* name) const noexcept;
    std::string lacks(const char* name) const;

    void* handle_ = nullptr;
    std::string path_;
};

/// Whether this can be a device's position [device mm]: finite, at most 10 m from its origin.
bool is_position(const Vec3& position) noexcept;

/// Passes a force only after the device has been ready without a break for as long as a link keeps
/// a force, so that every force that passes was written by a servo that saw the device ready. For
/// the thread that talks to the device.
class ForceGate {
  public:
    /// Notes whether the device is ready at this time [ns, monotonic], after the calls that showed
    /// it. A longer time without a note is a break, so a slow call is one, too.
    void note(bool ready, std::int64_t now) noexcept;
    /// `force` limited to `most` [N], or zero. The same for a torque [N mm].
    Vec3 pass(const Vec3& force, double most, std::int64_t now) const noexcept;

  private:
    std::optional<std::int64_t> ready_since_;
    std::int64_t noted_ = 0;
};

}  // namespace palpate::devices
