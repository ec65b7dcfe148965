// A device for tests: its readings are a function of time, its forces are stored, and its limits
// can be chosen.
#pragma once

#include <array>
#include <atomic>
#include <functional>

#include "palpate/device.hpp"

namespace palpate::support {

class ScriptedDevice : public Device {
  public:
    explicit ScriptedDevice(std::function<DeviceReading(double)> script,
                            const DeviceLimits& limits = {})
        : script_(std::move(script)) {
        info_.limits = limits;
    }

    DeviceInfo info() const override { return info_; }
    DeviceReading read(double time) noexcept override {
        reads_.fetch_add(1);
        return script_(time);
    }
    void write(const Wrench& wrench, double) noexcept override {
        const auto& [force, torque] = wrench;
        for (std::size_t a = 0; a < 3; ++a) force_[a].store(force[static_cast<int>(a)]);
        const double most = most_.load();
        if (force.norm() > most) most_.store(force.norm());
        if (torque.norm() > most_torque_.load()) most_torque_.store(torque.norm());
        writes_.fetch_add(1);
    }
    void stop() noexcept override { stopped_ = true; }

    Vec3 force() const {
        if (stopped_) return Vec3::Zero();
        return {force_[0].load(), force_[1].load(), force_[2].load()};
    }
    double largest_force() const { return most_.load(); }
    double largest_torque() const { return most_torque_.load(); }
    std::int64_t reads() const { return reads_.load(); }
    std::int64_t writes() const { return writes_.load(); }

  private:
    std::function<DeviceReading(double)> script_;
    DeviceInfo info_;
    std::array<std::atomic<double>, 3> force_{};
    std::atomic<double> most_{0}, most_torque_{0};
    std::atomic<std::int64_t> reads_{0}, writes_{0};
    std::atomic<bool> stopped_{false};
};

inline DeviceReading ready_at(const Vec3& position) {
    DeviceReading reading;
    reading.position = position;
    reading.status = DeviceStatus::ready;
    return reading;
}

}  // namespace palpate::support
