// Describes each number that a running session can change once: its unit, range and purpose. Files,
// command-line options, live commands, the C interface and the Python module are made from these
// tables. Other structs have their table beside them. A setting's default is that of its struct.
#pragma once

#include <stdexcept>
#include <string>
#include <tuple>
#include <vector>

#include "palpate/names.hpp"
#include "palpate/session.hpp"

namespace palpate {

template <>
inline constexpr auto settings_of<Friction> =
    std::tuple{setting(&Friction::static_coefficient, "static_coefficient", "",
                       "Pull along the surface that moves a resting proxy, as a part of the pull "
                       "into it (0: none)")
                   .titled("static friction")
                   .in_files("static")
                   .within(ranges::not_negative),
               setting(&Friction::dynamic_coefficient, "dynamic_coefficient", "",
                       "The same for a moving proxy. At most the static one")
                   .titled("dynamic friction")
                   .in_files("dynamic")
                   .within(ranges::not_negative)};

template <>
inline constexpr auto settings_of<Magnet> =
    std::tuple{setting(&Magnet::distance, "distance", "device mm",
                       "Distance at which the magnet ends (0: off)")
                   .titled("magnet distance")
                   .within(ranges::not_negative),
               setting(&Magnet::peak, "peak", "N", "Force of the magnet at half of that distance")
                   .titled("magnet peak")
                   .within(ranges::not_negative)};

template <>
inline constexpr auto settings_of<Texture> = std::tuple{
    setting(&Texture::amplitude, "amplitude", "mm, physical", "Height of the bumps (0: off)")
        .titled("texture amplitude")
        .within(ranges::not_negative),
    setting(&Texture::wavelength, "wavelength", "mm, physical",
            "Distance from one bump to the next")
        .titled("texture wavelength")
        .within(ranges::positive)};

template <>
inline constexpr auto settings_of<ForceSettings> = std::tuple{
    setting(&ForceSettings::stiffness, "stiffness", "N/mm", "Stiffness")
        .as_option("-k,--stiffness")
        .if_open("0.5, or less if the device needs it")
        .within(ranges::not_negative),
    setting(&ForceSettings::damping, "damping", "N s/mm", "Damping along the contact normal")
        .as_option("--damping")
        .within(ranges::not_negative),
    setting(&ForceSettings::viscosity, "viscosity", "N s/mm", "Viscosity of the medium")
        .as_option("--viscosity")
        .within(ranges::not_negative),
    setting(&ForceSettings::magnet, "magnet", "", "Pull the hand to a surface that is near")
        .as_option("--magnet"),
    setting(&ForceSettings::texture, "texture", "", "Bumps on the surface").as_option("--texture"),
    setting(&ForceSettings::limit, "limit", "N", "Largest force, within the device's limit")
        .titled("force limit")
        .as_option("--force-limit")
        .if_open("the device's; offline 3.3")
        .within(ranges::not_negative),
    setting(&ForceSettings::rate_limit, "rate_limit", "N/s", "Largest change of force")
        .titled("force rate limit")
        .as_option("--force-rate")
        .if_open("2000; in replay() inf")
        .within(ranges::limit),
    setting(&ForceSettings::ramp, "ramp", "s",
            "Duration of the rise of the force from zero at the start")
        .titled("force ramp")
        .as_option("--ramp")
        .if_open("0.25; in replay() 0")
        .within(ranges::not_negative),
    setting(&ForceSettings::stale_after, "stale_after", "s",
            "A longer time between two readings of the device is a pause")
        .titled("stale time")
        .within(ranges::limit),
    setting(
        &ForceSettings::start_below, "start_below", "N",
        "No force after a start or a pause until the computed one is this small (inf: do not wait)")
        .titled("force to start below")
        .as_option("--start-below")
        .if_open("0.3 in a Run, else inf")
        .within(ranges::start),
    setting(&ForceSettings::rotational_stiffness, "rotational_stiffness", "N mm/rad",
            "Rotational stiffness of a tool (0: from stiffness and the tool's gyration)")
        .titled("rotational stiffness")
        .as_option("--rotational-stiffness")
        .within(ranges::not_negative),
    setting(&ForceSettings::rotational_damping, "rotational_damping", "N mm s/rad",
            "Rotational damping of a tool")
        .titled("rotational damping")
        .as_option("--rotational-damping")
        .within(ranges::not_negative),
    setting(&ForceSettings::torque_limit, "torque_limit", "N mm", "Largest torque")
        .titled("torque limit")
        .as_option("--torque-limit")
        .within(ranges::limit_or_zero),
    setting(&ForceSettings::torque_rate_limit, "torque_rate_limit", "N mm/s",
            "Largest change of torque")
        .titled("torque rate limit")
        .within(ranges::limit)};

template <>
inline constexpr auto settings_of<DeviceLimits> = std::tuple{
    setting(&DeviceLimits::maximum_force, "maximum_force", "N",
            "Largest force that the device may get")
        .titled("maximum force")
        .within(ranges::positive),
    setting(&DeviceLimits::rate, "rate", "Hz", "Rate of the servo loop").within(ranges::rate),
    setting(&DeviceLimits::physical_damping, "physical_damping", "N s/mm",
            "Damping of device and hand themselves")
        .titled("physical damping")
        .within(ranges::positive),
    setting(&DeviceLimits::maximum_torque, "maximum_torque", "N mm",
            "Largest torque that the device may get (0: it renders none)")
        .titled("maximum torque")
        .within(ranges::not_negative),
    setting(&DeviceLimits::physical_rotational_damping, "physical_rotational_damping", "N mm s/rad",
            "Damping of device and hand themselves against turning")
        .titled("physical rotational damping")
        .within(ranges::positive),
    setting(&DeviceLimits::delay, "delay", "s",
            "Time from measuring a position until the force for it acts, without the sampling")
        .within(ranges::not_negative),
    setting(&DeviceLimits::continuous_force, "continuous_force", "N",
            "Force that the motors can give for hours (inf: all that they can give)")
        .titled("continuous force")
        .within(ranges::limit),
    setting(&DeviceLimits::warming_time, "warming_time", "s",
            "Time in which a constant force brings the motors to 63 % of its warmth")
        .titled("warming time")
        .within(ranges::positive)};

/// Calls visit(name, setting, number, group) for each number that a running session can change: a
/// command changes all of its group. "force.stiffness" is a name.
void for_each_live_number(auto& settings, auto&& visit) {
    const auto walk = [&](const char* path, auto& group) {
        for_each_number(path, group, [&](const std::string& name, const auto& one, auto& number) {
            visit(name, one, number, group);
        });
    };
    walk("force", settings.force);
    walk("friction", settings.proxy.friction);
    walk("limits", settings.device);
}
/// Calls visit(number, group) for the one of that name. Throws std::invalid_argument, suggesting
/// another name, if there is none.
void visit_live_number(auto& settings, const std::string& name, auto&& visit) {
    std::vector<std::string> others;
    bool found = false;
    for_each_live_number(settings, [&](const auto& one, const auto&, auto& number, auto& group) {
        others.push_back(one);
        if (one != name) return;
        found = true;
        visit(number, group);
    });
    if (found) return;
    throw std::invalid_argument("there is no setting '" + name + "': " + use_one_of(others, name));
}
/// Changes it, without a check, and returns the command that does the same in a session.
inline Command change(RendererSettings& settings, const std::string& name, double value) {
    Command command;
    visit_live_number(settings, name, [&](double& number, auto& group) {
        number = value;
        command = group;
    });
    return command;
}

}  // namespace palpate
