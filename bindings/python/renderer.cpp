// Ticks one at a time, or those of a whole trajectory: a pose of the hand in, proxy and force out.
#include "palpate/renderer.hpp"

#include <chrono>

#include "bindings/python/arrays.hpp"
#include "bindings/python/bindings.hpp"
#include "bindings/python/progress.hpp"
#include "bindings/python/record.hpp"
#include "bindings/python/renderer.hpp"

namespace palpate::python {
namespace {

SharedRenderer live_renderer(const Field& field, const io::Level& level, const RenderSetup& asked,
                             const std::optional<DeviceLimits>& limits,
                             const std::optional<DeviceTransform>& transform) {
    const RenderSetup setup = asked;  // other threads may change theirs
    if (transform) {
        run::refuse_without_effect({{{"scale"}, "the transform has another one"}},
                                   {{"scale", setup.scale && *setup.scale != transform->scale}});
    }
    auto made = without_gil([&] {
        const double isovalue = io::level_in(field.volume(), level);
        ForceSettings usual;
        usual.limit = limits.value_or(DeviceLimits{}).maximum_force;
        RendererSettings settings =
            run::render_settings(setup_of(setup, usual), field, isovalue, limits, ctrl_c());
        if (const auto tool = tool_in(setup)) settings.tool = tool;
        if (transform) settings.transform = *transform;
        return SharedRenderer(make_renderer(field, isovalue, settings));
    });
    warn_of_level(setup, field, made.proxy.isovalue, 2);
    return made;
}

/// Makes the change, or throws std::invalid_argument and changes nothing.
template <class Change>
void change(SharedRenderer& renderer, const Change& how) {
    renderer.changeable();
    RendererSettings settings = renderer.settings;
    how(settings);
    check(settings);
    renderer.settings = std::move(settings);
    renderer.force.changed = true;  // the force rises with the ramp, as after a command
}

Tick tick(SharedRenderer& renderer, double time, const Vec3& position,
          const std::optional<Quaternion>& orientation, bool valid, bool armed, bool released,
          const Vec3& pointing) {
    TickInput state{time, position, valid, armed, released, pointing};
    if (orientation) {
        state.orientation = unit_quaternion("orientation_xyzw", *orientation).toRotationMatrix();
    }
    return render(renderer.changeable(), state);
}

/// The hand of many ticks, which point nowhere unless that is given.
std::vector<TickInput> states_from(const Doubles& time, const Doubles& position,
                                   const std::optional<Doubles>& pointing) {
    const std::vector<Vec3> places = points_from(position, "position");
    const std::vector<Vec3> tips = pointing ? points_from(*pointing, "pointing")
                                            : std::vector<Vec3>(places.size(), Vec3::Zero());
    if (time.ndim() != 1 || time.size() != py::ssize_t(places.size()) ||
        tips.size() != places.size()) {
        throw std::invalid_argument("as many times, positions and pointings are needed");
    }
    std::vector<TickInput> states(places.size());
    const GilReleasedForRows unlocked(states.size());
    for (std::size_t i = 0; i < states.size(); ++i) {
        states[i].time = time.data()[i];
        states[i].position = places[i];
        states[i].pointing = tips[i];
    }
    return states;
}

py::dict follow_ticks(SharedRenderer& renderer, const Doubles& time, const Doubles& position,
                      const std::optional<Doubles>& pointing, bool alternatives,
                      const ProgressFunction& progress) {
    std::optional<Moving<Renderer>> moving;
    if (!alternatives) moving.emplace(renderer, "follow()");
    const std::vector<TickInput> states = states_from(time, position, pointing);
    std::vector<Tick> ticks(states.size());
    ReportedItems slices(progress_of(progress), ticks.size(), updates_in_slice);
    if (alternatives) {
        const Renderer own = renderer;  // other threads may use it
        const GilReleased unlocked;
        for (std::size_t i = 0; i < states.size(); ++i) {
            Renderer copy = own;
            ticks[i] = render(copy, states[i]);
            slices.done();
        }
    } else {
        moving->without_gil([&](Renderer& own) {
            for (std::size_t i = 0; i < states.size(); ++i) {
                ticks[i] = render(own, states[i]);
                slices.done();
            }
        });
    }
    const auto of = [&](const auto& value) { return column(ticks, value); };
    return py::dict(py::arg("scp") = of([](const Tick& t) { return t.proxy.scp; }),
                    py::arg("density") = of([](const Tick& t) { return t.proxy.density; }),
                    py::arg("constrained") =
                        of([](const Tick& t) { return t.proxy.mode == Mode::constrained; }),
                    py::arg("behind") = of([](const Tick& t) { return t.proxy.behind; }),
                    py::arg("force") = of([](const Tick& t) { return t.force; }),
                    py::arg("layer") = of([](const Tick& t) { return t.layers.touched; }),
                    py::arg("inside") = of([](const Tick& t) { return t.layers.inside; }),
                    py::arg("punctured") = of([](const Tick& t) { return t.layers.punctured; }));
}

py::array_t<double> batch_ns(SharedRenderer& renderer, const Doubles& time, const Doubles& position,
                             std::size_t batch, const ProgressFunction& progress) {
    using SteadyClock = std::chrono::steady_clock;
    if (batch == 0) throw std::invalid_argument("batch: at least one tick is needed");
    Moving moving(renderer, "batch_ns()");
    const std::vector<TickInput> states = states_from(time, position, std::nullopt);
    std::vector<double> times(states.size() / batch);
    ReportedItems slices(progress_of(progress), times.size(), batches_in_slice);
    moving.without_gil([&](Renderer& own) {
        for (std::size_t i = 0; i < times.size(); ++i) {
            const auto begin = SteadyClock::now();
            for (std::size_t k = i * batch; k < (i + 1) * batch; ++k) render(own, states[k]);
            const std::chrono::duration<double, std::nano> taken = SteadyClock::now() - begin;
            times[i] = taken.count() / double(batch);
            slices.done();
        }
    });
    return array_from(std::move(times));
}

void bind_flags(py::module_& module) {
    py::dict flags;
    const std::pair<const char*, ForceFlag> all[] = {{"limited", force_limited},
                                                     {"rate_limited", force_rate_limited},
                                                     {"ramping", force_ramping},
                                                     {"stale", force_stale},
                                                     {"not_finite", force_not_finite},
                                                     {"off", force_off},
                                                     {"waiting", force_waiting},
                                                     {"overrun", force_overrun},
                                                     {"warm", force_warm}};
    for (const auto& [name, bit] : all) flags[name] = int{bit};
    module.attr("FORCE_FLAGS") = flags;
}

void bind_tick(py::module_& module) {
    using T = Tick;
    using P = ProxyUpdate;
    using L = LayersFelt;
    using F = ToolFelt;
    Result<T>(module, "Tick", "The result of one tick.")
        .part("time", "[s]", &T::time)
        .part("hip", "Place of the hand [mm, physical].", &T::proxy, &P::hip)
        .part("scp", "Surface contact point: the proxy [mm, physical].", &T::proxy, &P::scp)
        .part("mode", "'free' or 'constrained'.", &T::proxy, &P::mode)
        .part("status",
              "'done', 'out_of_budget', 'recovering', 'refused', 'not_finite', or 'waiting' for\n"
              "samples of a store.",
              &T::proxy, &P::status)
        .part("density", "At the SCP [data units].", &T::proxy, &P::density)
        .part("isovalue", "Of the surface felt [data units].", &T::proxy, &P::isovalue)
        .part("tetrahedra", "How many the SCP moved through.", &T::proxy, &P::tetrahedra)
        .part("force", "[N], device axes.", &T::force)
        .part("torque", "[N mm], device axes, about the tool's reference point.", &T::torque)
        .part("force_flags", "Bits of FORCE_FLAGS.", &T::force_flags)
        .part("hand_orientation_xyzw", "Unit quaternion, tool axes to physical axes.", &T::tool,
              &F::hand)
        .part("proxy_orientation_xyzw", "The same of the proxy.", &T::tool, &F::proxy)
        .part("contacts", "How many points of the tool hold the proxy.", &T::tool, &F::contacts)
        .part("layer", "Number of the layer touched; -1: none.", &T::layers, &L::touched)
        .part("inside", "How many layers the SCP is inside.", &T::layers, &L::inside)
        .part("punctured", "Surfaces that gave way in this tick.", &T::layers, &L::punctured)
        .done()
        .def("__repr__", [](const T& t) {
            return py::str("Tick(time={:g}, mode={!r}, scp={}, force={})")
                .format(t.time, enum_name(t.proxy.mode), py::cast(t.proxy.scp), py::cast(t.force));
        });
}

void bind_changes(py::class_<SharedRenderer>& renderer) {
    using R = SharedRenderer;
    renderer
        .def_property(
            "isovalue", [](const R& r) { return r.proxy.isovalue; },
            [](R& r, const io::Level& level) {
                const double isovalue = io::level_in(r.field.volume(), level);
                check_isovalue(isovalue, r.field.solid());
                use_isovalue(r.changeable(), isovalue);
                r.force.changed = true;
            },
            "Level felt [data units]; may be changed between ticks.")
        .def_property(
            "force", [](const R& r) { return AskedForce(r.settings.force); },
            [](R& r, const AskedForce& asked) {
                change(r, [&](RendererSettings& s) { s.force = force_of(asked, s.force); });
            },
            "ForceSettings; ValueError for what cannot be rendered, as of the next two.")
        .def_property(
            "friction", [](const R& r) { return r.settings.proxy.friction; },
            [](R& r, const Friction& friction) {
                change(r, [&](RendererSettings& s) { s.proxy.friction = friction; });
            },
            "Friction")
        .def_property(
            "transform", [](const R& r) { return r.settings.transform; },
            [](R& r, const DeviceTransform& transform) {
                change(r, [&](RendererSettings& s) { s.transform = transform; });
                r.force.waiting = true;
            },
            "DeviceTransform")
        .def_property_readonly(
            "limits", [](const R& r) { return r.settings.device; }, "DeviceLimits")
        .def_property(
            "forces_on", [](const R& r) { return r.settings.forces_on; },
            [](R& r, bool on) {
                r.changeable().settings.forces_on = on;
                r.force.changed = true;
            });
}

}  // namespace

Renderer offline_renderer(const Field& field, const io::Level& level, const RenderSetup& asked) {
    const RenderSetup setup = asked;  // other threads may change theirs
    const GilReleased unlocked;
    const double isovalue = io::level_in(field.volume(), level);
    const run::RenderSetup made = setup_of(setup, offline_force());
    run::refuse_without_effect(run::without_effect_in_replay(made), given_in(setup));
    RendererSettings settings = run::offline_settings(made, field, isovalue, ctrl_c());
    if (const auto tool = tool_in(setup)) settings.tool = tool;
    return make_renderer(field, isovalue, settings);
}

void bind_renderer(py::module_& module) {
    bind_flags(module);
    bind_tick(module);
    using R = SharedRenderer;
    py::class_<R> renderer(module, "Renderer",
                           "Renders ticks. A value: a copy goes on exactly as its original.",
                           py::dynamic_attr());
    renderer
        .def(py::init(&live_renderer), py::arg("field"), py::arg("isovalue"),
             py::arg_v("setup", RenderSetup{}, "RenderSetup()"), py::arg("limits") = py::none(),
             py::arg("transform") = py::none(),
             "isovalue: a number [data units] or '53%'. limits: those of a device; the slower of\n"
             "its rate and the setup's limits the stiffness. transform: where the device's\n"
             "workspace lies; by default device axes are physical axes.")
        .def("render", &tick, py::arg("time"), py::arg("position"), py::kw_only(),
             py::arg("orientation_xyzw") = py::none(), py::arg("valid") = true,
             py::arg("armed") = true, py::arg("released") = false,
             py::arg("pointing") = Vec3(0, 0, 0),
             "One tick: `time` [s], strictly increasing; `position` [device mm];\n"
             "`orientation_xyzw`, a quaternion, tool axes to device axes. valid=False: broken\n"
             "input, no force; armed=False: a dead-man switch is open; released: no force, within\n"
             "the rate limit. pointing: unit, to a needle's tip. Takes microseconds and keeps the\n"
             "GIL, so threads may share a Renderer. RuntimeError, as of all changes, while\n"
             "another thread is in follow().")
        .def(
            "follow", &follow_ticks, py::arg("time"), py::arg("position"), py::kw_only(),
            py::arg("pointing") = py::none(), py::arg("alternatives") = false,
            py::arg("progress") = py::none(),
            "render() for each row of `time` [s], shape (n,), and `position` [device mm], (n, 3),\n"
            "without the GIL: arrays by name, scp, density, constrained, behind (it holds from\n"
            "inside), force, layer, inside and punctured, as of a Tick. alternatives: each row by\n"
            "a copy of the renderer as it is, which stays. progress: called with the part that is\n"
            "done; if it raises, the renderer is as before.")
        .def("batch_ns", &batch_ns, py::arg("time"), py::arg("position"), py::arg("batch"),
             py::kw_only(), py::arg("progress") = py::none(),
             "The time of a tick [ns]: the mean of each `batch` ticks, without a clock inside.")
        .def_property_readonly("field", [](const R& r) { return r.field; })
        .def("copy", &R::copied, "A copy, which goes on independently.")
        .def("__copy__", &R::copied)
        .def("__deepcopy__", [](const R& r, const py::dict&) { return r.copied(); })
        .def("__repr__", [](const R& r) {
            return py::str("Renderer({!r}, isovalue={:g})")
                .format(py::cast(r.field), r.proxy.isovalue);
        });
    bind_changes(renderer);
}

}  // namespace palpate::python
