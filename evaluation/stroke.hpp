// A hand that goes through a row of balls while their samples are being read.
#pragma once

#include <functional>

#include "evaluation/virtual_store.hpp"

namespace palpate::evaluation {

struct Stroke {
    Network network;
    double speed = 0;           ///< of the hand [mm/s]
    bool coarse_first = false;  ///< coarser levels are allowed
    double seconds = 0;
    double rate = 1000;        ///< [Hz]
    std::uint64_t memory = 0;  ///< [bytes]
    std::uint64_t seed = 1;
};

struct StrokeResult {
    std::int64_t ticks = 0, touching = 0, waiting = 0;
    std::int64_t coarse = 0;  ///< ticks at a coarser level than the finest
    /// Of any point of the proxy's path in a ball, beyond what the samples' rounding and the
    /// interpolation at the level that is felt there may take [voxel].
    double beyond = -1e9;
    double deepest = -1e9;         ///< in the ball itself [voxel]
    double first_contact_s = -1;   ///< since the store was opened; negative: none
    std::uint64_t most_bytes = 0;  ///< of bricks and decoded pieces
    stream::Traffic traffic;
};

/// At the pace of the rate, in real time. `progress` is called ten times a second with the part
/// that is done, and may throw to stop.
StrokeResult feel(const Stroke& stroke, const std::function<void(double)>& progress);

}  // namespace palpate::evaluation
