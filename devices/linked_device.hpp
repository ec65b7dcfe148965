// A device whose own thread exchanges readings and forces with the servo.
#pragma once

#include <algorithm>
#include <atomic>
#include <exception>

#include "devices/link.hpp"

namespace palpate::devices {

/// The servo's side of such a device. Its thread uses the Link.
class LinkedDevice : public Device {
  public:
    DeviceReading read(double) noexcept final { return link_.read(timing_.now()); }
    void write(const Wrench& wrench, double) noexcept final { link_.write(wrench, timing_.now()); }
    void stop() noexcept final { link_.stop(); }
    bool is_stopping() const noexcept override { return link_.stopping(); }

  protected:
    explicit LinkedDevice(const Timing& timing = {}) : timing_(timing) {}

    const Timing timing_;
    Link link_;
};

/// What the thread of a backend does: a step every `period` [ns] until it is to quit. Steps that
/// are late are left out, not made up for. One that throws, mostly for want of memory, is tried
/// again.
void keep_stepping(std::int64_t period, const Timing& timing, const std::atomic<bool>& quit,
                   auto&& step) {
    prepare_device_thread();
    std::int64_t next = timing.now();
    while (!quit) {
        try {
            step();
        } catch (const std::exception&) {
        }
        next = std::max(next + period, timing.now());
        timing.sleep_until(next);
    }
}

}  // namespace palpate::devices
