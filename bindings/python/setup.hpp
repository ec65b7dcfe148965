// How to feel, as Python gives it: run::RenderSetup with a tool by its text or as points.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "palpate/run/setup.hpp"

namespace palpate::python {

/// Pressing through surfaces: from range to range where there are ranges, else beyond a threshold.
struct PressThrough {
    double threshold = 1;              ///< PT [device mm]
    std::optional<io::Level> minimum;  ///< least level felt; nothing: the isovalue
    std::vector<std::pair<io::Level, io::Level>> ranges;
};

using ToolChoice = std::variant<std::string, std::shared_ptr<Tool>>;
using LayersChoice = std::variant<std::monostate, io::LayersFile, std::string>;

struct RenderSetup {
    run::RenderSetup given;  ///< but for the tool and penetrability
    std::optional<PressThrough> penetrability;
    ToolChoice tool = "point";
};

/// The ramp and the limit on the change of force, which a live session has, are off.
RenderSetup offline_setup();
/// Throws std::invalid_argument and io::InputError for a tool's text or file.
run::RenderSetup setup_of(const RenderSetup& setup);
/// The tool as it was given, where it was given as points.
std::shared_ptr<const Tool> tool_in(const RenderSetup& setup);
/// Resolved for a field. Throws std::invalid_argument.
Penetrability penetrability_for(const PressThrough& press, const Field& field, double isovalue);

}  // namespace palpate::python
