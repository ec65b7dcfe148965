// Bodies and trajectories for scaling, of which one property grows and the others stay the same.
#pragma once

#include <cstdint>

#include "evaluation/exploring_hand.hpp"

namespace palpate::evaluation {

/// A ball in the middle of size^3 samples of spacing 1 mm, so lengths are mm and voxels alike. Its
/// density falls from full to 0 over `edge` across the surface, which is at half.
struct Ball {
    int size = 64;
    double radius = 22;
    double edge = 16;
};

/// uint8, felt at 127.5: with even sizes the same samples round the centre, however large the grid.
Subject ball(const Ball& shape);
/// float32 of 0..1 and white noise of +-amplitude/2, felt at 0.5.
Subject noisy_ball(const Ball& shape, double amplitude, std::uint64_t seed);

/// One trajectory on a sphere of `radius` [mm] round the origin: great circles that turn slowly
/// over the whole of it, `step` [mm] a tick. It begins at `from` [mm] from the centre.
Trajectory round_the_ball(double radius, double step, int ticks, double from);

}  // namespace palpate::evaluation
