// Checks of force settings and device limits: ranges by their tables, and stability.
#include "palpate/settings.hpp"

#include <array>
#include <cstdio>
#include <stdexcept>
#include <string>

namespace palpate {
namespace {

std::string text_of(double value) {
    std::array<char, 32> text;
    std::snprintf(text.data(), text.size(), "%.6g", value);
    return text.data();
}

[[noreturn]] void refuse(const std::string& setting, double value, const std::string& wanted) {
    throw std::invalid_argument(setting + " = " + text_of(value) + ": must be " + wanted);
}

/// Each value is in its range. Builds no text, so allocates nothing, if all is well.
template <class T>
void check_ranges(const T& settings) {
    for_each_setting<T>([&](const auto& one) {
        const auto& value = settings.*one.member;
        if constexpr (Described<std::remove_cvref_t<decltype(value)>>) {
            check_ranges(value);
        } else if (!one.range.has(value)) {
            refuse(std::string(one.title) + " [" + one.unit + "]", value, one.range.words);
        }
    });
}

std::string most_words(double most, const DeviceLimits& limits) {
    const std::string delay =
        limits.delay > 0 ? " and a delay of " + text_of(1e3 * limits.delay) + " ms" : "";
    return "at most " + text_of(most) + " at " + text_of(limits.rate) + " Hz" + delay +
           " to be rendered stably";
}

void check_rotation(const ForceSettings& s, const DeviceLimits& limits) {
    if (!(s.rotational_damping < limits.physical_rotational_damping)) {
        refuse("rotational damping [N mm s/rad]", s.rotational_damping,
               "below the physical rotational damping of device and hand, " +
                   text_of(limits.physical_rotational_damping));
    }
    DeviceLimits turning = limits;
    turning.physical_damping = limits.physical_rotational_damping;
    const double most = greatest_stiffness(turning, s.rotational_damping);
    if (!(s.rotational_stiffness <= most)) {
        refuse("rotational stiffness [N mm/rad]", s.rotational_stiffness, most_words(most, limits));
    }
}

}  // namespace

void check(const DeviceLimits& limits) {
    check_ranges(limits);
}

void check(const ForceSettings& s, const DeviceLimits& limits) {
    check(limits);
    check_ranges(s);
    const double damping = s.damping + s.viscosity;
    if (!(damping < limits.physical_damping)) {
        refuse(
            "damping + viscosity [N s/mm]", damping,
            "below the physical damping of device and hand, " + text_of(limits.physical_damping));
    }
    const double most = greatest_stiffness(limits, damping);
    if (!(s.stiffness <= most)) {
        refuse("stiffness [N/mm]", s.stiffness, most_words(most, limits));
    }
    check_rotation(s, limits);
    // 4 peak / distance is the magnet's own stiffness where it is steepest.
    if (s.magnet.distance > 0 && !(4 * s.magnet.peak <= most * s.magnet.distance)) {
        refuse("magnet peak [N]", s.magnet.peak,
               "at most " + text_of(most * s.magnet.distance / 4) + " over this distance");
    }
}

}  // namespace palpate
