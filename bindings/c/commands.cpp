// Commands of the C interface to a run: each is checked here and carried out within a tick or two.
#include <initializer_list>
#include <stdexcept>
#include <string>
#include <variant>

#include "bindings/c/handles.hpp"
#include "bindings/c/settings.hpp"
#include "bindings/c/structs.hpp"
#include "palpate/io/layers_file.hpp"
#include "palpate/io/tool_file.hpp"

namespace palpate::c {
namespace {

/// Sends the command that `make` makes for the run as it is now.
template <class Make>
palpate_status send(palpate_run* run, Make&& make) noexcept {
    return guarded([&] {
        const auto lock = locked(run);
        run->run->send(make(*run->run));
    });
}

struct NamedValue {
    const char* name;
    double value;
};
/// Changes settings of one group.
palpate_status set(palpate_run* run, std::initializer_list<NamedValue> values) noexcept {
    return send(run, [&](const run::Run& now) {
        RendererSettings settings = now.settings();
        Command command;
        for (const auto& [name, value] : values) command = change(settings, name, value);
        return command;
    });
}

palpate_status send_layers(palpate_run* run, const char* layers, bool same_surfaces) noexcept {
    return send(run, [&](const run::Run& now) {
        if (!layers) return command::UseLayers{nullptr};
        return command::UseLayers{
            std::make_shared<const Layers>(io::layers_for(
                io::layers_named(layers, progress_of_thread()), now.field().volume())),
            same_surfaces};
    });
}

}  // namespace

extern "C" PALPATE_API palpate_status palpate_run_set_isovalue(palpate_run* run, double isovalue) {
    return send(run, [&](const run::Run&) { return command::Isovalue{isovalue}; });
}

extern "C" PALPATE_API palpate_status palpate_run_set_forces(palpate_run* run, int32_t on) {
    return send(run, [&](const run::Run&) { return command::Forces{on != 0}; });
}

extern "C" PALPATE_API palpate_status palpate_run_set_frozen(palpate_run* run, int32_t on) {
    return send(run, [&](const run::Run&) { return command::Freeze{on != 0}; });
}

extern "C" PALPATE_API palpate_status palpate_run_set_clutch(palpate_run* run, int32_t on) {
    return send(run, [&](const run::Run&) { return command::Clutch{on != 0}; });
}

extern "C" PALPATE_API palpate_status palpate_run_lift(palpate_run* run) {
    return send(run, [](const run::Run&) { return command::Lift{}; });
}

extern "C" PALPATE_API palpate_status palpate_run_set_scale(palpate_run* run, double scale) {
    return send(run, [&](const run::Run&) { return command::Scale{scale}; });
}

extern "C" PALPATE_API palpate_status palpate_run_set_transform(palpate_run* run,
                                                                const palpate_transform* to) {
    return send(run, [&](const run::Run&) { return transform_from(&given(to, "to")); });
}

extern "C" PALPATE_API palpate_status palpate_run_get(const palpate_run* run, const char* name,
                                                      double* value) {
    return guarded([&] {
        const auto lock = locked(run);
        given(value, "value") = value_of(run->run->settings(), &given(name, "name"));
    });
}

extern "C" PALPATE_API palpate_status palpate_run_set(palpate_run* run, const char* name,
                                                      double value) {
    if (!name) return guarded([&] { given(name, "name"); });
    return set(run, {{name, value}});
}

extern "C" PALPATE_API palpate_status palpate_run_set_stiffness(palpate_run* run,
                                                                double newton_per_mm) {
    return set(run, {{"force.stiffness", newton_per_mm}});
}

extern "C" PALPATE_API palpate_status palpate_run_set_damping(palpate_run* run, double damping,
                                                              double viscosity) {
    return set(run, {{"force.damping", damping}, {"force.viscosity", viscosity}});
}

extern "C" PALPATE_API palpate_status palpate_run_set_force_limit(palpate_run* run, double newton) {
    return set(run, {{"force.limit", newton}});
}

extern "C" PALPATE_API palpate_status palpate_run_set_friction(palpate_run* run,
                                                               double static_coefficient,
                                                               double dynamic_coefficient) {
    return set(run, {{"friction.static_coefficient", static_coefficient},
                     {"friction.dynamic_coefficient", dynamic_coefficient}});
}

extern "C" PALPATE_API palpate_status palpate_run_set_penetration(palpate_run* run,
                                                                  double threshold) {
    return send(run, [&](const run::Run& now) {
        if (threshold == 0) return no_penetrability();
        return penetrability_threshold(threshold, now.isovalue(), now.field().solid());
    });
}

extern "C" PALPATE_API palpate_status palpate_run_set_ranges(palpate_run* run, double threshold,
                                                             const double* ranges, size_t count) {
    return send(run, [&](const run::Run& now) {
        return penetrability_ranges(threshold, ranges_from(ranges, count), now.field().solid());
    });
}

extern "C" PALPATE_API palpate_status palpate_run_set_tool(palpate_run* run, const char* tool) {
    return send(run, [&](const run::Run& now) {
        const double spacing = io::usual_spacing(now.field().geometry());
        if (!tool) return command::UseTool{nullptr};
        const OnProgress progress = progress_of_thread();
        return command::UseTool{
            io::make_tool(io::tool_spec_from(tool, progress), spacing, progress)};
    });
}

extern "C" PALPATE_API palpate_status palpate_run_set_layers(palpate_run* run, const char* layers) {
    return send_layers(run, layers, false);
}

extern "C" PALPATE_API palpate_status palpate_run_change_layers(palpate_run* run,
                                                                const char* layers) {
    return send_layers(run, layers, true);
}

}  // namespace palpate::c
