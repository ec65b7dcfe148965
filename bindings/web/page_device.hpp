// The device of a web page: readings come in by message, and the page draws the force or sends it
// on. May use the core only.
#pragma once

#include "palpate/device.hpp"

namespace palpate::web {

class PageDevice : public Device {
  public:
    explicit PageDevice(DeviceInfo info) : info_(std::move(info)) {}

    DeviceInfo info() const override { return info_; }
    DeviceReading read(double) override {
        DeviceReading reading = newest;
        // Both clocks are rounded, and a page and its worker do not agree exactly on the time.
        const double age = now - measured;
        reading.age = age < 0 && age > -clock_tolerance ? 0 : age;
        return reading;
    }
    void write(const Wrench& wrench, double) override { force = stopped_ ? Wrench{} : wrench; }
    void stop() noexcept override {
        stopped_ = true;
        force = {};
    }

    DeviceReading newest;
    double measured = 0;  ///< [s] when, by the page's clock
    double now = 0;       ///< [s] of this tick, by the same clock
    Wrench force;         ///< as the servo left it

  private:
    static constexpr double clock_tolerance = 0.005;  // [s]

    DeviceInfo info_;
    bool stopped_ = false;
};

}  // namespace palpate::web
