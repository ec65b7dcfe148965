// A device whose reading and writing are functions of the C interface's caller, on a thread of its
// own.
#pragma once

#include <atomic>
#include <optional>
#include <string>
#include <thread>

#include "devices/claim.hpp"
#include "devices/linked_device.hpp"
#include "palpate-c/palpate.h"

namespace palpate::c {

class OwnDevice final : public devices::LinkedDevice {
  public:
    /// Throws std::invalid_argument for numbers that no device has, DeviceError for a device that
    /// serves another run, std::system_error without a thread.
    explicit OwnDevice(const palpate_own_device& asked);
    /// Waits for a callback that runs.
    ~OwnDevice() override;

    DeviceInfo info() const override { return info_; }
    std::string problem() const override;

  private:
    void run() noexcept;
    void exchange() noexcept;

    const palpate_own_device callbacks_;
    DeviceInfo info_;
    std::optional<devices::Claim> claim_;
    std::atomic<bool> lost_{false}, done_{false};
    std::thread thread_;  // last: it uses all of the above
};

/// "own" where the caller gave no name.
std::string name_of(const palpate_own_device& asked);

}  // namespace palpate::c
