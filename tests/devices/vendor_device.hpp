// A fixture for backends of a vendor's library, on a stand-in for it that is stepped in virtual
// time: opening the device, pressing, and the time that its answers take.
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <memory>
#include <mutex>
#include <string>

#include "devices/stand_in.hpp"
#include "devices/stepped_device.hpp"
#include "devices/vendor_library.hpp"
#include "palpate/devices/devices.hpp"
#include "support/scratch_folder.hpp"

namespace palpate::devices {

using namespace std::chrono_literals;
using support::any_scene;
using support::contains;
using support::message_of;
using support::pass;

/// A stand-in whose device was just plugged in. `function` is that of its library which gives it.
template <class State>
support::StandIn<State>* plugged_in(const char* library, const char* function) {
    support::StandIn<State>* (*plug_in)() = nullptr;
    VendorLibrary({library}, "build it").need(plug_in, function);
    support::StandIn<State>* const stand_in = plug_in();
    const std::lock_guard lock(stand_in->mutex);
    stand_in->state = {};
    return stand_in;
}

template <class State>
class VendorDevice : public support::SteppedDevice {
  protected:
    struct Pace {
        Time step;               ///< of the device's thread
        Time soon;               ///< until a change shows
        Time felt;               ///< until a force passes
        double rounding = 1e-9;  ///< of forces [N] and torques [N mm]
    };
    /// `plug_in` is the stand-in's function that gives it.
    VendorDevice(std::string name, const char* plug_in, const Pace& pace)
        : soon(pace.soon),
          felt(pace.felt),
          name_(std::move(name)),
          plug_in_(plug_in),
          pace_(pace) {}

    virtual std::unique_ptr<Device> open_for(const DeviceChoice& choice,
                                             const DeviceScene& scene) = 0;
    /// [N] as the device gives it, in our axes.
    virtual Vec3 force() const = 0;
    /// [N mm] the same.
    virtual Vec3 torque() const { return Vec3::Zero(); }

    /// From now on there is no such library.
    void use_nothing(const char* library) { library_ = library; }
    void use(const char* library) {
        library_ = library;
        stand_in_ = plugged_in<State>(library, plug_in_);
    }
    DeviceChoice choice(const std::string& options = "") const {
        return parse_device(name_ + ":library=" + library_ + options);
    }
    std::unique_ptr<Device> open(const std::string& options = "", double rate = 1000,
                                 const OnProgress& progress = {}) {
        DeviceScene scene = any_scene(rate);
        scene.progress = progress;
        return open_for(choice(options), scene);
    }
    std::string refusal(const std::string& options = "") {
        return message_of<DeviceError>([&] { open(options); });
    }
    /// Of the stand-in, its lock held.
    template <class F>
    auto with(F act) const {
        const std::lock_guard lock(stand_in_->mutex);
        return act(stand_in_->state);
    }

    bool becomes(Device& device, DeviceStatus status) { return becomes(device, status, soon); }
    bool becomes(Device& device, DeviceStatus status, Time time) {
        return within(time, [&] { return device.read(0).status == status; });
    }
    bool has_no_problem(Device& device) {
        return within(soon, [&] { return device.problem().empty(); });
    }
    bool says(Device& device, const std::string& words) {
        return within(soon, [&] { return contains(device.problem(), words); });
    }
    bool gives(const Wrench& wrench) const {
        return (force() - wrench.force).norm() <= pace_.rounding &&
               (torque() - wrench.torque).norm() <= pace_.rounding;
    }
    /// Writes a wrench until the device gives it, or the one that it is cut to.
    bool is_given(Device& device, const Wrench& wrench, const Wrench& cut, Time time) {
        return within(
            time, [&] { return gives(cut); }, [&] { device.write(wrench, 0); });
    }
    bool presses(Device& device, const Vec3& newtons = Vec3(1, 2, 0)) {
        return is_given(device, {newtons}, {newtons}, felt);
    }
    bool turns(Device& device, const Vec3& newton_mm = Vec3(10, 20, 30)) {
        const Wrench wrench{Vec3(1, 0.5, 0), newton_mm};
        return is_given(device, wrench, wrench, felt);
    }
    bool is_zero() const { return force().isZero(0) && torque().isZero(0); }
    /// No force from the next step on, for a while, whatever is asked for.
    bool stays_at_zero(Device& device) {
        return throughout(
            100ms, [&] { return is_zero(); },
            [&] {
                device.write({Vec3(1, 1, 1), Vec3(1, 1, 1)}, 0);
            });
    }
    /// Nothing is written any more: the force ends when the last one is older than 20 ms, not
    /// before.
    bool goes_to_zero_in_silence() {
        return throughout(20ms, [&] { return !is_zero(); }) &&
               within(pace_.step, [&] { return is_zero(); });
    }

    const Time soon, felt;

  private:
    const std::string name_;
    const char* const plug_in_;
    const Pace pace_;
    std::string library_;
    support::StandIn<State>* stand_in_ = nullptr;
};

}  // namespace palpate::devices
