// A hand as people use one: it explores free space, comes back to the surface and slides along it,
// again and again. What performance and scaling are measured with, on any body.
#pragma once

#include <cstdint>
#include <vector>

#include "evaluation/subject.hpp"
#include "palpate/proxy.hpp"

namespace palpate::evaluation {

/// Where the hand is in each tick [mm, physical]; the first place is free space.
using Stroke = std::vector<Vec3>;

/// Speeds and lengths are of the hand in physical space: those at the device times the scale of
/// the DeviceTransform.
struct HandAtWork {
    double rate_hz = 1000;
    double speed_mm_s = 50;  ///< mean; it swells and ebbs by 0.8 of that
    double touching = 0.6;   ///< part of its time that it means to touch, 0 to 1
    double depth_mm = 0.5;   ///< how far it presses below the surface
    int strokes = 20;        ///< each from another side to another place of the body
    double stroke_s = 5;
    std::uint64_t seed = 1;
};

/// The hand's strokes over a body. It is no recording: it clings to the surface by a proxy of its
/// own (exact), bounces off what it meets while it explores, and so finds its way over thin
/// branches and through noise alike. Throws std::invalid_argument if the body has no surface that
/// can be reached from outside the grid.
std::vector<Stroke> work(const Subject& subject, const HandAtWork& hand);

/// What a hand did: its mean speed [mm/s, physical] and the share of updates, by the method exact,
/// that ended constrained.
struct Manner {
    double speed_mm_s = 0;
    double constrained_share = 0;
};
Manner manner_of(const Subject& subject, const std::vector<Stroke>& strokes, double rate_hz);

struct Tuned {
    std::vector<Stroke> strokes;
    Manner manner;
    HandAtWork hand;
};

/// Changes speed_mm_s and touching of `hand` by bisection until its strokes come within 2 % of the
/// wanted manner (a share of at most 1) on this body, or as near as two dozen attempts bring it. On
/// a body so fine that the hand slips off all the time, it presses half as deep, and half again.
Tuned tuned(const Subject& subject, HandAtWork hand, const Manner& wanted);

}  // namespace palpate::evaluation
