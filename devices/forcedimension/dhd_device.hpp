// An open Force Dimension device, and the step of its thread.
#pragma once

#include <array>
#include <atomic>
#include <optional>
#include <string>
#include <string_view>

#include "devices/claim.hpp"
#include "devices/forcedimension/dhd.hpp"
#include "devices/latest_trouble.hpp"
#include "devices/linked_device.hpp"

namespace palpate::devices::forcedimension {

struct Settings {
    int index = 0;            ///< of the device, as the library counts them
    bool initialise = false;  ///< let it find its reference by itself; it moves to do so
    bool centre = false;      ///< let it turn its wrist straight by itself
    bool simulator = false;   ///< the vendor's, in place of hardware
    double spring = 0;        ///< [N] that opens a closed gripper
    double rate = 1000;       ///< [Hz] of the servo
};

/// What is wrong with the device, found by its own thread.
struct Trouble {
    enum class Kind : std::uint8_t {
        none,
        initialising,   ///< it is moving by itself
        uninitialised,  ///< `words`: why its own attempt failed, if there was one
        wrist_uninitialised,
        not_a_position,  ///< the library returns an impossible position
        not_a_rotation,  ///< the same of the orientation
        force_off,       ///< the device has switched its force off
        error,           ///< a call failed: `words`
        lost,            ///< a call failed because the device does not answer
    };
    Kind kind = Kind::none;
    ForceOff cause = ForceOff::none;
    std::array<char, 128> words{};

    bool operator==(const Trouble&) const = default;
};
DeviceStatus status_of(Trouble::Kind kind);

/// Of the device that the settings choose.
Claim claim_for(const Settings& settings);

/// Opens a device of the library and closes it when destroyed. Throws DeviceError.
class Opened {
  public:
    Opened(const Dhd& dhd, Claim claim, const Settings& settings);
    ~Opened();
    Opened(const Opened&) = delete;
    Opened& operator=(const Opened&) = delete;

    char id() const { return id_; }

  private:
    const Claim claim_;
    const Dhd& dhd_;
    char id_ = 0;
};

class DhdDevice final : public LinkedDevice {
  public:
    DhdDevice(const Dhd& dhd, Claim claim, const Settings& settings, const Timing& timing = {});
    /// Ends the thread. The last force is zero.
    ~DhdDevice() override;

    /// A reading in and a force out, up to 4000 times a second. The first step initialises the
    /// device where the settings ask for it.
    void step() noexcept override;

    DeviceInfo info() const override { return info_; }
    std::string problem() const override;

  private:
    DeviceInfo ask(const Settings& settings) const;

    // Called by the thread only.
    void initialise() noexcept;
    void centre_wrist() noexcept;
    void moves_by_itself() noexcept;
    void look_after_device() noexcept;
    bool switch_on() noexcept;
    bool set_watchdog() noexcept;
    /// `gripper` [N]: opens it.
    int send(const Wrench& wrench, double gripper) noexcept;
    void release() noexcept;
    double opening_force(const DeviceReading& reading, std::int64_t now) const noexcept;
    Trouble read_device(DeviceReading& reading) noexcept;
    Trouble failure() const noexcept;

    const Dhd dhd_;
    const Opened opened_;
    const char id_;
    const Arm arm_;
    const bool renders_torque_;
    const bool emulates_button_;
    const DeviceInfo info_;
    const double spring_;  // [N]
    LatestTrouble<Trouble> trouble_;
    std::atomic<bool> has_watchdog_{false};  // the device drops a force that is not renewed

    // Used by the thread only.
    ForceGate gate_;
    Trouble state_;  // found by look_after_device()
    std::array<char, 128> init_words_{};
    bool is_on_ = false;          // brakes off, force on
    bool is_to_initialise_;       // in the next step
    bool is_to_centre_;           // once it is on
    std::int64_t next_look_ = 0;  // [ns]
    std::optional<unsigned char> old_watchdog_;
};

}  // namespace palpate::devices::forcedimension
