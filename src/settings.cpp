// Checks of force settings and device limits: ranges by their tables, and stability.
#include "palpate/settings.hpp"

#include <string>

namespace palpate {
namespace {

std::string most_words(double most, const DeviceLimits& limits) {
    const std::string delay =
        limits.delay > 0 ? " and a delay of " + number_text(1e3 * limits.delay) + " ms" : "";
    return "at most " + number_text(most) + " at " + number_text(limits.rate) + " Hz" + delay +
           " to be rendered stably";
}

void check_rotation(const ForceSettings& s, const DeviceLimits& limits) {
    if (!(s.rotational_damping < limits.physical_rotational_damping)) {
        refuse_number("rotational damping [N mm s/rad]", s.rotational_damping,
                      "below the physical rotational damping of device and hand, " +
                          number_text(limits.physical_rotational_damping));
    }
    DeviceLimits turning = limits;
    turning.physical_damping = limits.physical_rotational_damping;
    const double most = greatest_stiffness(turning, s.rotational_damping);
    if (!(s.rotational_stiffness <= most)) {
        refuse_number("rotational stiffness [N mm/rad]", s.rotational_stiffness,
                      most_words(most, limits));
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
        refuse_number("damping + viscosity [N s/mm]", damping,
                      "below the physical damping of device and hand, " +
                          number_text(limits.physical_damping));
    }
    const double most = greatest_stiffness(limits, damping);
    if (!(s.stiffness <= most)) {
        refuse_number("stiffness [N/mm]", s.stiffness, most_words(most, limits));
    }
    check_rotation(s, limits);
    // 4 peak / distance is the magnet's own stiffness where it is steepest.
    if (s.magnet.distance > 0 && !(4 * s.magnet.peak <= most * s.magnet.distance)) {
        refuse_number(
            "magnet peak [N]", s.magnet.peak,
            "at most " + number_text(most * s.magnet.distance / 4) + " over this distance");
    }
}

}  // namespace palpate
