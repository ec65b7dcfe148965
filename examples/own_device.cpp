// Your own device: implement four functions, and a servo runs it at 1 kHz. This device is a mass of
// 100 g on a guide that falls onto the isosurface and comes to rest there.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <thread>
#include <vector>

#include "palpate/palpate.hpp"

using namespace palpate;

class FallingMass : public Device {
  public:
    DeviceInfo info() const override {
        DeviceInfo info;
        info.name = "falling mass";
        info.limits.maximum_force = 20;                 // N
        info.limits.physical_damping = 1e-3 * damping;  // N s/mm
        return info;
    }
    // Both run on the servo thread: no waiting, no allocation, no exception.
    DeviceReading read(double time) noexcept override {
        time_ = std::max(time_, time - 0.05);  // after a stall of the machine
        for (; time_ < time; time_ += step) {
            const double force = stopped_ ? 0 : force_;  // N; whatever was written last
            speed_ += step * ((force - damping * speed_) / mass - 9.81);  // m/s
            height_ += step * speed_ * 1000;                              // mm
        }
        DeviceReading reading;
        reading.position = {0, height_, 0};
        reading.status = DeviceStatus::ready;
        return reading;
    }
    void write(const Wrench& wrench, double) noexcept override { force_ = wrench.force[1]; }
    void stop() noexcept override { stopped_ = true; }

  private:
    static constexpr double step = 1e-4;   // s
    static constexpr double mass = 0.1;    // kg
    static constexpr double damping = 20;  // N s/m: it falls in oil, and so bears late forces
    double time_ = 0, height_ = 8, speed_ = 0, force_ = 0;
    std::atomic<bool> stopped_{false};
};

int main() {
    // Density falls with height: the level 0 is a floor at z = 0, and the device's y is up there.
    Geometry geometry;
    geometry.size = {32, 32, 32};
    geometry.origin = {-15.5, -15.5, -15.5};
    std::vector<float> samples;
    for (int k = 0; k < 32; ++k)
        samples.insert(samples.end(), 32 * 32, 15.5F - static_cast<float>(k));
    FallingMass device;
    RendererSettings settings;
    settings.force.stiffness = 1;  // N/mm
    settings.force.limit = 20;     // N
    settings.device = device.info().limits;
    settings.transform = fit_workspace(geometry, device.info());
    settings.transform.scale = 1;
    const Field field(Volume(geometry, std::move(samples)));
    Servo servo(Session{make_renderer(field, 0.0, settings), {}}, device);
    servo.start();
    // Until the spring of 1 N/mm carries the weight of 0.98 N.
    for (double height = 8, force = 0; std::abs(height + 0.98) + std::abs(force - 0.98) > 0.02;) {
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
        const auto now = servo.snapshot();
        if (!now) continue;
        height = now->session.tick.proxy.hip[2];
        force = now->session.tick.force.norm();
        std::printf("%.2f s  height %6.2f mm  force %.2f N\n", now->session.tick.time, height,
                    force);
    }
    servo.stop();
    const LatencySummary compute = servo.report().compute;
    std::printf("compute time a tick: p50 %.1f us, p99 %.1f us\n", 1e-3 * double(compute.p50),
                1e-3 * double(compute.p99));
}
