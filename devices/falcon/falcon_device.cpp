// Each step sends the motors' values and takes encoders and buttons. Also the messages about
// problems.
#include "devices/falcon/falcon_device.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "devices/falcon/kinematics.hpp"
#include "devices/models.hpp"

namespace palpate::devices::falcon {
namespace {

constexpr std::int64_t period = 1'000'000;                // [ns]
constexpr std::int64_t between_attempts = 1'000'000'000;  // [ns]
constexpr int waits = 5;                                  // [ms] for an answer
constexpr int most_unanswered = 10;                       // packets until it counts as silent
constexpr int most_calls = 20;            // packets until it counts as without firmware
constexpr int most_loads = 3;             // attempts, each of which may fail by chance
constexpr double per_newton_metre = 1e4;  // of a motor's value

DeviceInfo info_of(const Settings& settings) {
    const Model& model = model_named("Falcon");
    const Vec3 corner = 0.5 * Vec3(model.width, model.height, model.depth);
    DeviceInfo info;
    info.name = "falcon";
    info.model = "Novint Falcon";
    info.limits =
        limits_of(model, std::min(settings.rate, 1e9 / period), exchange_delay(1e-9 * period));
    info.stiffness = model.stiffness;
    info.workspace_low = -corner;
    info.workspace_high = corner;
    info.buttons = 4;
    return info;
}

Trouble trouble_of(Trouble::Kind kind, std::string_view words = {}) noexcept {
    Trouble trouble;
    trouble.kind = kind;
    std::ranges::copy(words.substr(0, trouble.words.size() - 1), trouble.words.begin());
    return trouble;
}

}  // namespace

DeviceStatus status_of(Trouble::Kind kind) {
    switch (kind) {
        case Trouble::Kind::none:
            return DeviceStatus::ready;
        case Trouble::Kind::not_homed:
            return DeviceStatus::uncalibrated;
        case Trouble::Kind::silent:
        case Trouble::Kind::lost:
            return DeviceStatus::lost;
        case Trouble::Kind::no_firmware:
        case Trouble::Kind::not_a_position:
            break;
    }
    return DeviceStatus::fault;
}

std::array<int, 3> motors_for(const Vec3& force, const Vec3& position) {
    std::array<int, 3> motors{};
    if (force.isZero(0)) return motors;
    const auto torques = torques_for(force, position);
    if (!torques || !torques->allFinite()) return motors;
    Vec3 values = -per_newton_metre * *torques;  // a positive value turns the arm back
    const double greatest = values.cwiseAbs().maxCoeff();
    if (greatest > most_of_motor) values *= most_of_motor / greatest;
    for (int i = 0; i < 3; ++i) {
        motors[static_cast<std::size_t>(i)] = static_cast<int>(std::lround(values[i]));
    }
    return motors;
}

Claim claim_for(const Settings& settings) {
    return Claim("the Falcon with index=" + std::to_string(settings.index));
}

FalconDevice::FalconDevice(const Ftdi& ftdi, Claim claim, Settings settings, const Timing& timing)
    : LinkedDevice(timing, period),
      ftdi_(ftdi),
      settings_(std::move(settings)),
      claim_(std::move(claim)),
      info_(info_of(settings_)) {
    const int count = ftdi_.count();
    if (count <= static_cast<int>(settings_.index)) {
        throw DeviceError("no device with index=" + std::to_string(settings_.index) + " (" +
                          std::to_string(std::max(0, count)) + " found): " + words().how_to_attach);
    }
    try {
        port_.emplace(ftdi_, settings_.index);
    } catch (const PortError& error) {
        throw DeviceError(std::string(error.what()) + ": does another program use it? " +
                          words().how_to_attach);
    }
}

FalconDevice::~FalconDevice() {
    end_thread();
    try {
        if (port_ && is_awake_) port_->exchange({}, waits);
    } catch (const PortError&) {  // it is gone
    }
}

void FalconDevice::step() noexcept {
    std::int64_t begun = timing_.now();
    DeviceReading reading;
    std::optional<Trouble> trouble;
    try {
        if (!is_awake_ && begun >= next_attempt_) wake(begun);
        begun = timing_.now();
        trouble = is_awake_ ? converse(reading) : asleep_;
    } catch (const std::exception& error) {
        lose(error.what(), timing_.now());
        trouble = asleep_;
    }
    if (!trouble) return;  // the reading before gets old
    const std::int64_t end = timing_.now();
    gate_.note(trouble->kind == Trouble::Kind::none, end);
    reading.age = 1e-9 * static_cast<double>(end - begun);
    trouble_.report(link_, *trouble, reading, end);
}

void FalconDevice::lose(const std::string& why, std::int64_t now) noexcept {
    port_.reset();
    is_awake_ = is_homed_ = false;
    position_.reset();
    asleep_ = trouble_of(Trouble::Kind::lost, why);
    next_attempt_ = now + between_attempts;
}

/// Opens the device if it was lost, and makes it answer: with the firmware that it has, or with the
/// one that was given.
void FalconDevice::wake(std::int64_t now) {
    next_attempt_ = now + between_attempts;
    is_homed_ = false;
    unanswered_ = 0;
    position_.reset();
    if (!port_) port_.emplace(ftdi_, settings_.index);
    const auto answers = [&] {
        for (int i = 0; i < most_calls && !is_awake_; ++i) {
            is_awake_ = port_->exchange({}, waits).has_value();
        }
        return is_awake_;
    };
    if (answers()) return;
    std::string wrong;
    for (int i = 0; i < most_loads && !settings_.firmware.empty() && !is_ending(); ++i) {
        wrong = port_->load(settings_.firmware);
        if (wrong.empty() && answers()) return;
        if (wrong.empty()) wrong = "it was loaded, but does not answer";
    }
    next_attempt_ = timing_.now() + between_attempts;
    asleep_ = trouble_of(Trouble::Kind::no_firmware, wrong);
}

ToDevice FalconDevice::next_message(std::int64_t now) {
    ToDevice message;
    message.lights = is_homed_ ? green : red;
    message.homes = !is_homed_;
    const Vec3 force = gate_.pass(link_.wrench(now).force, info_.limits.maximum_force, now);
    if (is_homed_ && position_) message.motors = motors_for(force, *position_);
    return message;
}

/// Returns nothing if only a few answers are missing.
std::optional<Trouble> FalconDevice::converse(DeviceReading& reading) {
    const auto answer = port_->exchange(next_message(timing_.now()), waits);
    if (answer) {
        unanswered_ = 0;
        return take(*answer, reading);
    }
    if (++unanswered_ < most_unanswered) return std::nullopt;
    is_awake_ = false;
    asleep_ = trouble_of(Trouble::Kind::silent);
    next_attempt_ = timing_.now() + between_attempts;
    return asleep_;
}

Trouble FalconDevice::take(const FromDevice& answer, DeviceReading& reading) {
    is_homed_ = is_homed_ || answer.homed == all_homed;
    if (!is_homed_) return trouble_of(Trouble::Kind::not_homed);
    const Vec3 angles = angles_from({answer.encoders[0], answer.encoders[1], answer.encoders[2]});
    auto position = position_ ? position_with(angles, *position_) : std::nullopt;
    if (!position) position = position_with(angles, centre);
    position_ = position;
    if (!position) return trouble_of(Trouble::Kind::not_a_position);
    reading.position = 1000 * (*position - centre);
    reading.buttons = answer.buttons;
    if (!is_position(reading.position)) return trouble_of(Trouble::Kind::not_a_position);
    return {};
}

std::string FalconDevice::problem() const {
    const Trouble trouble = trouble_.get();
    const std::string words = trouble.words.data();
    switch (trouble.kind) {
        case Trouble::Kind::no_firmware:
            return words.empty()
                       ? "the device does not answer: it needs its firmware after each power-up. "
                         "Give the vendor's file: firmware=PATH"
                       : "its firmware could not be loaded (" + words +
                             "): take its power away for ten seconds; is it the vendor's file?";
        case Trouble::Kind::not_homed:
            return "not homed: pull the grip out and push it in all the way, until the light "
                   "turns green";
        case Trouble::Kind::silent:
            return "the device has stopped answering: it is called again every second; check cable "
                   "and power";
        case Trouble::Kind::not_a_position:
            return "the device tells angles that fit no position: take its power away, and home it "
                   "again";
        case Trouble::Kind::lost:
            return "no connection to the device (" + words +
                   "): check cable and power; it is tried again every second";
        case Trouble::Kind::none:
            break;
    }
    switch (link_.read(timing_.now()).status) {
        case DeviceStatus::starting:
            return "the device has not told a position yet";
        case DeviceStatus::stale:
            return "the USB bus takes too long: the last position is more than 20 ms old; the "
                   "device may still hold the last force: if that lasts, switch it off";
        default:
            return {};
    }
}

}  // namespace palpate::devices::falcon
