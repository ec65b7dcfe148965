// A device whose reading and writing are functions of the C interface's caller, on a thread of its
// own.
#pragma once

#include <memory>
#include <string>
#include <thread>

#include "palpate-c/palpate.h"
#include "palpate/device.hpp"

namespace palpate::c {

class OwnDevice final : public Device {
  public:
    /// Throws std::invalid_argument for numbers that no device has, DeviceError for a device that
    /// serves another run, std::system_error without a thread.
    explicit OwnDevice(const palpate_own_device& asked);
    /// Waits half a second for a callback that runs. One that hangs is left alone with its thread,
    /// which writes a zero and closes the device when the callback returns.
    ~OwnDevice() override;

    DeviceInfo info() const override;
    std::string problem() const override;
    DeviceReading read(double time) override;
    void write(const Wrench& wrench, double time) override;
    void stop() noexcept override;
    bool is_stopping() const noexcept override;

  private:
    class Served;
    std::shared_ptr<Served> served_;  // the thread's as well
    std::thread thread_;
};

/// "own" where the caller gave no name.
std::string name_of(const palpate_own_device& asked);

}  // namespace palpate::c
