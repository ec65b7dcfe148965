// Each step maintains a Force Dimension device, reads it and sends a force. Also its messages about
// problems.
#include "devices/forcedimension/dhd_device.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace palpate::devices::forcedimension {
namespace {

constexpr std::int64_t period = 250'000;            // [ns] 4 kHz at most
constexpr std::int64_t between_looks = 20'000'000;  // [ns]
// In eighths of a millisecond: without a force for so long, the device drops it by itself.
constexpr unsigned char watchdog = 240;

/// The library's x points to the person, y to the right, z up.
Mat3 axes() {
    Mat3 m;
    m << 0, 1, 0, 0, 0, 1, 1, 0, 0;
    return m;
}

/// Allows calls that are refused otherwise.
class ExpertMode {
  public:
    explicit ExpertMode(const Dhd& dhd) : dhd_(dhd) {
        if (dhd.enable_expert_mode) dhd.enable_expert_mode();
    }
    ~ExpertMode() {
        if (dhd_.disable_expert_mode) dhd_.disable_expert_mode();
    }
    ExpertMode(const ExpertMode&) = delete;
    ExpertMode& operator=(const ExpertMode&) = delete;

  private:
    const Dhd& dhd_;
};

std::array<char, 128> clipped(std::string_view text) noexcept {
    std::array<char, 128> characters{};
    std::ranges::copy(text.substr(0, characters.size() - 1), characters.begin());
    return characters;
}

std::string words_of(ForceOff cause) {
    switch (cause) {
        case ForceOff::button:
            return "force is switched off at the device: press its force button";
        case ForceOff::velocity:
            return "the device was moved faster than it allows and has switched its force off: "
                   "press its force button";
        case ForceOff::watchdog:
            return "the device waited too long for a force and has switched it off; it is being "
                   "switched on again";
        case ForceOff::deadman:
            return "the device's dead-man switch is open";
        default:
            return "the device has switched its force off (cause " +
                   std::to_string(static_cast<int>(cause)) + "): press its force button";
    }
}

}  // namespace

DeviceStatus status_of(Trouble::Kind kind) {
    switch (kind) {
        case Trouble::Kind::none:
            return DeviceStatus::ready;
        case Trouble::Kind::initialising:
        case Trouble::Kind::uninitialised:
        case Trouble::Kind::wrist_uninitialised:
            return DeviceStatus::uncalibrated;
        case Trouble::Kind::lost:
            return DeviceStatus::lost;
        default:
            return DeviceStatus::fault;
    }
}

Claim claim_for(const Settings& settings) {
    return Claim("the device with index=" + std::to_string(settings.index));
}

Opened::Opened(const Dhd& dhd, Claim claim, const Settings& settings)
    : claim_(std::move(claim)), dhd_(dhd) {
    if (settings.simulator && !dhd.enable_simulator) {
        throw DeviceError("simulator=yes: " + dhd.library.path() +
                          " knows no simulator: install the SDK's current version");
    }
    if (dhd.enable_simulator) dhd.enable_simulator(settings.simulator);
    const int index = settings.index;
    const int count = dhd.get_device_count();
    if (count <= index) {
        throw DeviceError(
            (count <= 0 ? "no device" : "no device with index=" + std::to_string(index)) + " (" +
            std::to_string(std::max(0, count)) +
            " found): connect it and switch it on; your account must be able to open its USB "
            "device (the SDK's udev rule, 51-forcedimension.rules)");
    }
    const int id = dhd.open(static_cast<char>(index));
    if (id < 0) {
        throw DeviceError("cannot open device " + std::to_string(index) + ": " + dhd.error_words() +
                          ": does another program use it? Your account must be able to open its "
                          "USB device (the SDK's udev rule, 51-forcedimension.rules)");
    }
    id_ = static_cast<char>(id);
}

Opened::~Opened() {
    dhd_.stop(id_);
    dhd_.close(id_);
}

DhdDevice::DhdDevice(const Dhd& dhd, Claim claim, const Settings& settings, const Timing& timing)
    : LinkedDevice(timing, period),
      dhd_(dhd),
      opened_(dhd_, std::move(claim), settings),
      id_(opened_.id()),
      arm_(arm_of(dhd_, id_)),
      renders_torque_(arm_.model.torque > 0),
      emulates_button_(arm_.model.has_gripper && dhd_.emulate_button &&
                       dhd_.emulate_button(1, id_) >= 0),
      info_(ask(settings)),
      spring_(settings.spring),
      is_to_initialise_(settings.initialise),
      is_to_centre_(settings.centre) {
    if (settings.initialise && !dhd_.has_drd()) {
        throw DeviceError("autoinit=yes: " + dhd_.library.path() +
                          " cannot initialise devices: install libdrd beside it, or "
                          "library=PATH of that one");
    }
    if (spring_ > 0 && arm_.opens == 0) {
        throw DeviceError("spring=: " + info_.model + " has no gripper with a motor, or " +
                          dhd_.library.path() + " cannot drive it: leave it out");
    }
    if (settings.centre && !(renders_torque_ && dhd_.can_centre())) {
        throw DeviceError(renders_torque_
                              ? "centre=yes: " + dhd_.library.path() +
                                    " cannot move devices: install libdrd beside it, or "
                                    "library=PATH of that one"
                              : "centre=yes: " + info_.model + " has no motors at its wrist");
    }
}

DhdDevice::~DhdDevice() {
    end_thread();
    send({}, 0);
    if (emulates_button_) dhd_.emulate_button(0, id_);
    if (!old_watchdog_) return;
    const ExpertMode expert(dhd_);
    dhd_.set_watchdog(*old_watchdog_, id_);
}

DeviceInfo DhdDevice::ask(const Settings& settings) const {
    DeviceInfo info;
    info.name = "forcedimension";
    const char* name = dhd_.get_system_name ? dhd_.get_system_name(id_) : nullptr;
    info.model = name && *name ? name : arm_.model.name;
    unsigned short serial = 0;
    if (dhd_.get_serial_number && dhd_.get_serial_number(&serial, id_) >= 0) {
        info.model += ", serial number " + std::to_string(serial);
    }
    const Model& model = arm_.model;
    info.limits =
        limits_of(model, std::min(settings.rate, 1e9 / period), exchange_delay(1e-9 * period));
    info.stiffness = model.stiffness;
    const Vec3 corner = 0.5 * Vec3(model.width, model.height, model.depth);
    info.workspace_low = arm_.centre - corner;
    info.workspace_high = arm_.centre + corner;
    info.has_orientation = model.has_wrist;
    info.renders_torque = renders_torque_;
    info.has_gripper = model.has_gripper && dhd_.get_gripper_angle;
    info.buttons = arm_.has_button_row ? 4 : (!model.has_gripper || emulates_button_ ? 1 : 0);
    return info;
}

void DhdDevice::initialise() noexcept {
    is_to_initialise_ = false;
    std::array<int, status::room> told{};
    const bool wrist = !renders_torque_ || (dhd_.get_status(told.data(), id_) >= 0 &&
                                            told[status::wrist_initialised] != 0);
    if (wrist && dhd_.drd_is_initialised(id_)) return;
    moves_by_itself();
    if (dhd_.drd_initialise(id_) < 0) init_words_ = clipped(dhd_.error_words());
    dhd_.drd_stop(true, id_);  // it regulates the device until told not to; forces stay on
}

void DhdDevice::moves_by_itself() noexcept {
    Trouble trouble;
    trouble.kind = Trouble::Kind::initialising;
    trouble_.report(link_, trouble, {}, timing_.now());
}

/// The library regulates the wrist alone until it is straight, and lets go of it again: torques
/// are felt at axes that are not regulated only.
void DhdDevice::centre_wrist() noexcept {
    is_to_centre_ = false;
    moves_by_itself();
    dhd_.drd_regulate_position(false, id_);
    dhd_.drd_regulate_gripper(false, id_);
    dhd_.drd_regulate_rotation(true, id_);
    if (dhd_.drd_start(id_) >= 0) dhd_.drd_turn_to(0, 0, 0, true, id_);
    dhd_.drd_stop(true, id_);
    dhd_.drd_regulate_rotation(false, id_);
}

/// A spring that is loose at half a radian.
double DhdDevice::opening_force(const DeviceReading& reading, std::int64_t now) const noexcept {
    constexpr double loose = 0.5;  // [rad]
    if (!reading.opening || !link_.is_driven(now)) return 0;
    const double force = spring_ * (1 - std::clamp(*reading.opening / loose, 0., 1.));
    return gate_.pass(Vec3(force, 0, 0), spring_, now).x();
}

int DhdDevice::send(const Wrench& wrench, double gripper) noexcept {
    const Vec3 f = axes().transpose() * wrench.force;
    const double g = arm_.opens * gripper;
    if (!renders_torque_ && spring_ > 0) {
        const int result = dhd_.set_force_and_gripper(f[0], f[1], f[2], g, id_);
        if (result < 0) release();
        return result;
    }
    if (!renders_torque_) return dhd_.set_force(f[0], f[1], f[2], id_);
    const Vec3 t = axes().transpose() * wrench.torque * 1e-3;  // [N m]
    const int result = dhd_.set_all
                           ? dhd_.set_all(f[0], f[1], f[2], t[0], t[1], t[2], g, id_)
                           : dhd_.set_force_and_torque(f[0], f[1], f[2], t[0], t[1], t[2], id_);
    if (result < 0) release();
    return result;
}

/// A force that was not taken must not leave the force before it.
void DhdDevice::release() noexcept {
    if (dhd_.set_force_and_gripper) dhd_.set_force_and_gripper(0, 0, 0, 0, id_);
    dhd_.set_force(0, 0, 0, id_);
}

void DhdDevice::step() noexcept {
    if (is_to_initialise_) initialise();
    const std::int64_t begun = timing_.now();
    if (begun >= next_look_) {
        look_after_device();
        next_look_ = begun + between_looks;
    }
    DeviceReading reading;
    Trouble trouble = read_device(reading);
    if (trouble.kind == Trouble::Kind::none) trouble = state_;

    const std::int64_t now = timing_.now();
    gate_.note(trouble.kind == Trouble::Kind::none, now);
    const Wrench wanted = link_.wrench(now);
    const Wrench passed{gate_.pass(wanted.force, arm_.model.force, now),
                        gate_.pass(wanted.torque, info_.limits.maximum_torque, now)};
    if (send(passed, opening_force(reading, now)) < 0 && trouble.kind == Trouble::Kind::none) {
        trouble = failure();
        gate_.note(false, now);
    }
    const std::int64_t end = timing_.now();
    reading.age = 1e-9 * static_cast<double>(end - begun);
    trouble_.report(link_, trouble, reading, end);
}

void DhdDevice::look_after_device() noexcept {
    std::array<int, status::room> told{};
    state_ = {};
    if (dhd_.get_status(told.data(), id_) < 0) {
        state_ = failure();
        return;
    }
    if (told[status::reset] != 0 || (dhd_.has_drd() && !dhd_.drd_is_initialised(id_))) {
        is_on_ = false;
        state_.kind = Trouble::Kind::uninitialised;
        state_.words = init_words_;
        return;
    }
    // Without its reference the orientation is wrong, and a torque would turn it somewhere.
    if (renders_torque_ && told[status::wrist_initialised] == 0) {
        is_on_ = false;
        state_.kind = Trouble::Kind::wrist_uninitialised;
        state_.words = init_words_;
        return;
    }
    if (!is_on_) {
        is_on_ = switch_on();
        if (!is_on_) state_ = failure();
        if (is_on_ && is_to_centre_) centre_wrist();
        return;
    }
    // A device that does not report why its force is off may not report its force at all.
    const auto cause = static_cast<ForceOff>(told[status::force_off_cause]);
    if (told[status::force] != 0 || cause == ForceOff::none) return;
    state_.kind = Trouble::Kind::force_off;
    state_.cause = cause;
    if (cause == ForceOff::watchdog) dhd_.enable_force(1, id_);
}

bool DhdDevice::switch_on() noexcept {
    // A model refuses calls for features it lacks; only the force itself is needed.
    if (dhd_.set_max_force) dhd_.set_max_force(arm_.model.force, id_);
    if (renders_torque_ && dhd_.set_max_torque) dhd_.set_max_torque(1e-3 * arm_.model.torque, id_);
    dhd_.set_brakes(0, id_);
    if (dhd_.enable_force(1, id_) < 0) return false;
    dhd_.set_gravity_compensation(1, id_);
    has_watchdog_.store(set_watchdog());
    return true;
}

/// Whether the device has taken it. Notes what it was before.
bool DhdDevice::set_watchdog() noexcept {
    if (!dhd_.set_watchdog) return false;
    const ExpertMode expert(dhd_);
    unsigned char old = 0;
    const bool is_known = dhd_.get_watchdog && dhd_.get_watchdog(&old, id_) >= 0;
    if (dhd_.set_watchdog(watchdog, id_) < 0) return false;
    if (is_known && !old_watchdog_) old_watchdog_ = old;
    return true;
}

Trouble DhdDevice::read_device(DeviceReading& reading) noexcept {
    constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
    double x = unknown, y = unknown, z = unknown;
    if (dhd_.get_position(&x, &y, &z, id_) < 0) return failure();
    Trouble trouble;
    reading.position = 1000 * (axes() * Vec3(x, y, z));
    if (arm_.model.has_wrist) {
        double rows[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
        if (dhd_.get_orientation(rows, id_) < 0) return failure();
        Mat3 frame;
        for (int row = 0; row < 3; ++row) {
            for (int column = 0; column < 3; ++column) frame(row, column) = rows[row][column];
        }
        if (is_rotation(frame, orientation_tolerance)) {
            reading.orientation = axes() * frame * axes().transpose();
        } else {
            trouble.kind = Trouble::Kind::not_a_rotation;
        }
    }
    if (info_.has_gripper) {
        double opening = unknown;
        if (dhd_.get_gripper_angle(&opening, id_) < 0) return failure();
        reading.opening = std::abs(opening);  // left-handed devices count it below 0
    }
    reading.buttons = dhd_.get_buttons(id_) & 0xFFFFU;
    if (!is_position(reading.position)) trouble.kind = Trouble::Kind::not_a_position;
    return trouble;
}

Trouble DhdDevice::failure() const noexcept {
    Trouble trouble;
    switch (dhd_.error_get_last()) {
        case error::communication:
        case error::no_driver:
        case error::no_device:
        case error::timeout:
        case error::not_ready:
            trouble.kind = Trouble::Kind::lost;
            break;
        default:
            trouble.kind = Trouble::Kind::error;
    }
    const char* words = dhd_.error_get_last_text();
    trouble.words = clipped(words ? words : "");
    return trouble;
}

std::string DhdDevice::problem() const {
    const Trouble trouble = trouble_.get();
    const std::string words = trouble.words.data();
    switch (trouble.kind) {
        case Trouble::Kind::initialising:
            return "the device finds its reference or centres its wrist: it moves by itself; keep "
                   "your hands off";
        case Trouble::Kind::wrist_uninitialised:
            return "the wrist is not initialised" +
                   (words.empty() ? "" : " (it could not do so itself: " + words + ")") +
                   ": initialise it as the device's manual says, or open it with autoinit=yes, "
                   "which moves it";
        case Trouble::Kind::uninitialised:
            return (words.empty() ? "not initialised"
                                  : "it could not initialise itself (" + words + ")") +
                   ": put its calibration pole into the calibration pit until the light stops "
                   "blinking (a Falcon: pull the grip out and push it in all the way), or open it "
                   "with autoinit=yes, which moves it";
        case Trouble::Kind::not_a_position:
            return "the library tells a position that cannot be: initialise the device again";
        case Trouble::Kind::not_a_rotation:
            return "the library tells an orientation that cannot be: initialise the device again";
        case Trouble::Kind::force_off:
            return words_of(trouble.cause);
        case Trouble::Kind::error:
            return "the library reports: " + words;
        case Trouble::Kind::lost:
            return "no connection to the device (" + words +
                   "): check cable and power; if it does not come back, start again";
        case Trouble::Kind::none:
            break;
    }
    switch (link_.read(timing_.now()).status) {
        case DeviceStatus::starting:
            return "the device has not told a position yet";
        case DeviceStatus::stale:
            return std::string(
                       "the library takes too long: its last position is more than 20 ms "
                       "old; ") +
                   (has_watchdog_ ? "the device drops the last force by itself"
                                  : "it may still hold the last force: if that lasts, switch "
                                    "the device off");
        default:
            return {};
    }
}

}  // namespace palpate::devices::forcedimension
