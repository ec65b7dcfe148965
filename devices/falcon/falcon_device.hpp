// An open Falcon, and the step of its thread.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "devices/claim.hpp"
#include "devices/falcon/port.hpp"
#include "devices/latest_trouble.hpp"
#include "devices/linked_device.hpp"

namespace palpate::devices::falcon {

struct Settings {
    unsigned int index = 0;               ///< of the device, as libftdi counts them
    std::vector<unsigned char> firmware;  ///< empty: it is expected to have one
    double rate = 1000;                   ///< [Hz] of the servo
};

/// What is wrong with the device, found by its own thread.
struct Trouble {
    enum class Kind : std::uint8_t {
        none,
        no_firmware,     ///< it does not answer; `words`: why loading failed, if that was tried
        not_homed,       ///< its encoders have not passed their marks
        silent,          ///< it has stopped answering
        not_a_position,  ///< its angles fit no position of the grip
        lost,            ///< libftdi reports an error: `words`
    };
    Kind kind = Kind::none;
    std::array<char, 128> words{};

    bool operator==(const Trouble&) const = default;
};
DeviceStatus status_of(Trouble::Kind kind);

/// What the motors get for a force [N] in device axes at a position of the grip [m, of the legs].
/// As one: where one of them would be asked for too much, all get less. Zero where no torques give
/// it.
std::array<int, 3> motors_for(const Vec3& force, const Vec3& position);
/// The greatest that a motor is asked for.
constexpr int most_of_motor = 4096;

/// Of the device that the settings choose.
Claim claim_for(const Settings& settings);

class FalconDevice final : public LinkedDevice {
  public:
    FalconDevice(const Ftdi& ftdi, Claim claim, Settings settings, const Timing& timing = {});
    /// Ends the thread. The last packet asks for no force.
    ~FalconDevice() override;

    /// One packet out and one in, a thousand times a second. Without a device or without its
    /// firmware sometimes an attempt to open it or to load, which takes seconds.
    void step() noexcept override;

    DeviceInfo info() const override { return info_; }
    std::string problem() const override;

  private:
    // Called by the thread only.
    void wake(std::int64_t now);
    std::optional<Trouble> converse(DeviceReading& reading);
    Trouble take(const FromDevice& answer, DeviceReading& reading);
    ToDevice next_message(std::int64_t now);
    void lose(const std::string& why, std::int64_t now) noexcept;

    const Ftdi ftdi_;
    const Settings settings_;
    const Claim claim_;
    const DeviceInfo info_;
    LatestTrouble<Trouble> trouble_;

    // Used by the thread only.
    std::optional<Port> port_;
    ForceGate gate_;
    Trouble asleep_;         // why it is not awake
    bool is_awake_ = false;  // it answers packets
    bool is_homed_ = false;
    int unanswered_ = 0;             // packets, in a row
    std::optional<Vec3> position_;   // [m] of the grip, in the legs' frame
    std::int64_t next_attempt_ = 0;  // [ns] to open or wake it, not before
};

}  // namespace palpate::devices::falcon
