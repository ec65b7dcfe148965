// The grids on which dequantization works: all samples, every second one, every fourth one, ...
#pragma once

#include <functional>
#include <utility>
#include <vector>

#include "filters/terraced_bricks.hpp"

namespace palpate::filters {

/// Takes samples through the rounds of a plan.
class Pyramid {
  public:
    Pyramid(const MovedSamples& all, const DequantizePlan& plan, TerracedBricks bricks,
            Parallel parallel)
        : all_(all), levels_(plan), bricks_(std::move(bricks)), parallel_(std::move(parallel)) {}

    /// The result is in all samples after go_to(1). `done` is called from the calling thread with
    /// the part of a round's work that was done since the last call.
    void run(const DequantizePlan::Rounds& rounds, const std::function<void(double)>& done);
    void go_to(int step);

  private:
    /// A grid's samples in memory of their own.
    struct Grid {
        explicit Grid(const MovedSamples& every_second, const Parallel& parallel);

        std::vector<float> floats;
        std::vector<std::uint16_t> whole;
        std::vector<std::int16_t> moved;
        MovedSamples samples;
    };

    const MovedSamples& top() const { return coarse_.empty() ? all_ : coarse_.back().samples; }

    MovedSamples all_;
    Levels levels_;
    TerracedBricks bricks_;
    Parallel parallel_;
    std::vector<Grid> coarse_;  ///< the finest first
};

}  // namespace palpate::filters
