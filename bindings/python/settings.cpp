// Settings of force, friction, device and penetrability, and the setup that has them all.
#include "bindings/python/bindings.hpp"
#include "bindings/python/record.hpp"
#include "bindings/python/setup.hpp"
#include "palpate/baselines/methods.hpp"
#include "palpate/io/layers_file.hpp"
#include "palpate/io/tool_file.hpp"
#include "palpate/run/setup.hpp"

namespace palpate::python {

AskedForce::AskedForce(const ForceSettings& given)
    : ForceSettings(given),
      asked_stiffness(given.stiffness),
      asked_limit(given.limit),
      asked_rate_limit(given.rate_limit),
      asked_ramp(given.ramp),
      asked_start_below(given.start_below) {}

ForceSettings offline_force() {
    ForceSettings force;
    force.ramp = 0;
    force.rate_limit = std::numeric_limits<double>::infinity();
    return force;
}

ForceSettings force_of(const AskedForce& asked, const ForceSettings& usual) {
    ForceSettings force = asked;
    force.stiffness = asked.asked_stiffness.value_or(usual.stiffness);
    force.limit = asked.asked_limit.value_or(usual.limit);
    force.rate_limit = asked.asked_rate_limit.value_or(usual.rate_limit);
    force.ramp = asked.asked_ramp.value_or(usual.ramp);
    force.start_below = asked.asked_start_below.value_or(usual.start_below);
    return force;
}

std::shared_ptr<const Tool> tool_in(const RenderSetup& setup) {
    const auto* tool = std::get_if<std::shared_ptr<Tool>>(&setup.tool);
    return tool ? *tool : nullptr;
}

run::RenderSetup setup_of(const RenderSetup& setup, const ForceSettings& usual) {
    run::RenderSetup made = setup.given;
    made.force = force_of(setup.force, usual);
    made.limit = setup.force.asked_limit;
    made.stiffness = setup.force.asked_stiffness;
    if (const std::shared_ptr<const Tool> tool = tool_in(setup)) {
        const auto points = tool->points();
        made.tool = io::PointsSpec{{points.begin(), points.end()}, tool->turns(), tool->shape()};
    } else {
        made.tool = io::tool_spec_from(std::get<std::string>(setup.tool));
    }
    if (!setup.penetrability) return made;
    const PressThrough& press = *setup.penetrability;
    if (press.ranges.empty()) {
        made.penetrability = run::ThresholdSetup{press.threshold, press.minimum};
        return made;
    }
    run::RangesSetup ranges{press.threshold, {}};
    for (const auto& [low, high] : press.ranges) ranges.ranges.push_back({low, high});
    made.penetrability = ranges;
    return made;
}

Penetrability penetrability_for(const PressThrough& press, const Field& field, double isovalue) {
    RenderSetup setup;
    setup.penetrability = press;
    return run::render_settings(setup_of(setup), field, isovalue).penetrability;
}

namespace {

void bind_force(py::module_& module) {
    Record<Magnet>(module, "Magnet",
                   "Pulls a free hand to a near surface: 0 at the surface, `peak` halfway.")
        .field("distance", &Magnet::distance, "[device mm] 0: off")
        .field("peak", &Magnet::peak, "[N]")
        .done();
    Record<Texture>(module, "Texture", "A bumpy surface, by turning the contact force.")
        .field("amplitude", &Texture::amplitude, "[mm, physical] 0: off")
        .field("wavelength", &Texture::wavelength, "[mm, physical]")
        .done();
    using F = AskedForce;
    Record<F>(module, "ForceSettings",
              "Force and torque from hand and proxy: f = stiffness (SCP - HIP), with limits.\n"
              "What is None depends on use and device: each field says how.")
        .field("stiffness", &F::asked_stiffness, "[N/mm] None: 0.5, or less if the device needs it")
        .field("damping", &F::damping, "[N s/mm] along the contact normal")
        .field("viscosity", &F::viscosity, "[N s/mm] of the medium")
        .field("magnet", &F::magnet, "Magnet")
        .field("texture", &F::texture, "Texture")
        .field("limit", &F::asked_limit, "[N] largest force; None: the device's; offline 3.3")
        .field("rate_limit", &F::asked_rate_limit,
               "[N/s] largest change of force; None: 2000; in replay() inf")
        .field("ramp", &F::asked_ramp,
               "[s] from zero to full force at the start; None: 0.25; in replay() 0")
        .field("stale_after", &F::stale_after, "[s] a longer time between two states is a pause")
        .field("start_below", &F::asked_start_below,
               "[N] no force until the wanted one is at most this; inf: do not wait;\n"
               "None: 0.3 in a Run, else inf")
        .field("rotational_stiffness", &F::rotational_stiffness,
               "[N mm/rad] of a tool; 0: stiffness times its gyration squared")
        .field("rotational_damping", &F::rotational_damping, "[N mm s/rad]")
        .field("torque_limit", &F::torque_limit, "[N mm] largest torque")
        .field("torque_rate_limit", &F::torque_rate_limit, "[N mm/s] largest change of torque")
        .done();
    Record<Friction>(module, "Friction", "Coulomb friction on the proxy's motion.")
        .field("static_coefficient", &Friction::static_coefficient, "0: none")
        .field("dynamic_coefficient", &Friction::dynamic_coefficient, "At most the static one.")
        .done();
}

void bind_device_settings(py::module_& module) {
    using L = DeviceLimits;
    Record<L>(module, "DeviceLimits", "What a device can take. Never exceeded.")
        .field("maximum_force", &L::maximum_force, "[N]")
        .field("rate", &L::rate, "[Hz] of the servo loop")
        .field("physical_damping", &L::physical_damping, "[N s/mm] of device and hand")
        .field("maximum_torque", &L::maximum_torque, "[N mm] 0: it renders none")
        .field("physical_rotational_damping", &L::physical_rotational_damping, "[N mm s/rad]")
        .done();
    using T = DeviceTransform;
    Record<T>(module, "DeviceTransform",
              "The place of the device's workspace in the volume:\n"
              "physical = translation + scale * rotation @ device.")
        .field("rotation", &T::rotation, "Orthonormal, device axes to physical axes, (3, 3).")
        .field("translation", &T::translation, "[mm, physical] where the device's origin lies")
        .field("scale", &T::scale, "physical mm per device mm, > 0")
        .done()
        .def("physical", &physical_from_device, py::arg("device"),
             "The physical point [mm] of a device point [device mm].")
        .def("device", &device_from_physical, py::arg("physical"), "The inverse of physical().");
    Record<PressThrough>(module, "Penetrability",
                         "Pressing through surfaces: beyond a threshold, or from range to range.")
        .field("threshold", &PressThrough::threshold, "PT [device mm]")
        .field("minimum", &PressThrough::minimum,
               "Least level felt (a number or '53%'); None: the isovalue.")
        .field("ranges", &PressThrough::ranges, "Pairs (low, high) of levels, only these are felt.")
        .done();
}

LayersChoice layers_given(const RenderSetup& setup) {
    if (!setup.given.layers) return {};
    return *setup.given.layers;
}
struct MakeLayers {
    std::optional<io::LayersFile> operator()(std::monostate) const { return std::nullopt; }
    std::optional<io::LayersFile> operator()(const io::LayersFile& file) const { return file; }
    std::optional<io::LayersFile> operator()(const std::filesystem::path& name) const {
        return io::layers_named(name.string());
    }
};

/// A field of run::RenderSetup inside our own.
template <class Value>
auto getter(Value run::RenderSetup::*member) {
    return [member](const RenderSetup& setup) { return setup.given.*member; };
}
template <class Value>
auto setter(Value run::RenderSetup::*member) {
    return [member](RenderSetup& setup, Value value) { setup.given.*member = std::move(value); };
}

}  // namespace

void bind_settings(py::module_& module) {
    bind_force(module);
    bind_device_settings(module);
}

void bind_render_setup(py::module_& module) {
    using R = run::RenderSetup;
    using S = RenderSetup;
    const auto own = [](auto member) { return std::pair(getter(member), setter(member)); };
    const auto [get_friction, set_friction] = own(&R::friction);
    const auto [get_spacing, set_spacing] = own(&R::tool_spacing);
    const auto [get_budget, set_budget] = own(&R::step_budget);
    const auto [get_scale, set_scale] = own(&R::scale);
    const auto [get_rate, set_rate] = own(&R::rate);
    Record<S>(module, "RenderSetup",
              "How to feel. What is None depends on volume and device and is filled in later.")
        .property(
            "method", [](const S& s) { return std::string(s.given.method.name); },
            [](S& s, const std::string& name) { s.given.method = run::named_method(name); },
            "The proxy method: one of methods().")
        .field("penetrability", &S::penetrability, "Penetrability or None.")
        .property(
            "layers", &layers_given,
            [](S& s, const LayersChoice& layers) {
                s.given.layers = std::visit(MakeLayers{}, layers);
            },
            "Layers, the name of a built-in set, a file, or None.")
        .property(
            "tool", [](const S& s) { return s.tool; },
            [](S& s, const ToolChoice& tool) {
                S changed = s;
                changed.tool = tool;
                setup_of(changed);  // says now what is wrong
                s = changed;
            },
            "A Tool, or text: 'point', 'sphere:RADIUS', 'needle', a mesh file, ... [mm]")
        .property("tool_spacing", get_spacing, set_spacing,
                  "Of a tool's points [mm]; None: half a voxel.")
        .property("friction", get_friction, set_friction, "Friction or None.")
        .field("force", &S::force, "ForceSettings")
        .alias("limit")
        .alias("stiffness")
        .property("step_budget", get_budget, set_budget, "Pieces that an update may use.")
        .property("scale", get_scale, set_scale,
                  "physical mm per device mm; None: fits the workspace.")
        .property("rate", get_rate, set_rate,
                  "[Hz] None: 1000, live 250 with a device that renders no force.")
        .done()
        .def_static(
            "offline",
            [] {
                RenderSetup setup;
                setup.force.asked_ramp = offline_force().ramp;
                setup.force.asked_rate_limit = offline_force().rate_limit;
                return setup;
            },
            "For a Renderer that renders as replay() does: no ramp, and no limit on the change\n"
            "of force.");
    module.def("methods", &baselines::method_names, "The names of all proxy methods.");
}

}  // namespace palpate::python
