// Bodies whose true surface is known, and trajectories of a hand just below it.
#pragma once

#include <functional>
#include <string>

#include "evaluation/subject.hpp"

namespace palpate::evaluation {

/// What a body's samples are: as they come in 8 bits, 8 bits smoothed in one pass or dequantized,
/// or not rounded at all.
enum class Samples : std::uint8_t { uint8, smoothed, dequantized, float32 };
const char* name_of(Samples samples);

/// A body and the trajectory of a hand.
struct Body {
    explicit Body(Subject s) : subject(std::move(s)) {}

    Subject subject;
    std::string trajectory;     ///< its name
    std::string samples;        ///< how they are stored
    int grid = 0;               ///< samples along the longest axis
    double depth = 0;           ///< [mm] of the hand below the true surface, where that is constant
    Vec3 start = Vec3::Zero();  ///< a free place near the trajectory's start [mm, physical]
    std::function<Vec3(double part)> hand;  ///< from 0 to 1 [mm, physical]
    /// Where a perfect force at this place of the hand would point to (unit vector); empty where
    /// it is not known.
    std::function<Vec3(const Vec3& hand)> ideal;
};

/// The ball of the protocol: radius 0.35 in a unit box, density 1/2 + 1.4 (0.35 - r), the hand 0.03
/// below the surface; `grid` samples an axis.
Subject protocol_ball(int grid, Samples samples);
/// A tilted great circle, one turn.
Body ball_by_circle(int grid, Samples samples);
/// From pole to pole of a tilted axis in 20 turns, evenly over the surface.
Body ball_by_spiral(int grid, Samples samples);
/// Once round the ring and 20 times round its tube, 0.03 of the ring's box below the surface.
Body torus_by_helix(int grid, Samples samples);
/// In a plane, 0.03 of the box below the deepest trough of the Marschner-Lobb signal, in a spiral
/// of 20 turns over its ripples.
Body ripples_by_spiral(int grid, Samples samples);
/// A volume of the user: round the z axis, 0.03 of the shortest axis below the surface. Throws
/// std::invalid_argument if it cannot be gone round.
Body body_of(const Subject& subject);

}  // namespace palpate::evaluation
