// Closed walls of any thickness: shells of samples that no path through the lattice passes. A ramp
// sampled thinner than a voxel would have holes, through which a proxy may rightly go.
#pragma once

#include "evaluation/subject.hpp"

namespace palpate::evaluation {

/// What the wall encloses: a box, whose wall is flat with corners, or a ball of voxels, whose wall
/// goes in steps.
enum class Enclosed : std::uint8_t { box, ball };

/// A wall round a hollow body, `thickness` [voxel] on every flat face and thicker at edges and
/// steps; spacing 1 mm. Every face of the body has its four samples full, so a linear field is full
/// all over the face, and the wall is closed at any level below that; the level sets how thick it
/// is: t = (layers - 1) + 2 (1 - level). A smooth field needs two layers for that, between which it
/// is full. Throws std::invalid_argument unless 0 < thickness <= 4.
Subject closed_shell(Enclosed enclosed, double thickness, Interpolation interpolation);

}  // namespace palpate::evaluation
