// Stands in for a device that is closed at the moment. Header only.
#pragma once

#include <string>
#include <utility>

#include "palpate/device.hpp"

namespace palpate::devices {

/// Reads as lost, and has no force.
class AbsentDevice final : public Device {
  public:
    /// `info`: of the device that is absent. `problem`: why, and what to do.
    AbsentDevice(DeviceInfo info, std::string problem)
        : info_(std::move(info)), problem_(std::move(problem)) {}

    DeviceInfo info() const override { return info_; }
    std::string problem() const override { return problem_; }
    DeviceReading read(double) override { return {.status = DeviceStatus::lost}; }
    void write(const Wrench&, double) override {}
    void stop() noexcept override {}

  private:
    const DeviceInfo info_;
    const std::string problem_;
};

}  // namespace palpate::devices
