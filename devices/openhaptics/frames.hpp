// The callback that runs in the driver's servo loop: each call is one frame, reading in, force and
// torque out.
#pragma once

#include <atomic>
#include <memory>
#include <utility>

#include "devices/latest_trouble.hpp"
#include "devices/openhaptics/hd.hpp"

namespace palpate::devices::openhaptics {

/// What is wrong with the device, found by the driver's thread.
struct Trouble {
    enum class Kind : std::uint8_t {
        none,
        needs_update,    ///< calibration that waits for the driver
        needs_person,    ///< calibration that waits for a person
        not_a_position,  ///< the driver returns an impossible position
        not_a_rotation,  ///< the same of the orientation
        passing,         ///< an error; over when it has not recurred for a while
        loop_ended,      ///< the driver's servo loop; permanent
        unlicensed,      ///< permanent
        lost,            ///< communication has ended; permanent
        broken,          ///< the device reports a fault; permanent
    };
    Kind kind = Kind::none;
    unsigned int code = 0;  ///< of the driver's error

    bool operator==(const Trouble&) const = default;
};
DeviceStatus status_of(Trouble::Kind kind);

class Frames {
  public:
    struct Setup {
        Handle device = no_handle;
        double most_force = 0;        ///< [N]
        double continuous_force = 0;  ///< [N] for hours
        double most_torque = 0;       ///< [N mm] 0: it has none, and is never sent one
        bool has_orientation = false;
        unsigned int styles = 0;  ///< of calibration, bits
        Clock now = &monotonic_ns;
    };
    Frames(std::shared_ptr<const Hd> hd, const Setup& setup)
        : library_(std::move(hd)), hd_(*library_), setup_(setup), force_limit_(setup.most_force) {}

    /// For the driver's scheduler; `frames` points to one of these.
    static unsigned int callback(void* frames);

    Link& link() { return link_; }
    const Link& link() const { return link_; }
    /// Any thread.
    Trouble trouble() const;
    /// [N] The force is limited to it because the motors are warm; any thread. 0: it is not.
    double warm_limit() const noexcept { return warm_limit_.load(); }

    /// Any thread: the next frame sends zero force and is the last.
    void end() noexcept { end_.store(true); }
    /// Whether that frame was sent. The callback is not called again after it.
    bool ended() const noexcept { return ended_.load(); }

  private:
    // Called by the driver's thread only.
    unsigned int frame() noexcept;
    Trouble read_device(DeviceReading& reading) noexcept;
    bool for_good() const noexcept;
    void take_errors() noexcept;
    void note_error(unsigned int code) noexcept;
    void guard_motors(std::int64_t now) noexcept;
    void force_output(bool on) noexcept;

    const std::shared_ptr<const Hd> library_;
    const Hd& hd_;
    const Setup setup_;
    Link link_;
    LatestTrouble<Trouble> trouble_;
    std::atomic<bool> end_{false}, ended_{false};
    std::atomic<double> warm_limit_{0};

    // Used by the driver's thread only.
    ForceGate gate_;
    Trouble error_;                 // the worst recent one
    std::int64_t error_until_ = 0;  // [ns] when a passing one is over
    bool force_output_ = true;
    double force_limit_;  // [N] lower while the motors are warm
    bool tells_temperature_ = true;
    std::int64_t guarded_ = 0;      // [ns] last, or 0
    std::int64_t next_update_ = 0;  // [ns] of the calibration, not before
};

}  // namespace palpate::devices::openhaptics
