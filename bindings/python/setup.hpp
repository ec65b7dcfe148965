// How to feel, as Python gives it: run::RenderSetup with a tool by its text or as points.
#pragma once

#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "palpate/run/no_effect.hpp"

namespace palpate::python {

/// Pressing through surfaces: from range to range where there are ranges, else beyond a threshold.
struct PressThrough {
    double threshold = 1;              ///< PT [device mm]
    std::optional<io::Level> minimum;  ///< least level felt; nothing: the isovalue
    std::vector<std::pair<io::Level, io::Level>> ranges;
};

/// ForceSettings whose numbers that are left open are NaN. The usual ones depend on use and device.
struct AskedForce : ForceSettings {
    AskedForce();
    explicit AskedForce(const ForceSettings& given) : ForceSettings(given) {}
};
/// Nothing for a number that is left open.
inline std::optional<double> asked(double number) {
    return std::isnan(number) ? std::nullopt : std::optional(number);
}

using ToolChoice = std::variant<std::string, std::shared_ptr<Tool>>;
using LayersChoice = std::variant<std::monostate, io::LayersFile, std::filesystem::path>;

struct RenderSetup : run::RenderSetup {  ///< but for its force, tool and penetrability
    AskedForce asked_force;
    std::optional<PressThrough> press;
    ToolChoice asked_tool = "point";
};

/// The usual ones of `palpate replay`: no ramp, no limit on the change of force.
ForceSettings offline_force();
/// `asked`, with what it leaves open as in `usual`.
ForceSettings force_of(const AskedForce& asked, const ForceSettings& usual);
/// Which settings of the force, of the tool, of pressing and of layers are not the usual ones.
run::Given given_in(const RenderSetup& setup);
/// Throws std::invalid_argument and io::InputError for a tool's text or file, and
/// std::invalid_argument for settings that change nothing.
run::RenderSetup setup_of(const RenderSetup& setup, const ForceSettings& usual = {});
/// The tool as it was given, where it was given as points.
std::shared_ptr<const Tool> tool_in(const RenderSetup& setup);
/// Warns as the command line does if there is nothing to touch at this level.
void warn_of_level(const RenderSetup& setup, const Field& field, double isovalue, int calls);
/// Resolved for a field. Throws std::invalid_argument.
Penetrability penetrability_for(const PressThrough& press, const Field& field, double isovalue);

}  // namespace palpate::python
