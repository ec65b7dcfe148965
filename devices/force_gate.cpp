// Decides which forces reach a vendor's call. See vendor_library.hpp.
#include "devices/vendor_library.hpp"

namespace palpate::devices {
namespace {

constexpr double farthest = 1e4;                                                      // [device mm]
constexpr auto longest_gap = static_cast<std::int64_t>(1e9 * Device::longest_force);  // [ns]

}  // namespace

bool is_position(const Vec3& position) noexcept {
    return position.allFinite() && position.norm() <= farthest;
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
    if (!(most > 0)) return Vec3::Zero();
    return size > most ? Vec3(force * (most / size)) : force;
}

}  // namespace palpate::devices
