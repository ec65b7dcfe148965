// The real renderer and a simulated device in a loop at fixed times: what the servo thread does,
// without a clock.
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>

#include "devices/simulated/simulated.hpp"
#include "palpate/renderer.hpp"
#include "palpate/scenes/volumes.hpp"

namespace palpate::devices {

/// The sphere of scenes/, fitted into the device's workspace.
struct Body {
    scenes::Scene scene = scenes::make_volume("sphere");
    Field field = linear_field(scene.volume);

    DeviceScene at_rate(double rate) const {
        return {field, scene.isovalue, rate,
                [this](const DeviceInfo& info) { return fit_workspace(field.geometry(), info); }};
    }
    std::unique_ptr<Device> open(const std::string& device, double rate = 1000) const {
        return open_simulated(parse_device("simulated:" + device), at_rate(rate));
    }
};

/// How much something moved: from the least to the greatest.
struct Range {
    Vec3 low = Vec3::Constant(1e300), high = Vec3::Constant(-1e300);
    void add(const Vec3& v) {
        low = low.cwiseMin(v);
        high = high.cwiseMax(v);
    }
    double greatest() const { return (high - low).maxCoeff(); }
};

struct Held {
    Range position, force;  ///< over the last second, as read and as commanded
    double push = 0;        ///< [N] at the end
    bool constrained = false;
};

/// Presses with this stiffness [N/mm] for `seconds`, at the servo rate of the device's limits.
/// `unchecked` raises the limits first, for stiffnesses that check() would refuse: some devices
/// rest at their rated stiffness in a light grip, although that is not passive with their delay.
inline Held press(const Body& body, Device& device, double stiffness, double seconds,
                  bool unchecked = false) {
    const DeviceInfo info = device.info();
    RendererSettings settings;
    settings.transform = fit_workspace(body.field.geometry(), info);
    settings.device = info.limits;
    if (unchecked) settings.device.physical_damping = 1;
    settings.force.stiffness = stiffness;
    settings.force.limit = info.limits.maximum_force;
    Renderer renderer = make_renderer(body.field, body.scene.isovalue, settings);
    Held held;
    const double rate = info.limits.rate;
    const int ticks = static_cast<int>(seconds * rate);
    for (int i = 0; i < ticks; ++i) {
        const double time = i / rate;
        const DeviceReading reading = device.read(time);
        const bool ready = reading.status == DeviceStatus::ready;
        const Tick tick =
            render(renderer, {.time = time, .position = reading.position, .valid = ready});
        device.write({tick.force}, time);
        held.push = tick.force.norm();
        held.constrained = tick.proxy.mode == Mode::constrained;
        if (time < seconds - 1) continue;
        held.position.add(reading.position);
        held.force.add(tick.force);
    }
    return held;
}

}  // namespace palpate::devices
