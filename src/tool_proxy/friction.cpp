// Friction of a tool by sweeps over its contacts (projected Gauss and Seidel). Each contact takes
// as much of the pull as keeps it from slipping, up to the limit of its pressure. After each sweep
// the pressures are computed again.
#include "tool_proxy/friction.hpp"

#include <cmath>

namespace palpate::tool {
namespace {

constexpr int most_sweeps = 40;

using Force = std::array<double, 2>;  // of a contact, along its tangents [mm]

/// No longer than `most`.
void shorten(Force& force, double most) {
    const double length = std::sqrt(force[0] * force[0] + force[1] * force[1]);
    if (!(length > most)) return;
    for (double& f : force) f *= most / length;
}

}  // namespace

Held held_by_friction(const Six& pull, const HalfSpace6* half_spaces, const Tangents* tangents,
                      int count, double coefficient, double tolerance, double at_rest) {
    std::array<Force, most_half_spaces> held{};
    Six left = pull;
    double most_slip = 0;
    int work = 0;
    for (int sweep = 0; sweep < most_sweeps; ++sweep) {
        const Nearest next = nearest(left, half_spaces, count, tolerance);
        work += next.work + (count + 3) / 4;
        if (!next.found) break;
        Six motion = next.point;
        most_slip = 0;
        double most_change = 0;
        for (int i = 0; i < count; ++i) {
            const double most = coefficient * next.multiplier[i];
            if (!(most > 0) && held[i] == Force{}) continue;
            Force force = held[i];
            double slip_squared = 0;
            for (int k = 0; k < 2; ++k) {
                const Six& row = tangents[i].row[k];
                const double slip = dot(row, motion);
                slip_squared += slip * slip;
                force[k] += slip / dot(row, row);
            }
            if (next.multiplier[i] > 0) most_slip = std::max(most_slip, std::sqrt(slip_squared));
            shorten(force, most);
            for (int k = 0; k < 2; ++k) {
                const double change = force[k] - held[i][k];
                most_change = std::max(most_change, std::abs(change));
                left -= change * tangents[i].row[k];
                motion -= change * tangents[i].row[k];
            }
            held[i] = force;
        }
        if (most_change <= tolerance) break;
    }
    return {left, most_slip > at_rest, work};
}

}  // namespace palpate::tool
