// A device whose own thread exchanges readings and forces with the servo.
#pragma once

#include <algorithm>
#include <atomic>
#include <exception>
#include <thread>

#include "devices/link.hpp"

namespace palpate::devices {

/// The servo's side of such a device, and its thread, which steps.
class LinkedDevice : public Device {
  public:
    DeviceReading read(double) noexcept final { return link_.read(timing_.now()); }
    void write(const Wrench& wrench, double) noexcept final { link_.write(wrench, timing_.now()); }
    void stop() noexcept final { link_.stop(); }
    bool is_stopping() const noexcept override { return link_.stopping(); }

    /// Starts the thread.
    void start() {
        thread_ = std::thread([this] { run(); });
    }
    /// One exchange with the device. Tests call it instead.
    virtual void step() = 0;

  protected:
    /// `period` [ns] of the steps.
    LinkedDevice(const Timing& timing, std::int64_t period) : timing_(timing), period_(period) {}

    /// Waits for the next step. Steps that are late are left out, not made up for.
    virtual void wait() {
        due_ = std::max(due_ + period_, timing_.now());
        timing_.sleep_until(due_);
    }
    bool is_ending() const noexcept { return quit_; }
    /// Ends the thread, which steps until then: each destructor begins with it.
    void end_thread() {
        link_.stop();
        quit_.store(true);
        if (thread_.joinable()) thread_.join();
    }

    const Timing timing_;
    Link link_;

  private:
    void run() {
        prepare_device_thread();
        due_ = timing_.now();
        while (!quit_) {
            try {
                step();
            } catch (const std::exception&) {  // mostly for want of memory: it is tried again
            }
            wait();
        }
    }

    const std::int64_t period_;
    std::int64_t due_ = 0;  // [ns] the last step
    std::atomic<bool> quit_{false};
    std::thread thread_;
};

}  // namespace palpate::devices
