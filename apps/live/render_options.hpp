// The options that say how to feel: proxy method, penetrability, force.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "palpate/renderer.hpp"

namespace palpate::app {

struct RenderOptions {
    std::string method = "exact";
    std::string penetrability = "off";
    std::optional<double> threshold;  ///< PT [device mm], 1 if not given
    std::string minimum;
    std::vector<std::string> ranges;
    /// STATIC[,DYNAMIC]; DISTANCE,PEAK; AMPLITUDE,WAVELENGTH. As text: CLI11 would take a VOLUME
    /// that follows for one more number.
    std::string friction, magnet, texture;
    double rate = 1000;  ///< [Hz]
    double scale = 1;    ///< physical mm per device mm
    int step_budget = ProxySettings{}.step_budget;
    ForceSettings force;

    void add_to(CLI::App& command);
};

/// "0.5,0.3" as static and dynamic coefficient; "0.5": both. Throws std::invalid_argument, naming
/// `what` (the option or command).
Friction friction_from(const std::string& what, const std::string& text);
/// "LOW:HIGH", each a level (io::level_from_text). Throws std::invalid_argument.
DensityRange range_from(const std::string& text, const Volume& volume);

/// The settings asked for; `isovalue` is the least level felt where no --minimum is given.
/// Throws std::invalid_argument, through check(), for what cannot be rendered.
/// `limits` are the device's; the rate is that of the options.
RendererSettings render_settings(const RenderOptions& options, const Field& field, double isovalue,
                                 const DeviceLimits& limits = {});

}  // namespace palpate::app
