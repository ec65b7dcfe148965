// How to feel, as Python gives it: run::RenderSetup with a tool by its text or as points.
#pragma once

#include <array>
#include <filesystem>
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

/// ForceSettings of which the usual ones depend on use and device.
struct AskedForce : ForceSettings {
    AskedForce() = default;
    explicit AskedForce(const ForceSettings& given);

    std::optional<double> asked_stiffness, asked_limit, asked_rate_limit, asked_ramp,
        asked_start_below;  ///< nothing: the usual one
};

/// The numbers that may be left open.
inline constexpr std::array left_open{
    std::pair{&ForceSettings::stiffness, &AskedForce::asked_stiffness},
    std::pair{&ForceSettings::limit, &AskedForce::asked_limit},
    std::pair{&ForceSettings::rate_limit, &AskedForce::asked_rate_limit},
    std::pair{&ForceSettings::ramp, &AskedForce::asked_ramp},
    std::pair{&ForceSettings::start_below, &AskedForce::asked_start_below}};

using ToolChoice = std::variant<std::string, std::shared_ptr<Tool>>;
using LayersChoice = std::variant<std::monostate, io::LayersFile, std::filesystem::path>;

struct RenderSetup {
    run::RenderSetup given;  ///< but for force, tool and penetrability
    AskedForce force;
    std::optional<PressThrough> penetrability;
    ToolChoice tool = "point";
};

/// The usual ones of `palpate replay`: no ramp, no limit on the change of force.
ForceSettings offline_force();
/// `asked`, with what it leaves open as in `usual`.
ForceSettings force_of(const AskedForce& asked, const ForceSettings& usual);
/// Throws std::invalid_argument and io::InputError for a tool's text or file.
run::RenderSetup setup_of(const RenderSetup& setup, const ForceSettings& usual = {});
/// The tool as it was given, where it was given as points.
std::shared_ptr<const Tool> tool_in(const RenderSetup& setup);
/// Resolved for a field. Throws std::invalid_argument.
Penetrability penetrability_for(const PressThrough& press, const Field& field, double isovalue);

}  // namespace palpate::python
