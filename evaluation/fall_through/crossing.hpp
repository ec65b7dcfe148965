// A hand that moves straight through a wall, and whether the proxy follows it.
#pragma once

#include <optional>
#include <vector>

#include "evaluation/fall_through/outside.hpp"
#include "evaluation/subject.hpp"
#include "palpate/proxy.hpp"

namespace palpate::evaluation {

/// A straight line of the hand, from outside into the solid and, where that is a wall, out of it.
struct Crossing {
    Vec3 entry = Vec3::Zero();  ///< where it first meets the surface [mm, physical]
    Vec3 along = Vec3::Zero();  ///< unit vector
    double wall = 0;            ///< [mm] in the solid; infinity if the line ends there
    double end = 0;             ///< [mm] from the entry to where the hand stops, at the latest
};

/// Where lines may end.
enum class Target : std::uint8_t {
    behind_walls,  ///< behind a wall only
    anywhere,      ///< in the solid, too, where the proxy may be on both sides of it
};

/// `count` random lines through random points of the grid, at most 75 degrees off the normal of the
/// surface where they meet it. A line goes from outside through the first wall to 3 voxels behind
/// it, or half the distance to the next wall, if no free path from outside leads there. In a body
/// thicker than 16 voxels, or one that a proxy may go round, it ends 4 voxels deep or half way
/// through. Throws std::invalid_argument if hardly a line meets such a wall or body.
std::vector<Crossing> draw_crossings(const Subject& subject, const Outside& outside, Target target,
                                     std::size_t count, std::uint64_t seed);

/// What a proxy did in a crossing.
struct Passage {
    bool inside = false;   ///< the SCP ended in the solid (by more than a hundredth of the data's
                           ///< range) or in free space that no free path from outside leads to
    bool pressed = false;  ///< the hand was in the solid in at least one tick
    bool inside_pressed = false;  ///< inside already in the last tick of those
    bool felt = false;            ///< in contact in at least one tick
    double worst = 0;  ///< largest excess of any tick's SCP, as a part of the data's range
    int ticks = 0;
};

/// The hand starts `phase` steps before the surface, 0 < phase <= 1, and goes on by `step` [mm] a
/// tick to the crossing's end or, if that is earlier, 50 steps behind the wall; there it rests for
/// a tick.
Passage cross(const Subject& subject, const Outside& outside, const Crossing& crossing,
              ProxyMethod method, double step, double phase);

}  // namespace palpate::evaluation
