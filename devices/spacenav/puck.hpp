// Events of spacenavd, and the hand they move: deflections of the puck are speeds of the hand. Pure
// functions and values, no socket.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "palpate/device.hpp"

namespace palpate::devices::spacenav {

/// Asks for protocol 1, which tells when a mouse is unplugged. A daemon that knows it answers with
/// the same number; an older one takes it for a factor that is no number, and ignores it.
constexpr std::uint32_t protocol_1 = 0x7faa5501;  // REQ_CHANGE_PROTO, with REQ_TAG and 1

/// Eight numbers in the machine's byte order. The first tells what it is:
enum EventType : std::int32_t {
    motion = 0,   // UEV_MOTION: x y z rx ry rz, counts of deflection, and the ms since the last one
    press = 1,    // UEV_PRESS: button
    release = 2,  // UEV_RELEASE: button
    device = 3,   // UEV_DEV: 0: one was plugged in, 1: one was unplugged; protocol 1 only
};
using Event = std::array<std::int32_t, 8>;

/// Assembles events from pieces of any size. Passes over the answer about the protocol, which comes
/// once or never, before or between events.
class EventReader {
  public:
    /// Adds bytes; next() returns the events they complete.
    void take(std::span<const unsigned char> bytes);
    std::optional<Event> next();

  private:
    std::vector<unsigned char> bytes_;
    std::size_t used_ = 0;
    bool was_answered_ = false;  // about the protocol
};

struct Feel {
    double speed = 100;       ///< [mm/s] at full deflection
    double turn = 90;         ///< [degrees/s] at full deflection
    double deflection = 350;  ///< [counts] that is full
};

/// Half an edge of the box that the hand stays in [device mm].
constexpr double reach = 80;

struct Hand {
    Vec3 position = Vec3::Zero();  ///< [device mm]
    Mat3 orientation = Mat3::Identity();
    Vec3 slide = Vec3::Zero();  ///< deflection, 1: full; our axes
    Vec3 twist = Vec3::Zero();  ///< the same about them
    std::uint32_t buttons = 0;
    bool is_unplugged = false;  ///< until one is plugged in or another one moves
};

/// Applies an event. Unknown types are ignored.
void apply(Hand& hand, const Event& event, const Feel& feel);
/// Moves the hand for this time [s] with the current deflections.
void advance(Hand& hand, double time, const Feel& feel);
/// Releases puck and buttons, when no more events come.
void release_all(Hand& hand);

/// Where the daemon's socket may be, in the order to try: `environment` is $SPNAV_SOCKET (empty:
/// none), `configuration` the text of /etc/spnavrc.
std::vector<std::string> socket_paths(const std::string& environment,
                                      std::string_view configuration);

}  // namespace palpate::devices::spacenav
