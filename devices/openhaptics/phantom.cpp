// Attaches to the driver, asks for the device's abilities, and starts and stops the driver's servo
// loop. Also its messages about problems.
#include "devices/openhaptics/phantom.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <list>
#include <utility>
#include <vector>

#include "devices/models.hpp"

namespace palpate::devices::openhaptics {
namespace {

constexpr double weakest_torque = 48;  // [N mm] where the driver tells none
// [ns] For the last frame; between looks for it.
constexpr std::int64_t longest_wait = 500'000'000, between_looks = 1'000'000;

/// The driver's figures where they make sense, otherwise those of an Omni or Touch.
double number(const Hd& hd, unsigned int parameter, double low, double high, double otherwise) {
    double value = std::numeric_limits<double>::quiet_NaN();
    hd.get_double(parameter, &value);
    hd.take_error();
    return value >= low && value <= high ? value : otherwise;
}

int whole_number(const Hd& hd, unsigned int parameter, int low, int high, int otherwise) {
    int value = std::numeric_limits<int>::min();
    hd.get_int(parameter, &value);
    hd.take_error();
    return value >= low && value <= high ? value : otherwise;
}

std::string text(const Hd& hd, unsigned int parameter) {
    const char* words = hd.get_string(parameter);
    hd.take_error();
    return words ? words : "";
}

void set_workspace(const Hd& hd, DeviceInfo& info) {
    double box[6];
    std::fill(std::begin(box), std::end(box), std::numeric_limits<double>::quiet_NaN());
    hd.get_double(parameter::usable_workspace, box);
    hd.take_error();
    const Vec3 low(box[0], box[1], box[2]), high(box[3], box[4], box[5]);
    const Vec3 size = high - low;
    const bool sensible =
        is_position(low) && is_position(high) && size.minCoeff() >= 10 && size.maxCoeff() <= 2000;
    const Model& touch = model_named("Touch");
    const Vec3 corner = 0.5 * Vec3(touch.width, touch.height, touch.depth);
    info.workspace_low = sensible ? low : Vec3(-corner);
    info.workspace_high = sensible ? high : corner;
}

/// Frames that a driver which did not answer at the end may still call.
std::list<std::shared_ptr<Frames>>& kept_frames() {
    static auto& kept = *new std::list<std::shared_ptr<Frames>>;
    return kept;
}

DeviceInfo ask(const Hd& hd, double servo_rate) {
    DeviceInfo info;
    const Model& least = model_named("Touch");
    info.name = "openhaptics";
    info.model = text(hd, parameter::model);
    const std::string serial = text(hd, parameter::serial_number);
    if (info.model.empty()) info.model = "OpenHaptics device";
    if (!serial.empty()) info.model += ", serial number " + serial;
    const double most = number(hd, parameter::nominal_max_force, 0.1, 50, least.force);
    info.stiffness = number(hd, parameter::nominal_max_stiffness, 0.05, 10, least.stiffness);
    // The slower of the two loops is the one that samples.
    const int rate = whole_number(hd, parameter::update_rate, 100, 10000, 1000);
    info.limits = limits_of(least, std::min<double>(servo_rate, rate), exchange_delay(1.0 / rate));
    info.limits.maximum_force = most;
    // Devices on the market can render a sixth of their greatest force for hours, or more.
    info.limits.continuous_force =
        number(hd, parameter::continuous_force, 0.01 * most, most, most / 6);
    set_workspace(hd, info);
    info.has_orientation = whole_number(hd, parameter::input_dof, 1, 7, 6) >= 6;
    info.renders_torque =
        info.has_orientation && whole_number(hd, parameter::output_dof, 1, 7, 3) >= 6;
    if (info.renders_torque) {
        info.limits.maximum_torque =
            number(hd, parameter::nominal_max_torque, 1, 1000, weakest_torque);
    }
    info.buttons = 4;  // as many as the interface has bits
    return info;
}

const char* advice(unsigned int code) {
    switch (code) {
        case error::warm_motors:
            return "let go and wait until the motors have cooled down; there is no force meanwhile";
        case error::exceeded_force:
        case error::exceeded_impulse:
        case error::exceeded_velocity:
        case error::force_error:
            return "force is off for a second; if this happens again, lower the stiffness or move "
                   "more slowly";
        case error::invalid_license:
            return "OpenHaptics has no valid licence here: install one with the vendor's License "
                   "Manager, then start again";
        default:
            return "force is off until a second after it was last reported";
    }
}

}  // namespace

Claim claim_for(const Settings&) {
    return Claim("the only device that the driver opens per process");
}

Attachment::Attachment(const Hd& hd, Claim claim, const std::string& name)
    : claim_(std::move(claim)), hd_(std::make_shared<const Hd>(hd)) {
    std::vector<const char*> names{name.c_str()};
    if (name.empty()) names = {nullptr, "Default Device", "Default PHANToM"};
    std::string tried;
    for (const char* one : names) {
        hd_->take_error();
        device_ = hd_->init_device(one);
        const unsigned int code = hd_->take_error();
        if (device_ != no_handle && code == 0) return;
        if (device_ != no_handle) hd_->disable_device(device_);
        tried += (tried.empty() ? "" : "; ") + std::string("device ") +
                 (one ? "'" + std::string(one) + "'" : "NULL") + ": " +
                 (code ? hd_->error_words(code) : "no error told");
        if (code == error::invalid_license) tried += std::string(": ") + advice(code);
    }
    throw DeviceError("the driver gives no device (" + tried + "): " + words().how_to_attach);
}

Attachment::~Attachment() {
    hd_->make_current(device_);
    hd_->disable(force_output);
    hd_->disable_device(device_);
    hd_->take_error();
}

Phantom::Phantom(const Hd& library, Claim claim, const Settings& settings, const Timing& timing)
    : timing_(timing), attachment_(library, std::move(claim), settings.name) {
    const Hd& hd = attachment_.hd();
    hd.make_current(attachment_.device());
    check("hdMakeCurrentDevice");
    info_ = ask(hd, settings.rate);
    styles_ = static_cast<unsigned int>(whole_number(hd, parameter::calibration_style, 0, 7, 0));
    if (settings.reset) {
        if (!(styles_ & encoder_reset)) {
            throw DeviceError("reset=yes: the encoders of this device cannot be zeroed; leave it");
        }
        hd.update_calibration(encoder_reset);
        check("zeroing the encoders");
    }
    frames_ = std::make_shared<Frames>(
        attachment_.shared_hd(),
        Frames::Setup{attachment_.device(), info_.limits.maximum_force,
                      info_.limits.continuous_force, info_.limits.maximum_torque,
                      info_.has_orientation, styles_, timing_.now});
    kept_.push_back(frames_);
    kept_frames();
    try {
        start();
    } catch (...) {
        end_loop();
        throw;
    }
}

Phantom::~Phantom() {
    end_loop();
}

void Phantom::start() {
    const Hd& hd = attachment_.hd();
    hd.enable(force_output);
    check("switching on its force");
    scheduled_ = hd.schedule(&Frames::callback, frames_.get(), highest_priority);
    is_scheduled_ = true;
    check("hdScheduleAsynchronous");
    hd.start_scheduler();
    check("starting the driver's servo loop");
}

void Phantom::end_loop() noexcept {
    if (!is_scheduled_) return;
    const Hd& hd = attachment_.hd();
    frames_->link().stop();
    frames_->end();
    const std::int64_t until = timing_.now() + longest_wait;
    while (!frames_->ended() && timing_.now() < until) {
        timing_.sleep_until(timing_.now() + between_looks);
    }
    hd.stop_scheduler();
    hd.unschedule(scheduled_);
    is_scheduled_ = false;
    if (frames_->ended()) return;
    kept_frames().splice(kept_frames().end(), kept_);
}

void Phantom::check(const char* step) const {
    const Hd& hd = attachment_.hd();
    const unsigned int code = hd.take_error();
    if (code) throw DeviceError(std::string(step) + ": the driver says " + hd.error_words(code));
}

std::string Phantom::calibration_words(Trouble::Kind kind) const {
    if (kind == Trouble::Kind::needs_update) {
        return "the driver is bringing its calibration up to date; if that does not end, move the "
               "device about or put the stylus into its inkwell";
    }
    if (styles_ & inkwell) {
        return "not calibrated: put the stylus into its inkwell for a moment; if that does not "
               "help, calibrate it with the vendor's program";
    }
    if (styles_ & automatic) return "not calibrated: move the device through its whole workspace";
    if (styles_ & encoder_reset) {
        return "not calibrated: hold the arm in its reset pose (all links at right angles) and "
               "open it again with reset=yes";
    }
    return "not calibrated: calibrate it with the vendor's program";
}

std::string Phantom::problem() const {
    const Trouble trouble = frames_->trouble();
    const auto driver_says = [&](const char* do_this) {
        return "the driver reports " + attachment_.hd().error_words(trouble.code) + ": " + do_this;
    };
    switch (trouble.kind) {
        case Trouble::Kind::needs_update:
        case Trouble::Kind::needs_person:
            return calibration_words(trouble.kind);
        case Trouble::Kind::not_a_position:
            return "the driver tells a position that cannot be: calibrate the device, or switch it "
                   "off and on";
        case Trouble::Kind::not_a_rotation:
            return "the driver tells an orientation that cannot be: calibrate the device, or "
                   "switch it off and on";
        case Trouble::Kind::passing:
            return driver_says(advice(trouble.code));
        case Trouble::Kind::loop_ended:
            return driver_says("the driver's servo loop has ended: start again");
        case Trouble::Kind::unlicensed:
            return driver_says(advice(trouble.code));
        case Trouble::Kind::lost:
            return driver_says("no force any more; check cable and power, then start again");
        case Trouble::Kind::broken:
            return driver_says("no force any more; switch the device off and on, then start again");
        case Trouble::Kind::none:
            break;
    }
    switch (frames_->link().read(timing_.now()).status) {
        case DeviceStatus::starting:
            return "the driver's servo loop has not reported a position yet";
        case DeviceStatus::stale:
            return "the driver's servo loop stands still or is too slow: its last position is more "
                   "than 20 ms old; it may still hold the last force, which no other thread can "
                   "remove: if that lasts, switch the device off";
        default:
            break;
    }
    const double limit = frames_->warm_limit();
    if (limit == 0) return {};
    std::array<char, 120> words{};
    std::snprintf(words.data(), words.size(),
                  "the motors are warm: its force is limited to %.1f N until they have cooled",
                  limit);
    return words.data();
}

}  // namespace palpate::devices::openhaptics
