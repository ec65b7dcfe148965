// How to feel: options of method, penetrability and force.
#include "apps/live/render_options.hpp"

#include <fmt/format.h>

#include <array>
#include <limits>
#include <stdexcept>

#include "io/number.hpp"
#include "palpate/baselines/methods.hpp"
#include "palpate/io/level.hpp"

namespace palpate::app {
namespace {

/// "0.5,0.3" as two numbers; "0.5" as twice the same where one is enough.
std::array<double, 2> two_numbers(const std::string& option, const std::string& text,
                                  bool one_is_enough = false) {
    const auto comma = text.find(',');
    const auto first = io::number_from<double>(text.substr(0, comma));
    const auto second =
        comma == std::string::npos ? first : io::number_from<double>(text.substr(comma + 1));
    if (!first || !second || (comma == std::string::npos && !one_is_enough)) {
        throw std::invalid_argument(
            fmt::format("{} {}: {} separated by a comma, as in 0.5,0.3", option, text,
                        one_is_enough ? "one number, or two" : "two numbers"));
    }
    return {*first, *second};
}

/// An option that would do nothing is a misunderstanding.
void refuse_idle_options(const RenderOptions& options) {
    const auto refuse = [](const std::string& option, const std::string& mode) {
        throw std::invalid_argument(option + " does nothing without --penetrability " + mode);
    };
    const std::string& mode = options.penetrability;
    if (options.threshold && mode == "off") refuse("--threshold", "threshold (or ranges)");
    if (!options.minimum.empty() && mode != "threshold") refuse("--minimum", "threshold");
    if (!options.ranges.empty() && mode != "ranges") refuse("--range", "ranges");
}

Penetrability penetrability_of(const RenderOptions& options, const Field& field, double isovalue) {
    refuse_idle_options(options);
    if (options.penetrability == "off") return no_penetrability();
    const double threshold = options.threshold.value_or(1);
    if (options.penetrability == "threshold") {
        const double minimum = options.minimum.empty()
                                   ? isovalue
                                   : io::level_from_text(options.minimum, field.volume());
        return penetrability_threshold(threshold, minimum, field.solid());
    }
    if (options.ranges.empty()) {
        throw std::invalid_argument("--penetrability ranges needs at least one --range LOW:HIGH");
    }
    std::vector<DensityRange> ranges;
    for (const std::string& text : options.ranges)
        ranges.push_back(range_from(text, field.volume()));
    return penetrability_ranges(threshold, ranges, field.solid());
}

}  // namespace

Friction friction_from(const std::string& what, const std::string& text) {
    const auto [still, moving] = two_numbers(what, text, true);
    return {still, moving};
}

DensityRange range_from(const std::string& text, const Volume& volume) {
    const auto colon = text.find(':');
    if (colon == std::string::npos) {
        throw std::invalid_argument("range " + text + ": LOW:HIGH is needed, as in 300:700");
    }
    return {io::level_from_text(text.substr(0, colon), volume),
            io::level_from_text(text.substr(colon + 1), volume)};
}

void RenderOptions::add_to(CLI::App& command) {
    std::vector<std::string> names;
    for (const auto& entry : baselines::methods()) names.emplace_back(entry.name);
    command.add_option("--method", method, "Proxy method")
        ->check(CLI::IsMember(names))
        ->capture_default_str();
    command.add_option("--penetrability", penetrability, "Pressing through")
        ->check(CLI::IsMember({"off", "threshold", "ranges"}))
        ->capture_default_str();
    command.add_option("--threshold", threshold, "Penetration threshold PT [device mm] (1)");
    command.add_option("--minimum", minimum, "Least level felt (default: the isovalue)");
    // Without allow_extra_args(false) this would take VOLUME for one more range.
    command.add_option("--range", ranges, "Range of interest, LOW:HIGH; may be given again")
        ->allow_extra_args(false)
        ->type_name("LOW:HIGH");
    command.add_option("-k,--stiffness", force.stiffness, "Stiffness [N/mm]")
        ->capture_default_str();
    command.add_option("--damping", force.damping, "Damping along the normal [N s/mm]");
    command.add_option("--viscosity", force.viscosity, "Viscosity of the medium [N s/mm]");
    command.add_option("--friction", friction, "Friction coefficients; dynamic at most static")
        ->type_name("STATIC[,DYNAMIC]");
    command.add_option("--magnet", magnet, "Snap to near surfaces: DISTANCE [mm],PEAK [N]")
        ->type_name("D,P");
    command.add_option("--texture", texture, "Bumps: AMPLITUDE,WAVELENGTH [mm]")->type_name("A,W");
    command.add_option("--force-limit", force.limit, "Largest force [N]")->capture_default_str();
    command.add_option("--force-rate", force.rate_limit, "Largest change of force [N/s]")
        ->capture_default_str();
    command.add_option("--ramp", force.ramp, "Ramp of the force from zero at the start [s]")
        ->capture_default_str();
    command
        .add_option("--start-below", force.start_below,
                    "After a start or pause no force until the wanted one is this small [N]")
        ->capture_default_str();
    command.add_option("--rate", rate, "Rate of the loop the forces are meant for [Hz]")
        ->capture_default_str();
    command.add_option("--scale", scale, "Physical mm per mm of hand")->capture_default_str();
    command.add_option("--step-budget", step_budget, "Most tetrahedra an update may enter")
        ->capture_default_str();
}

RendererSettings render_settings(const RenderOptions& options, const Field& field, double isovalue,
                                 const DeviceLimits& limits) {
    if (!options.friction.empty() && options.method != "exact") {
        throw std::invalid_argument("--friction is for --method exact; the others have none");
    }
    RendererSettings settings;
    settings.method = baselines::method_named(options.method);
    settings.proxy.step_budget = options.step_budget;
    if (!options.friction.empty()) {
        settings.proxy.friction = friction_from("--friction", options.friction);
    }
    settings.penetrability = penetrability_of(options, field, isovalue);
    settings.force = options.force;
    if (!options.magnet.empty()) {
        const auto [distance, peak] = two_numbers("--magnet", options.magnet);
        settings.force.magnet = {distance, peak};
    }
    if (!options.texture.empty()) {
        const auto [amplitude, wavelength] = two_numbers("--texture", options.texture);
        settings.force.texture = {amplitude, wavelength};
    }
    settings.device = limits;
    settings.device.rate = options.rate;
    settings.transform.scale = options.scale;
    check(settings);
    return settings;
}

}  // namespace palpate::app
