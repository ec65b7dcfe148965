// A synthetic neuron: a soma and branching tubes that fill a thousandth of the volume, as a
// confocal microscope sees one. It stands in for the paper's neuron, which is not to be had.
#pragma once

#include <cstdint>

#include "evaluation/subject.hpp"

namespace palpate::evaluation {

/// uint8, spacing 1 mm; tubes of 1 to 4 voxels radius whose density falls from 255 at their axis to
/// 0 two voxels outside; felt at 64. Same arguments, same samples.
Subject synthetic_neuron(const Index3& size, std::uint64_t seed);

}  // namespace palpate::evaluation
