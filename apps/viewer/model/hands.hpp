// The hands in the window: how many there are at most, their colours, and questions to a snapshot
// of one.
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "palpate/servo.hpp"
#include "pictures/scene.hpp"

namespace palpate::viewer {

inline constexpr int most_hands = 2;

/// A value for each hand. Hands are numbered from 1.
template <class T>
class PerHand {
  public:
    T& operator[](int hand) { return values_.at(static_cast<std::size_t>(hand - 1)); }
    const T& operator[](int hand) const { return values_.at(static_cast<std::size_t>(hand - 1)); }
    auto begin() { return values_.begin(); }
    auto begin() const { return values_.begin(); }
    auto end() { return values_.end(); }
    auto end() const { return values_.end(); }
    bool operator==(const PerHand&) const = default;

  private:
    std::array<T, most_hands> values_{};
};

/// Nothing: there is no such hand, or no tick yet.
using HandSnapshots = PerHand<std::optional<Snapshot>>;

struct HandColours {
    pictures::Colour hip, scp;
};
/// The second hand has the lighter blue and the lighter red (Okabe and Ito).
inline HandColours colours_of(int hand) {
    if (hand == 1) return {pictures::hip_colour, pictures::scp_colour};
    return {{0.337, 0.706, 0.914}, {0.902, 0.624, 0}};
}

/// Forces are on but wait, because the hand is deeper in the solid than where they may begin.
inline bool waits_for_hand(const Snapshot& now) {
    return now.forces_on && !now.session.frozen && !now.session.clutched &&
           now.session.device.status == DeviceStatus::ready &&
           now.session.tick.proxy.mode == palpate::Mode::constrained &&
           (now.session.tick.force_flags & force_waiting) != 0;
}

/// Whether two snapshots look the same where `mm` cannot be seen: what a resting hand sends a
/// thousand times a second need not be drawn again.
inline bool looks_same(const Snapshot& a, const Snapshot& b, double mm) {
    constexpr double newtons = 1e-3, newton_mm = 1e-2;
    const auto near = [](const Vec3& p, const Vec3& q, double within) {
        return p == q || (p - q).cwiseAbs().maxCoeff() <= within;
    };
    const auto near_turned = [](const Quaternion& p, const Quaternion& q) {
        constexpr double radians = 1e-3;
        return p.coeffs() == q.coeffs() || (p.coeffs() - q.coeffs()).norm() <= 0.5 * radians;
    };
    const SessionTick &one = a.session, &other = b.session;
    const ProxyUpdate &p = one.tick.proxy, &q = other.tick.proxy;
    return one.device.status == other.device.status && p.mode == q.mode &&
           p.isovalue == q.isovalue && one.version == other.version && one.moment == other.moment &&
           one.transform.rotation == other.transform.rotation && near(p.hip, q.hip, mm) &&
           near(p.scp, q.scp, mm) && near(one.tick.force, other.tick.force, newtons) &&
           near(one.tick.torque, other.tick.torque, newton_mm) &&
           near_turned(one.tick.tool.hand, other.tick.tool.hand) &&
           near_turned(one.tick.tool.proxy, other.tick.tool.proxy);
}

}  // namespace palpate::viewer
