// One tick at a time: a pose of the hand in, proxy and force out.
#include "palpate/renderer.hpp"

#include "bindings/python/arrays.hpp"
#include "bindings/python/bindings.hpp"
#include "bindings/python/renderer.hpp"

namespace palpate::python {
namespace {

Renderer live_renderer(const Field& field, const io::Level& level, const RenderSetup& setup,
                       const DeviceLimits& limits,
                       const std::optional<DeviceTransform>& transform) {
    const double isovalue = io::level_in(field.volume(), level);
    ForceSettings usual;
    usual.limit = limits.maximum_force;
    RendererSettings settings =
        run::render_settings(setup_of(setup, usual), field, isovalue, limits);
    if (const auto tool = tool_in(setup)) settings.tool = tool;
    if (transform) settings.transform = *transform;
    return make_renderer(field, isovalue, settings);
}

/// What can be rendered, or std::invalid_argument and nothing has changed.
template <class Change>
void change(Renderer& renderer, const Change& how) {
    RendererSettings settings = renderer.settings;
    how(settings);
    check(settings);
    renderer.settings = std::move(settings);
}

Tick tick(Renderer& renderer, double time, const Vec3& position,
          const std::optional<Quaternion>& orientation, bool valid, bool armed, bool released,
          const Vec3& pointing) {
    DeviceState state{time, position, valid, armed, released, pointing};
    if (orientation) state.orientation = orientation->normalized().toRotationMatrix();
    return render(renderer, state);
}

void bind_flags(py::module_& module) {
    py::dict flags;
    const std::pair<const char*, ForceFlag> all[] = {
        {"limited", force_limited},       {"rate_limited", force_rate_limited},
        {"ramping", force_ramping},       {"stale", force_stale},
        {"not_finite", force_not_finite}, {"off", force_off},
        {"waiting", force_waiting},       {"overrun", force_overrun}};
    for (const auto& [name, bit] : all) flags[name] = int{bit};
    module.attr("FORCE_FLAGS") = flags;
}

void bind_tick(py::module_& module) {
    py::class_<Tick>(module, "Tick", "The result of one tick.")
        .def_readonly("time", &Tick::time, "[s]")
        .def_property_readonly(
            "hip", [](const Tick& t) { return t.proxy.hip; }, "Place of the hand [mm, physical].")
        .def_property_readonly(
            "scp", [](const Tick& t) { return t.proxy.scp; },
            "Surface contact point: the proxy [mm, physical].")
        .def_property_readonly(
            "mode", [](const Tick& t) { return t.proxy.mode; }, "'free' or 'constrained'.")
        .def_property_readonly(
            "status", [](const Tick& t) { return t.proxy.status; },
            "'done', 'out_of_budget', 'recovering', 'refused', 'not_finite'.")
        .def_property_readonly(
            "density", [](const Tick& t) { return t.proxy.density; }, "At the SCP [data units].")
        .def_property_readonly(
            "isovalue", [](const Tick& t) { return t.proxy.isovalue; },
            "Of the surface felt [data units].")
        .def_property_readonly(
            "tetrahedra", [](const Tick& t) { return t.proxy.tetrahedra; },
            "How many the SCP moved through.")
        .def_property_readonly(
            "force", [](const Tick& t) { return t.force; }, "[N], device axes.")
        .def_property_readonly(
            "torque", [](const Tick& t) { return t.torque; },
            "[N mm], device axes, about the tool's reference point.")
        .def_readonly("force_flags", &Tick::force_flags, "Bits of FORCE_FLAGS.")
        .def_property_readonly(
            "hand_orientation_xyzw", [](const Tick& t) { return t.tool.hand; },
            "Unit quaternion, tool axes to physical axes.")
        .def_property_readonly(
            "proxy_orientation_xyzw", [](const Tick& t) { return t.tool.proxy; },
            "The same of the proxy.")
        .def_property_readonly(
            "contacts", [](const Tick& t) { return t.tool.contacts; },
            "How many points of the tool hold the proxy.")
        .def_property_readonly(
            "layer", [](const Tick& t) { return int{t.layers.touched}; },
            "Number of the layer touched; -1: none.")
        .def_property_readonly(
            "inside", [](const Tick& t) { return int{t.layers.inside}; },
            "How many layers the SCP is inside.")
        .def_property_readonly(
            "punctured", [](const Tick& t) { return int{t.layers.punctured}; },
            "Surfaces that gave way in this tick.")
        .def("__repr__", [](const Tick& t) {
            return py::str("Tick(time={:g}, mode={!r}, scp={}, force={})")
                .format(t.time, text_of(t.proxy.mode), py::cast(t.proxy.scp), py::cast(t.force));
        });
}

void bind_changes(py::class_<Renderer>& renderer) {
    renderer
        .def_property(
            "isovalue", [](const Renderer& r) { return r.proxy.isovalue; },
            [](Renderer& r, const io::Level& level) {
                const double isovalue = io::level_in(r.field.volume(), level);
                check_isovalue(isovalue, r.field.solid());
                use_isovalue(r, isovalue);
            },
            "Level felt [data units]; may be changed between ticks.")
        .def_property(
            "force", [](const Renderer& r) { return AskedForce(r.settings.force); },
            [](Renderer& r, const AskedForce& asked) {
                change(r, [&](RendererSettings& s) { s.force = force_of(asked, s.force); });
            },
            "ForceSettings; ValueError for what cannot be rendered, as of the next two.")
        .def_property(
            "friction", [](const Renderer& r) { return r.settings.proxy.friction; },
            [](Renderer& r, const Friction& friction) {
                change(r, [&](RendererSettings& s) { s.proxy.friction = friction; });
            },
            "Friction")
        .def_property(
            "transform", [](const Renderer& r) { return r.settings.transform; },
            [](Renderer& r, const DeviceTransform& transform) {
                change(r, [&](RendererSettings& s) { s.transform = transform; });
            },
            "DeviceTransform")
        .def_property_readonly(
            "limits", [](const Renderer& r) { return r.settings.device; }, "DeviceLimits")
        .def_property(
            "forces_on", [](const Renderer& r) { return r.settings.forces_on; },
            [](Renderer& r, bool on) { r.settings.forces_on = on; });
}

}  // namespace

Renderer offline_renderer(const Field& field, const io::Level& level, const RenderSetup& setup) {
    const double isovalue = io::level_in(field.volume(), level);
    RendererSettings settings =
        run::offline_settings(setup_of(setup, offline_force()), field, isovalue);
    if (const auto tool = tool_in(setup)) settings.tool = tool;
    return make_renderer(field, isovalue, settings);
}

void bind_renderer(py::module_& module) {
    bind_flags(module);
    bind_tick(module);
    py::class_<Renderer> renderer(module, "Renderer",
                                  "Renders ticks. A value: a copy goes on exactly as its original.",
                                  py::dynamic_attr());
    renderer
        .def(py::init(&live_renderer), py::arg("field"), py::arg("isovalue"),
             py::arg_v("setup", RenderSetup{}, "RenderSetup()"),
             py::arg_v("limits", DeviceLimits{}, "DeviceLimits()"),
             py::arg("transform") = py::none(),
             "isovalue: a number [data units] or '53%'. transform: where the device's workspace\n"
             "lies; by default device axes are physical axes.")
        .def("render", &tick, py::arg("time"), py::arg("position"), py::kw_only(),
             py::arg("orientation_xyzw") = py::none(), py::arg("valid") = true,
             py::arg("armed") = true, py::arg("released") = false,
             py::arg("pointing") = Vec3(0, 0, 0),
             "One tick: `time` [s], strictly increasing; `position` [device mm];\n"
             "`orientation_xyzw`, a quaternion, tool axes to device axes. valid=False: broken "
             "input, no force;\n"
             "armed=False: a dead-man switch is open; released: no force, within the rate limit.\n"
             "pointing: unit, to a needle's tip. Takes microseconds and keeps the GIL, so threads "
             "may\n"
             "share a Renderer.")
        .def_property_readonly("field", [](const Renderer& r) { return r.field; })
        .def("copy", [](const Renderer& r) { return r; })
        .def("__copy__", [](const Renderer& r) { return r; })
        .def("__repr__", [](const Renderer& r) {
            return py::str("Renderer({!r}, isovalue={:g})")
                .format(py::cast(r.field), r.proxy.isovalue);
        });
    bind_changes(renderer);
}

}  // namespace palpate::python
