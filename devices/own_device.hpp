// A device whose functions belong to an application: callbacks in C, an object in Python. They are
// called by a thread of their own and may hang, so that thread may outlive the device.
#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <thread>

#include "devices/claim.hpp"
#include "devices/link.hpp"

namespace palpate::devices {

/// The functions of the application, and what their thread needs. The thread owns this, too.
class OwnFunctions {
  public:
    /// `rate` [Hz]: how often they are called. `device` tells it from all others of the process.
    /// Throws DeviceError for a device that serves another run.
    OwnFunctions(DeviceInfo info, double rate, std::string device);
    virtual ~OwnFunctions() = default;

    /// Any thread.
    virtual std::string problem() const = 0;

  protected:
    // The thread calls these. What they throw ends the program.

    virtual void begin() {}
    /// Reports a reading to link_, and passes on its wrench.
    virtual void exchange() = 0;
    /// The last call: passes on the zero, and closes the device.
    virtual void close() = 0;

    const DeviceInfo info_;
    Link link_;

  private:
    friend class OwnDevice;
    void run();

    const double rate_;
    std::optional<Claim> claim_;  // until the thread ends
    const std::function<void()> leave_ = claim_->leaving();
    std::atomic<std::thread::id> thread_;
    std::atomic<bool> quit_{false};
};

/// The device of a run. It calls the functions from its construction on.
class OwnDevice : public Device {
  public:
    /// Throws std::system_error without a thread.
    explicit OwnDevice(std::shared_ptr<OwnFunctions> functions);
    /// Waits half a second for the thread. One that hangs is left alone: it sends a zero and closes
    /// the device when the function returns.
    ~OwnDevice() override;

    /// Stops the device and has its thread end. False if that takes longer, and on that thread. One
    /// thread at a time.
    bool end(std::chrono::milliseconds longest);
    bool is_own_thread() const noexcept {
        return functions_->thread_.load() == std::this_thread::get_id();
    }

    DeviceInfo info() const override { return functions_->info_; }
    std::string problem() const override { return functions_->problem(); }
    DeviceReading read(double) noexcept override { return functions_->link_.read(monotonic_ns()); }
    void write(const Wrench& wrench, double) noexcept override {
        functions_->link_.write(wrench, monotonic_ns());
    }
    void stop() noexcept override { functions_->link_.stop(); }
    bool is_stopping() const noexcept override { return functions_->link_.stopping(); }

  private:
    std::shared_ptr<OwnFunctions> functions_;
    std::future<void> ended_;
    std::thread thread_;
};

/// The limits of a device whose functions are called so often [Hz]: springs are sampled no faster,
/// and act later by the exchange with the thread.
DeviceInfo at_rate(DeviceInfo info, double rate);

}  // namespace palpate::devices
