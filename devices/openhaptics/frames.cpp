// One frame of OpenHaptics' servo loop, and the meaning of its errors.
#include "devices/openhaptics/frames.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace palpate::devices::openhaptics {
namespace {

constexpr std::int64_t error_lasts = 1'000'000'000;     // [ns] after it was last reported
constexpr std::int64_t between_readings = 100'000'000;  // [ns] at the motors
constexpr int most_motors = 16;
constexpr std::int64_t between_updates = 1'000'000'000;  // [ns] of the calibration

Trouble trouble_of(unsigned int code) {
    using Kind = Trouble::Kind;
    if (code == error::communication || code == error::communication_setup) {
        return {Kind::lost, code};
    }
    if (code == error::timer || code == error::invalid_priority || code == error::scheduler_full) {
        return {Kind::loop_ended, code};
    }
    if (code == error::invalid_license) return {Kind::unlicensed, code};
    return {code == error::device_fault ? Kind::broken : Kind::passing, code};
}

/// HD_INVALID_ENUM, _VALUE, _OPERATION or _INPUT_TYPE: the driver does not know what it was asked.
bool is_unknown_parameter(unsigned int code) {
    return code >= 0x100 && code <= 0x103;
}

/// Columns of the driver's matrix are the tool's axes in the device's.
Mat3 orientation_of(const double (&transform)[16]) {
    Mat3 axes;
    for (int column = 0; column < 3; ++column) {
        for (int row = 0; row < 3; ++row) axes(row, column) = transform[4 * column + row];
    }
    return axes;
}

}  // namespace

DeviceStatus status_of(Trouble::Kind kind) {
    switch (kind) {
        case Trouble::Kind::none:
            return DeviceStatus::ready;
        case Trouble::Kind::needs_update:
        case Trouble::Kind::needs_person:
            return DeviceStatus::uncalibrated;
        case Trouble::Kind::lost:
        case Trouble::Kind::loop_ended:
            return DeviceStatus::lost;
        case Trouble::Kind::not_a_position:
        case Trouble::Kind::not_a_rotation:
        case Trouble::Kind::passing:
        case Trouble::Kind::broken:
        case Trouble::Kind::unlicensed:
            break;
    }
    return DeviceStatus::fault;
}

unsigned int Frames::callback(void* frames) {
    return static_cast<Frames*>(frames)->frame();
}

Trouble Frames::trouble() const {
    return trouble_.get();
}

unsigned int Frames::frame() noexcept {
    const bool last = end_.load() || for_good();
    const std::int64_t begun = setup_.now();
    hd_.begin_frame(setup_.device);
    DeviceReading reading;
    Trouble trouble = read_device(reading);

    std::int64_t now = setup_.now();
    if (error_.kind == Trouble::Kind::passing && now >= error_until_) {
        error_ = {};
        force_output(true);
    }
    if (error_.kind != Trouble::Kind::none) trouble = error_;
    gate_.note(trouble.kind == Trouble::Kind::none && !last, now);
    const Wrench wanted = link_.wrench(now);
    const Vec3 force = gate_.pass(wanted.force, force_limit_, now);
    hd_.set_double(parameter::force, force.data());
    if (setup_.most_torque > 0) {
        const Vec3 torque = gate_.pass(wanted.torque, setup_.most_torque, now);  // N mm are mN m
        hd_.set_double(parameter::torque, torque.data());
    }
    hd_.end_frame(setup_.device);

    take_errors();
    guard_motors(now);
    if (error_.kind != Trouble::Kind::none) trouble = error_;
    now = setup_.now();
    reading.age = 1e-9 * static_cast<double>(now - begun);
    trouble_.report(link_, trouble, reading, now);
    if (trouble.kind == Trouble::Kind::needs_update && now >= next_update_) {
        next_update_ = now + between_updates;
        hd_.update_calibration(setup_.styles & automatic ? automatic : inkwell);
        hd_.take_error();  // a refused update leaves it uncalibrated
    }
    if (!last) return callback_again;
    ended_.store(true);
    return callback_done;
}

Trouble Frames::read_device(DeviceReading& reading) noexcept {
    constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
    double position[3] = {unknown, unknown, unknown};
    double transform[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    int buttons = 0;
    hd_.get_double(parameter::position, position);
    hd_.get_double(parameter::transform, transform);
    hd_.get_int(parameter::buttons, &buttons);
    reading.position = Vec3(position[0], position[1], position[2]);
    const Mat3 orientation = orientation_of(transform);
    const bool turned = !setup_.has_orientation || is_rotation(orientation, orientation_tolerance);
    if (setup_.has_orientation && turned) reading.orientation = orientation;
    reading.buttons = static_cast<std::uint32_t>(buttons) & 0xFU;

    const unsigned int calibration = hd_.check_calibration();
    if (calibration != calibrated) {
        // An update moves nothing, but it shifts the positions, so there is no force while one is
        // due. Zeroing encoders is right in one pose only and is never done unasked.
        const bool by_itself = (setup_.styles & (automatic | inkwell)) != 0;
        return {calibration == needs_update && by_itself ? Trouble::Kind::needs_update
                                                         : Trouble::Kind::needs_person,
                0};
    }
    if (!is_position(reading.position)) return {Trouble::Kind::not_a_position, 0};
    return {turned ? Trouble::Kind::none : Trouble::Kind::not_a_rotation, 0};
}

bool Frames::for_good() const noexcept {
    switch (error_.kind) {
        case Trouble::Kind::lost:
        case Trouble::Kind::broken:
        case Trouble::Kind::loop_ended:
        case Trouble::Kind::unlicensed:
            return true;
        default:
            return false;
    }
}

void Frames::take_errors() noexcept {
    for (int i = 0; i < Hd::most_errors; ++i) {
        const unsigned int code = hd_.get_error().code;
        if (code == 0) return;
        note_error(code);
    }
}

void Frames::note_error(unsigned int code) noexcept {
    error_until_ = setup_.now() + error_lasts;
    if (!for_good()) error_ = trouble_of(code);
    force_output(false);
}

/// As the vendor's sample PreventWarmMotors: the force falls to what the device can render for
/// hours. Before that the servo's own estimate does the same (MotorHeat), with every driver.
void Frames::guard_motors(std::int64_t now) noexcept {
    if (!tells_temperature_ || now < guarded_ + between_readings) return;
    guarded_ = now;
    std::array<double, most_motors> motors{};
    hd_.get_double(parameter::motor_temperature, motors.data());
    const unsigned int code = hd_.take_error();
    tells_temperature_ = !is_unknown_parameter(code);
    if (code != 0) {
        if (tells_temperature_) note_error(code);
        return;
    }
    // A temperature that is no number counts as too hot.
    const bool are_numbers =
        std::ranges::all_of(motors, [](double one) { return std::isfinite(one); });
    const double hottest = are_numbers ? std::ranges::max(motors) : 1;
    const double warm = std::clamp((hottest - 0.5) / 0.2, 0., 1.);
    force_limit_ = setup_.most_force + warm * (setup_.continuous_force - setup_.most_force);
    warm_limit_.store(force_limit_ < setup_.most_force ? force_limit_ : 0);
}

void Frames::force_output(bool on) noexcept {
    if (on == force_output_) return;
    force_output_ = on;
    if (on) {
        hd_.enable(openhaptics::force_output);
    } else {
        hd_.disable(openhaptics::force_output);
    }
}

}  // namespace palpate::devices::openhaptics
