// Settings of force, friction, device and penetrability, and the setup that has them all.
#include <cmath>

#include "bindings/python/bindings.hpp"
#include "bindings/python/progress.hpp"
#include "bindings/python/record.hpp"
#include "bindings/python/setup.hpp"
#include "palpate/baselines/methods.hpp"
#include "palpate/io/layers_file.hpp"
#include "palpate/io/tool_file.hpp"
#include "palpate/run/setup.hpp"

namespace palpate::python {

AskedForce::AskedForce() {
    for_each_setting<ForceSettings>([&](const auto& one) {
        if constexpr (std::same_as<decltype(one.member), double ForceSettings::*>) {
            if (*one.left_open != '\0') this->*one.member = std::nan("");
        }
    });
}

ForceSettings offline_force() {
    ForceSettings force;
    force.ramp = 0;
    force.rate_limit = std::numeric_limits<double>::infinity();
    return force;
}

ForceSettings force_of(const AskedForce& asked, const ForceSettings& usual) {
    ForceSettings force = asked;
    for_each_setting<ForceSettings>([&](const auto& one) {
        if constexpr (std::same_as<decltype(one.member), double ForceSettings::*>) {
            if (std::isnan(force.*one.member)) force.*one.member = usual.*one.member;
        }
    });
    return force;
}

void warn_of_level(const RenderSetup& setup, const Field& field, double isovalue, int calls) {
    const bool has_layers = setup.layers && !setup.layers->layers.layers.empty();
    const bool has_levels = setup.press && (setup.press->minimum || !setup.press->ranges.empty());
    if (!has_layers && !has_levels) warn(run::level_warning(field, isovalue), calls);
}

std::shared_ptr<const Tool> tool_in(const RenderSetup& setup) {
    const auto* tool = std::get_if<std::shared_ptr<Tool>>(&setup.asked_tool);
    return tool ? *tool : nullptr;
}

namespace {

io::ToolSpec spec_of(const ToolChoice& choice) {
    if (const auto* text = std::get_if<std::string>(&choice)) {
        return io::tool_spec_from(*text, ctrl_c());
    }
    const Tool& tool = *std::get<std::shared_ptr<Tool>>(choice);
    const auto points = tool.points();
    return io::PointsSpec{{points.begin(), points.end()}, tool.turns(), tool.shape()};
}

run::PenetrabilitySetup penetrability_of(const PressThrough& press) {
    if (press.ranges.empty()) return run::ThresholdSetup{press.threshold, press.minimum};
    run::RangesSetup ranges{press.threshold, {}};
    for (const auto& [low, high] : press.ranges) ranges.ranges.push_back({low, high});
    return ranges;
}

}  // namespace

run::Given given_in(const RenderSetup& setup) {
    const auto& layers = setup.layers;
    run::Given given{{"tool_spacing", setup.tool_spacing.has_value()},
                     {"minimum", setup.press && setup.press->minimum},
                     {"closing", layers && layers->layers.closing != Layers{}.closing}};
    for_each_setting<ForceSettings>([&](const auto& one) {
        const auto& value = setup.asked_force.*one.member;
        const bool differs = value != ForceSettings{}.*one.member;
        if constexpr (std::same_as<decltype(one.member), double ForceSettings::*>) {
            given[one.name] = differs && asked(value);
        } else {
            given[one.name] = differs;
        }
    });
    return given;
}

run::RenderSetup setup_of(const RenderSetup& setup, const ForceSettings& usual) {
    run::RenderSetup made = setup;
    made.force = force_of(setup.asked_force, usual);
    made.limit = asked(setup.asked_force.limit);
    made.stiffness = asked(setup.asked_force.stiffness);
    made.tool = spec_of(setup.asked_tool);
    if (setup.press) made.penetrability = penetrability_of(*setup.press);
    run::refuse_without_effect(run::without_effect(made), given_in(setup));
    return made;
}

Penetrability penetrability_for(const PressThrough& press, const Field& field, double isovalue) {
    RenderSetup setup;
    setup.press = press;
    return run::render_settings(setup_of(setup), field, isovalue).penetrability;
}

namespace {

/// A number that is None where it is left open.
void add_open(Record<AskedForce>& force, const Setting<ForceSettings, double>& one) {
    force.property(
        one.name, [one](const AskedForce& from) { return asked(from.*one.member); },
        [one](AskedForce& to, std::optional<double> value) {
            if (value) check_range(one, *value);
            to.*one.member = value.value_or(std::nan(""));
        },
        text_of(one).c_str());
}

void bind_force(py::module_& module) {
    Record<Magnet>(module, "Magnet",
                   "Pulls a free hand to a near surface: 0 at the surface, `peak` halfway.")
        .settings()
        .done();
    Record<Texture>(module, "Texture", "A bumpy surface, by turning the contact force.")
        .settings()
        .done();
    Record<AskedForce> force(
        module, "ForceSettings",
        "Force and torque from hand and proxy: f = stiffness (SCP - HIP), with limits.\n"
        "What is None depends on use and device: each field says how.");
    for_each_setting<ForceSettings>([&](const auto& one) {
        if constexpr (std::same_as<decltype(one.member), double ForceSettings::*>) {
            if (*one.left_open != '\0') return add_open(force, one);
        }
        force.setting(one);
    });
    force.done();
    Record<Friction>(module, "Friction", "Coulomb friction on the proxy's motion.")
        .settings()
        .done();
}

void bind_device_settings(py::module_& module) {
    Record<DeviceLimits>(module, "DeviceLimits", "What a device can take. Never exceeded.")
        .settings()
        .done();
    Record<DeviceTransform>(module, "DeviceTransform",
                            "The place of the device's workspace in the volume:\n"
                            "physical = translation + scale * rotation @ device.")
        .settings()
        .done()
        .def("physical", &physical_from_device, py::arg("device"),
             "The physical point [mm] of a device point [device mm].")
        .def("device", &device_from_physical, py::arg("physical"), "The inverse of physical().");
    Record<PressThrough>(module, "Penetrability",
                         "Pressing through surfaces: beyond a threshold, or from range to range.")
        .field("threshold", &PressThrough::threshold, {"PT [device mm]", ranges::limit_or_zero})
        .field("minimum", &PressThrough::minimum,
               {"Least level felt (a number or '53%'); None: the isovalue.", ranges::any})
        .field("ranges", &PressThrough::ranges,
               {"Pairs (low, high) of levels, only these are felt.", ranges::any})
        .done();
}

LayersChoice layers_given(const RenderSetup& setup) {
    if (!setup.layers) return {};
    return *setup.layers;
}
struct MakeLayers {
    std::optional<io::LayersFile> operator()(std::monostate) const { return std::nullopt; }
    std::optional<io::LayersFile> operator()(const io::LayersFile& file) const { return file; }
    std::optional<io::LayersFile> operator()(const std::filesystem::path& name) const {
        return io::layers_named(name.string(), ctrl_c());
    }
};

}  // namespace

void bind_settings(py::module_& module) {
    bind_force(module);
    bind_device_settings(module);
}

void bind_render_setup(py::module_& module) {
    using S = RenderSetup;
    Record<S>(module, "RenderSetup",
              "How to feel. What is None depends on volume and device and is filled in later.")
        .property(
            "method", [](const S& s) { return std::string(s.method.name); },
            [](S& s, const std::string& name) { s.method = run::named_method(name); },
            "The proxy method: one of methods().")
        .field("penetrability", &S::press, "Penetrability or None.")
        .property(
            "layers", &layers_given,
            [](S& s, const LayersChoice& layers) { s.layers = std::visit(MakeLayers{}, layers); },
            "Layers, the name of a built-in set, a file, or None.")
        .property(
            "tool", [](const S& s) { return s.asked_tool; },
            [](S& s, const ToolChoice& tool) {
                const auto* made = std::get_if<std::shared_ptr<Tool>>(&tool);
                if (made && !*made) {  // pybind11 takes None for any pointer
                    throw py::type_error("RenderSetup.tool must be text or Tool, not None");
                }
                spec_of(tool);  // says now what is wrong
                s.asked_tool = tool;
            },
            "A Tool, or text: 'point', 'sphere:RADIUS', 'needle', a mesh file, ... [mm]")
        .field("tool_spacing", &S::tool_spacing,
               {"Distance of a tool's points [mm]; None: half a voxel.", ranges::positive})
        .field("friction", &S::friction, "Friction or None.")
        .field("force", &S::asked_force, "ForceSettings")
        .alias("limit")
        .alias("stiffness")
        .field("step_budget", &S::step_budget,
               {"Work that an update may do, in steps through tetrahedra.", ranges::at_least_1})
        .field("scale", &S::scale,
               {"physical mm per device mm; None: fits the workspace.", ranges::scale})
        .field("rate", &S::rate,
               {"[Hz] None: 1000, live 250 with a device that renders no force.", ranges::rate})
        .done()
        .def_static(
            "offline",
            [] {
                RenderSetup setup;
                setup.asked_force.ramp = offline_force().ramp;
                setup.asked_force.rate_limit = offline_force().rate_limit;
                return setup;
            },
            "For a Renderer that renders as replay() does: no ramp, and no limit on the change\n"
            "of force.");
    module.def("methods", &baselines::method_names, "The names of all proxy methods.");
}

}  // namespace palpate::python
