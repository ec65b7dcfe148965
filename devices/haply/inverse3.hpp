// An Inverse3: the messages of its thread to the Inverse Service, and a link to the servo.
#pragma once

#include <array>
#include <chrono>
#include <memory>
#include <optional>
#include <string>

#include "devices/claim.hpp"
#include "devices/haply/protocol.hpp"
#include "devices/haply/socket.hpp"
#include "devices/linked_device.hpp"
#include "devices/models.hpp"
#include "devices/vendor_library.hpp"

namespace palpate::devices::haply {

struct Settings {
    std::string device;                 ///< device_id; empty: the first that is found
    std::optional<ForceKey> force_key;  ///< nothing: what the service seems to take
    std::string preset = "defaults";    ///< of the service, pinned; "keep": as it is
    Mat3 axes = axes_from("xz-y");
    bool assume_calibrated = false;  ///< whatever the service reports
    double timeout = 2;  ///< [s] by which answers may be late before the connection is dropped
    double rate = 1000;  ///< [Hz] of the servo
};

/// Times of a socket as those of a link.
inline Clock::time_point time_of(const Timing& timing) {
    return Clock::time_point(std::chrono::nanoseconds(timing.now()));
}
inline std::int64_t ns_of(Clock::time_point time) {
    return std::chrono::nanoseconds(time.time_since_epoch()).count();
}

/// A connection, and what the service has said on it.
struct Talk {
    std::unique_ptr<Channel> channel = std::make_unique<Socket>(longest_message);
    ServiceState state;
};
/// Connects and reads the first message, which lists the devices. Returns what is wrong, or empty.
std::string start_talk(Talk& talk, const Address& address, const std::string& device,
                       Clock::time_point deadline);
/// The message for a service that answers but does not have the device.
std::string no_device(const Talk& talk, const Address& address);

/// Counts questions and answers. The service answers each message with one, so an answer is no
/// older than its question; how many are missing tells whether the service keeps up.
class Questions {
  public:
    void asked(Clock::time_point now);
    /// When the question to this answer was asked; an answer without a question counts for the
    /// last.
    Clock::time_point answered();
    std::uint64_t missing() const { return asked_ - answered_; }
    Clock::time_point last() const { return last_; }
    /// For how long at least one answer has been missing; the longest time there is for too many.
    Clock::duration behind(Clock::time_point now) const;

  private:
    std::array<Clock::time_point, 1024> times_{};
    std::uint64_t asked_ = 0, answered_ = 0;
    Clock::time_point last_, behind_since_;
};

class Inverse3 final : public LinkedDevice {
  public:
    /// `talk` has found the device. Its channel keeps the time of `timing`.
    Inverse3(Settings settings, Address address, Talk talk, const Timing& timing = {});
    /// Ends the thread, sends zero force and says goodbye: at most about 0.2 s.
    ~Inverse3() override;

    /// One question, or one wait of at most 10 ms; without a connection sometimes an attempt to
    /// connect, of at most 250 ms.
    void step() override;

    DeviceInfo info() const override;
    std::string problem() const override;

  private:
    // Called by the thread only.
    void wait() override {}  // a step does
    void reconnect();
    std::optional<std::string> converse();
    bool ask(Clock::time_point now);
    void take(const Received& received, Clock::time_point asked, Clock::time_point now);
    DeviceStatus status_of_mapping(Clock::time_point now);
    bool is_as_pinned() const;
    void check_echo(Clock::time_point now);
    void try_other_key(Clock::time_point now);
    void report_state(Clock::time_point asked, Clock::time_point now);
    void lose(std::string_view why) noexcept;
    void say_goodbye();
    std::string what_is_wrong(Clock::time_point now) const;
    const Model& model() const;
    Vec3 force(Clock::time_point now);
    Clock::time_point now() const { return time_of(timing_); }
    void tell(std::string_view problem);
    void tell_identity(const ServiceState& state);

    struct Problem {
        std::array<char, 400> text;
    };
    struct Identity {
        std::array<char, 128> model;
        bool has_grip;
    };

    const Settings settings_;
    const Address address_;
    const std::string service_;  // in words
    const bool is_minverse_;
    Newest<Problem> problem_;
    Newest<Identity> identity_;

    // Used by the thread only.
    Talk talk_;
    const Claim claim_;  // of the device
    bool connected_ = true;
    Questions questions_;
    std::string told_;
    bool told_grip_ = false;
    bool has_pinned_ = false;         // on this connection
    Clock::time_point pinned_at_;     // asked to
    bool is_watched_ = false;         // the mapping is what was pinned, and has to stay so
    std::optional<Mapping> mapping_;  // that holds on this connection
    Clock::time_point mapping_since_;
    std::string_view changed_;       // the part of it that another program has changed; for good
    Clock::time_point ready_again_;  // not before: the servo has to see a break
    Clock::time_point next_full_;    // question for all, not before
    ForceKey force_key_ = ForceKey::values;
    double asked_force_ = 0;  // [N] in the newest question
    bool is_echoed_ = false;  // the service has rendered a force of ours
    int keys_tried_ = 1;
    Clock::time_point unechoed_since_;
    Clock::time_point measured_at_;  // the newest position, at the earliest
    ForceGate gate_;
    Clock::duration wait_;            // before the next attempt to connect
    Clock::time_point next_attempt_;  // not before
};

}  // namespace palpate::devices::haply
