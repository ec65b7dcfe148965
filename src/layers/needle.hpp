// A needle in tissue: a line, the surfaces that its shaft goes through, and what rubs on it.
#pragma once

#include "palpate/layers.hpp"

namespace palpate {

/// The hand's place along the line [mm, physical].
double along_line(const NeedleState& needle, const Vec3& point);
Vec3 on_line(const NeedleState& needle, double at);
inline bool has_room(const NeedleState& needle) {
    return needle.crossing_count < NeedleState::most_crossings;
}
/// The shaft goes through one more surface, into a layer (-1: out of all). Needs has_room().
void cross(NeedleState& needle, int surface, int layer, const Vec3& point);
/// True where the tip is at the surface that it crossed last: its channel is open.
bool is_in_channel(const NeedleState& needle, int surface, const Vec3& tip, double closing);
/// The tip came back out of the surfaces that it left by `closing`.
void withdraw(NeedleState& needle, const Vec3& tip, double closing);
/// Two springs across each other, of which the hand feels at most a limit.
struct Spring {
    double force = 0;      ///< [N]
    double stiffness = 0;  ///< [N/mm]
};
/// Which parts of their forces these two give, so that both together stay within a limit [N] and
/// are the gradient of a potential, the same as without a limit below it (docs/force.md).
std::array<double, 2> parts_within(double limit, const Spring& one, const Spring& other);
/// Friction along the shaft (Karnopp 1985), which is in the tissue up to the tip, in a tick of this
/// length [s]: the force on the hand along the line [N]. It slips where it would be more than
/// `most` or less than `least`.
double shaft_friction(NeedleState& needle, const Layers& layers, const LayerInput& input,
                      const Vec3& tip, double period, double least, double most);
/// The tip is inside this many layers (past the first `nested` ones: in layer inside - 1 alone),
/// and all surfaces are closed: those that it went through while they were open, like both sides of
/// a thin sheet, are crossed where the tip is. At most a closing distance and a tick's way too
/// late.
void count_surfaces(NeedleState& needle, int inside, int nested, const Vec3& tip);

}  // namespace palpate
