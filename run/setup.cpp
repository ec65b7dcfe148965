// Fills in the values of a setup that depend on volume and device.
#include "palpate/run/setup.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>

#include "io/system/number.hpp"
#include "palpate/baselines/methods.hpp"
#include "palpate/run/beside.hpp"
#include "palpate/run/statistics.hpp"
#include "run/session_settings.hpp"

namespace palpate::run {
namespace {

constexpr int bins = 256;
constexpr int most_buttons = 32;     // of a reading
constexpr double most_torque = 1e9;  // [N mm] of no device: no limit

std::optional<double> background_in(const Volume& volume, const FieldSetup& setup) {
    if (!setup.background) return std::nullopt;
    return io::level_in(volume, *setup.background);
}

Interpolation interpolation_in(const FieldSetup& setup, ProxyMethod method) {
    return setup.interpolation.value_or(method == &update_exact ? Interpolation::cubic
                                                                : Interpolation::linear);
}

std::uint32_t usual_clutch(int buttons) {
    return buttons == 0 ? 0 : buttons == 1 ? 1U : 2U;
}

/// The device's bit for a button; 0 for none.
std::uint32_t bit_of(const ButtonSetup& setup, const char* purpose, int buttons,
                     std::uint32_t usual) {
    if (std::holds_alternative<std::monostate>(setup)) return 0;
    if (std::holds_alternative<UsualButton>(setup)) return usual;
    const int number = std::get<Button>(setup).number;
    if (number > buttons) {
        throw std::invalid_argument(purpose + (" button " + std::to_string(number)) +
                                    ": the device has " + std::to_string(buttons) + " buttons");
    }
    return std::uint32_t{1} << (number - 1);
}

/// Throws std::invalid_argument.
std::shared_ptr<const Tool> tool_for(const RenderSetup& setup, const Geometry& geometry,
                                     const OnProgress& progress) {
    const double spacing = setup.tool_spacing.value_or(io::usual_spacing(geometry));
    try {
        return io::make_tool(setup.tool, spacing, progress);
    } catch (const std::invalid_argument& e) {
        std::string apart;
        io::append_number(apart, spacing);
        throw std::invalid_argument(std::string("--tool: ") + e.what() + " (they are " + apart +
                                    " mm apart: --tool-spacing)");
    }
}

struct MakePenetrability {
    const Field& field;
    double isovalue;

    Penetrability operator()(std::monostate) const { return no_penetrability(); }
    Penetrability operator()(const ThresholdSetup& setup) const {
        const double minimum =
            setup.minimum ? io::level_in(field.volume(), *setup.minimum) : isovalue;
        return penetrability_threshold(setup.threshold, minimum, field.solid());
    }
    Penetrability operator()(const RangesSetup& setup) const {
        std::vector<DensityRange> ranges;
        for (const LevelRange& range : setup.ranges) {
            ranges.push_back({io::level_in(field.volume(), range.low),
                              io::level_in(field.volume(), range.high)});
        }
        return penetrability_ranges(setup.threshold, ranges, field.solid());
    }
};

/// What the device is rated for, and renders stably at the rate of the loop.
double usual_stiffness(const RenderSetup& render, const DeviceInfo& info) {
    DeviceLimits limits = info.limits;
    limits.rate = std::min(rate_of(render, info), limits.rate);
    const double most = greatest_stiffness(limits, render.force.damping + render.force.viscosity);
    const double rated = std::min(render.force.stiffness, info.stiffness);
    return most > 0 ? std::min(rated, most) : rated;  // else the damping is refused
}

}  // namespace

Field make_field(std::shared_ptr<const Samples> samples, const FieldSetup& setup,
                 ProxyMethod method) {
    const auto background = background_in(samples->volume(), setup);
    return Field(std::move(samples), setup.solid, background, interpolation_in(setup, method));
}

Field make_field(const Volume& volume, const FieldSetup& setup, ProxyMethod method) {
    return Field(volume, setup.solid, background_in(volume, setup),
                 interpolation_in(setup, method));
}

double isovalue_of(const LoadedVolume& loaded, const FieldSetup& setup,
                   const OnProgress& progress) {
    if (setup.isovalue) return io::level_in(loaded.volume, *setup.isovalue);
    if (loaded.isovalue) return *loaded.isovalue;
    const auto padding = padding_of(loaded.volume, loaded.values.padding, progress);
    const std::vector<double> levels =
        suggested_isovalues(histogram_of(loaded.volume, bins, padding, progress));
    if (!levels.empty()) return levels.front();
    throw std::invalid_argument(loaded.name +
                                ": the data is constant, so there is no surface to touch");
}

double isovalue_of(const LoadedVolume& loaded, const Setup& setup, const OnProgress& progress) {
    if (setup.render.layers && setup.render.layers->layers.by_label) {
        return setup.field.isovalue ? isovalue_of(loaded, setup.field)
                                    : loaded.isovalue.value_or(loaded.volume.minimum());
    }
    if (setup.render.layers && !setup.render.layers->layers.layers.empty()) {
        if (setup.field.isovalue) {
            throw std::invalid_argument(
                "an isovalue does nothing with layers, whose surfaces have levels of their own");
        }
        return io::layers_for(*setup.render.layers, loaded.volume).layers.front().level;
    }
    return isovalue_of(loaded, setup.field, progress);
}

std::string level_warning(const Field& field, double isovalue) {
    const std::string warning = isovalue_warning(field, isovalue);
    if (warning.empty()) return warning;
    const Samples& samples = field.samples();
    return "isovalue " + number_text(isovalue) + " (data " + number_text(samples.minimum()) +
           " to " + number_text(samples.maximum()) + "): " + warning;
}

std::string layers_warning(const io::LayersFile& file, const LoadedVolume& loaded) {
    if (file.layers.labels) {
        std::string warning =
            warning_beside(file.layers.label_volume, file.layers.labels->geometry(), loaded);
        if (!warning.empty()) return warning;
    }
    const std::string& units = loaded.values.units;
    if (!file.units.empty() && file.units != "%" && file.units != units) {
        return "the layers are in " + file.units + "; " + loaded.name +
               (units.empty() ? " does not say what its densities are in" : " is in " + units);
    }
    std::string empty;
    const Layers layers = io::layers_for(file, loaded.volume);
    for (std::size_t i = 0; i < level_count(layers); ++i) {
        const Layer& layer = layers.layers[i];
        if (layer.level > loaded.volume.minimum() && layer.level < loaded.volume.maximum())
            continue;
        empty += (empty.empty() ? "" : ", ") + layer.name;
    }
    if (empty.empty()) return {};
    return "these layers lie outside the densities of " + loaded.name + ": " + empty;
}

RendererSettings render_settings(const RenderSetup& setup, const Field& field, double isovalue,
                                 const std::optional<DeviceLimits>& limits,
                                 const OnProgress& progress) {
    if (setup.layers && !setup.layers->layers.layers.empty() &&
        !std::holds_alternative<std::monostate>(setup.penetrability)) {
        throw std::invalid_argument(
            "penetrability does nothing with layers, whose surfaces give way by themselves");
    }
    if (setup.friction && setup.method.method != &update_exact) {
        throw std::invalid_argument("friction is for the method exact; the others have none");
    }
    if (field.interpolation() == Interpolation::cubic &&
        setup.method.method == &baselines::update_paper) {
        throw std::invalid_argument(
            "the method paper is made for the linear field: choose another method or field");
    }
    RendererSettings settings;
    settings.method = setup.method.method;
    settings.proxy.step_budget = setup.step_budget.value_or(settings.proxy.step_budget);
    settings.proxy.friction = setup.friction.value_or(settings.proxy.friction);
    settings.penetrability = std::visit(MakePenetrability{field, isovalue}, setup.penetrability);
    if (setup.layers) {
        settings.layers =
            std::make_shared<const Layers>(io::layers_for(*setup.layers, field.volume()));
    }
    settings.tool = tool_for(setup, field.geometry(), progress);
    settings.force = setup.force;
    settings.force.limit = setup.limit.value_or(settings.force.limit);
    settings.force.stiffness = setup.stiffness.value_or(settings.force.stiffness);
    settings.device = limits.value_or(DeviceLimits{});
    const double rate = setup.rate.value_or(settings.device.rate);
    // The slower of device and loop is what renders the spring.
    settings.device.rate = limits ? std::min(rate, limits->rate) : rate;
    settings.transform.scale = setup.scale.value_or(1);
    check(settings);
    return settings;
}

double rate_of(const RenderSetup& setup, const DeviceInfo& device) {
    constexpr double without_force = 250;
    return setup.rate.value_or(device.renders_force ? usual_rate : without_force);
}

RendererSettings offline_settings(const RenderSetup& setup, const Field& field, double isovalue,
                                  const OnProgress& progress) {
    RendererSettings settings = render_settings(setup, field, isovalue, std::nullopt, progress);
    settings.device.maximum_force = std::max(settings.device.maximum_force, settings.force.limit);
    settings.device.maximum_torque = std::min(settings.force.torque_limit, most_torque);
    settings.force.stale_after = std::numeric_limits<double>::infinity();
    return settings;
}

DeviceTransform transform_for(const Geometry& geometry, const DeviceInfo& info,
                              const Setup& setup) {
    DeviceTransform transform = fit_workspace(geometry, info, setup.facing);
    if (!setup.render.scale) return transform;
    const double scale = *setup.render.scale;
    const Vec3 middle = 0.5 * (info.workspace_low + info.workspace_high);
    transform.translation += (transform.scale - scale) * (transform.rotation * middle);
    transform.scale = scale;
    return transform;
}

Session make_session(const Field& field, double isovalue, const DeviceInfo& info,
                     const Setup& setup, const OnProgress& progress) {
    RenderSetup render = setup.render;
    const double rate = rate_of(render, info);
    if (!render.limit) render.limit = info.limits.maximum_force;
    render.rate = rate;
    if (!render.stiffness) render.stiffness = usual_stiffness(render, info);
    if (!render.step_budget) {
        // Its worst case is half a tick at 1 kHz, whatever the rate.
        render.step_budget =
            static_cast<int>(ProxySettings{}.step_budget * std::min(1.0, 1000 / rate));
    }
    RendererSettings settings = render_settings(render, field, isovalue, info.limits, progress);
    settings.transform = transform_for(field.geometry(), info, setup);
    return {make_renderer(field, isovalue, settings), session_settings(setup, info)};
}

SessionSettings session_settings(const Setup& setup, const DeviceInfo& info) {
    SessionSettings session = setup.session;
    check(session);
    session.clutch_buttons =
        bit_of(setup.buttons.clutch, "clutch", info.buttons, usual_clutch(info.buttons));
    session.deadman_buttons = bit_of(setup.buttons.deadman, "dead-man", info.buttons, 0);
    if (session.clutch_buttons & session.deadman_buttons) {
        throw std::invalid_argument("clutch and dead-man switch are the same button: name another");
    }
    return session;
}

ButtonSetup button_from(const std::string& purpose, const std::string& text) {
    if (text == "none") return {};
    if (text == "auto") return UsualButton{};
    const auto number = io::number_from<int>(text);
    if (!number || *number < 1 || *number > most_buttons) {
        throw std::invalid_argument(purpose + ": a button is a number from 1 to " +
                                    std::to_string(most_buttons) + ", none or auto, not '" + text +
                                    "'");
    }
    return Button{*number};
}

std::string text_of(const ButtonSetup& button) {
    if (const auto* numbered = std::get_if<Button>(&button))
        return std::to_string(numbered->number);
    return std::holds_alternative<UsualButton>(button) ? "auto" : "none";
}

baselines::NamedMethod named_method(std::string_view name) {
    const ProxyMethod method = baselines::method_named(name);
    return *std::ranges::find(baselines::methods(), method, &baselines::NamedMethod::method);
}

std::string text_of(const devices::DeviceChoice& choice) {
    std::string text = choice.name;
    char before = ':';
    for (const auto& [key, value] : choice.options) {
        text += before + (key.empty() ? value : key + "=" + value);
        before = ',';
    }
    return text;
}

}  // namespace palpate::run
