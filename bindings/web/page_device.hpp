// The device of a web page: readings come in by message, and the page draws the force or sends it
// on. A device with a connection of its own renders only while the page shows signs of life. May
// use the core and devices.
#pragma once

#include <memory>
#include <utility>

#include "devices/haply/inverse3.hpp"
#include "palpate/device.hpp"

namespace palpate::web {

class PageDevice : public Device {
  public:
    explicit PageDevice(DeviceInfo info) : info_(std::move(info)) {}
    /// A native device without a thread of its own.
    explicit PageDevice(std::unique_ptr<Device> native) : native_(std::move(native)) {}
    explicit PageDevice(std::unique_ptr<devices::haply::Inverse3> inverse3)
        : native_(std::move(inverse3)),
          connected_(static_cast<devices::haply::Inverse3*>(native_.get())) {}

    DeviceInfo info() const override { return native_ ? native_->info() : info_; }
    std::string problem() const override { return native_ ? native_->problem() : ""; }
    DeviceReading read(double time) override {
        // Both clocks are rounded, and a page and its worker do not agree exactly on the time.
        double age = now - measured;
        if (age < 0 && age > -clock_tolerance) age = 0;
        if (!native_) {
            DeviceReading reading = newest;
            reading.age = age;
            return reading;
        }
        DeviceReading reading = native_->read(time);
        const bool silent = newest.status == DeviceStatus::lost || !(age < longest_silence);
        if (connected_ && (silent || age < 0)) reading.status = DeviceStatus::stale;
        return reading;
    }
    void write(const Wrench& wrench, double time) override {
        force = stopped_ ? Wrench{} : wrench;
        if (native_) native_->write(force, time);
    }
    void stop() noexcept override {
        stopped_ = true;
        force = {};
        if (native_) native_->stop();
    }

    /// Exchanges messages with the device, if it has a connection.
    void exchange() {
        // Each step is an answer or a question, or finds nothing to do.
        for (int i = 0; connected_ && i < 4; ++i) connected_->step();
    }

    DeviceReading newest;  ///< of the page. With a connection, only a sign of life
    double measured = 0;   ///< [s] when, by the page's clock
    double now = 0;        ///< [s] of this tick, by the same clock
    Wrench force;          ///< as the servo left it

  private:
    static constexpr double clock_tolerance = 0.005;  // [s]
    static constexpr double longest_silence = 0.08;   // [s] of a page that is not blocked

    DeviceInfo info_;
    std::unique_ptr<Device> native_;
    devices::haply::Inverse3* connected_ = nullptr;  // the same, if it has a connection
    bool stopped_ = false;
};

}  // namespace palpate::web
