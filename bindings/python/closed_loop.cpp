// A simulated device and hand in a closed loop with a renderer, as fast as possible, in arrays.
#include <cmath>

#include "bindings/python/arrays.hpp"
#include "bindings/python/bindings.hpp"
#include "bindings/python/progress.hpp"
#include "bindings/python/record.hpp"
#include "bindings/python/renderer.hpp"
#include "devices/simulated/profiles.hpp"
#include "palpate/devices/devices.hpp"

namespace palpate::python {
namespace {

using devices::DeviceProfile;

std::unique_ptr<Device> simulated(const std::string& text, const Field& field, double isovalue,
                                  double rate) {
    check_numbers("isovalue", isovalue, ranges::finite);
    check_numbers("rate", rate, ranges::rate);
    const devices::DeviceChoice choice = devices::parse_device(text);
    if (choice.name != "simulated") throw std::invalid_argument("a simulated device is needed");
    return devices::open_device(choice, {field, isovalue, rate, [&](const DeviceInfo& info) {
                                             return fit_workspace(field.geometry(), info);
                                         }});
}

struct LoopTick {
    Vec3 position;
    Quaternion orientation;
    Wrench wrench;
    bool constrained;
};

/// The force stage alone, with a contact that holds the hand's orientation straight.
Wrench straightened(ForceState& state, const Renderer& renderer, const DeviceReading& reading,
                    double time) {
    ForceInput input;
    input.time = time;
    input.constrained = true;
    input.rotational_stiffness = renderer.settings.force.rotational_stiffness;
    input.orientation = Quaternion(reading.orientation);
    input.turn = rotation_between(input.orientation, Quaternion::Identity());
    const ForceResult result =
        render_force(state, renderer.settings.force, renderer.settings.device, input);
    return {result.force, result.torque};
}

py::dict closed_loop(const SharedRenderer& renderer, const std::string& text, double seconds,
                     double rate, bool straight, const ProgressFunction& progress) {
    check_numbers("rate", rate, ranges::rate);
    check_numbers("seconds", seconds, {0, 1e8 / rate, true, "above 0, for at most 1e8 ticks"});
    if (seconds * rate < 1) throw std::invalid_argument("seconds: at least one tick is needed");
    Renderer own = renderer;
    ForceState state;
    std::vector<LoopTick> ticks(static_cast<std::size_t>(seconds * rate));
    ReportedItems slices(progress_of(progress), ticks.size(), updates_in_slice);
    {
        const GilReleased unlocked;
        const auto device = simulated(text, own.field, own.proxy.isovalue, rate);
        for (std::size_t i = 0; i < ticks.size(); ++i) {
            const double time = double(i) / rate;
            const DeviceReading reading = device->read(time);
            LoopTick& t = ticks[i];
            t = {reading.position, Quaternion(reading.orientation), {}, straight};
            if (straight) {
                t.wrench = straightened(state, own, reading, time);
            } else {
                const bool ready = reading.status == DeviceStatus::ready;
                const Tick tick =
                    render(own, {.time = time, .position = reading.position, .valid = ready});
                t.wrench = {tick.force, tick.torque};
                t.constrained = tick.proxy.mode == Mode::constrained;
            }
            device->write(t.wrench, time);
            slices.done();
        }
    }
    const auto of = [&](const auto& value) { return column(ticks, value); };
    return py::dict(
        py::arg("position") = of([](const LoopTick& t) { return t.position; }),
        py::arg("orientation_xyzw") = of([](const LoopTick& t) { return t.orientation; }),
        py::arg("force") = of([](const LoopTick& t) { return t.wrench.force; }),
        py::arg("torque") = of([](const LoopTick& t) { return t.wrench.torque; }),
        py::arg("constrained") = of([](const LoopTick& t) { return t.constrained; }));
}

py::dict dict_of(const DeviceProfile& p) {
    using py::arg;
    return py::dict(arg("encoder_step") = p.encoder_step, arg("stiffness") = p.stiffness,
                    arg("maximum_torque") = p.maximum_torque, arg("delay") = p.delay,
                    arg("angle_step") = p.angle_step);
}

}  // namespace

void bind_closed_loop(py::module_& module) {
    module.def(
        "closed_loop", &closed_loop, py::arg("renderer"), py::arg("device"), py::arg("seconds"),
        py::arg("rate"), py::arg("straight") = false, py::kw_only(),
        py::arg("progress") = py::none(),
        "A simulated device, 'simulated:touch,grip=light,hand=hold', whose workspace the grid\n"
        "fills, in a closed loop with a copy of the renderer, as fast as possible and without the\n"
        "GIL: arrays by name, position [device mm], orientation_xyzw, force [N], torque [N mm]\n"
        "and constrained. straight: in place of a surface, the rotational spring of the\n"
        "renderer's ForceSettings holds the handle straight. progress: called with the part that\n"
        "is done.");
    module.def(
        "simulated_info",
        [](const std::string& text, const Field& field, double isovalue, double rate) {
            return simulated(text, field, isovalue, rate)->info();
        },
        py::arg("device"), py::arg("field"), py::arg("isovalue"), py::arg("rate"),
        "The DeviceInfo of that device.");
    module.def(
        "simulated_profiles",
        [] {
            py::dict all;
            for (const std::string& name : devices::profile_names()) {
                all[name.c_str()] = dict_of(devices::profile(name));
            }
            return all;
        },
        "The profiles of the simulated device by name: dicts with encoder_step [mm], stiffness\n"
        "[N/mm] that it is rated for, maximum_torque [N mm], delay [s] and angle_step [rad].");
}

}  // namespace palpate::python
