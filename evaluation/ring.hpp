// A closed trajectory of a hand round a body, just below its surface.
#pragma once

#include <vector>

#include "evaluation/subject.hpp"

namespace palpate::evaluation {

/// A closed polyline, travelled by its length.
class Ring {
  public:
    /// At least three points [mm, physical].
    explicit Ring(std::vector<Vec3> points);

    double length() const { return arc_.back(); }  ///< [mm]
    /// The point `arc` [mm] from the start; it goes on after a full turn.
    Vec3 at(double arc) const;

  private:
    std::vector<Vec3> points_;  // the first again at the end
    std::vector<double> arc_;
};

/// Round the grid's z axis through its centre: where rays from outside towards the centre first
/// meet the surface, pushed in by `depth` [mm]. Rays that meet nothing take their neighbours'
/// radius. Throws std::invalid_argument if fewer than half of them meet the surface: such a body is
/// not gone round like this.
Ring ring_round(const Subject& subject, double depth);

}  // namespace palpate::evaluation
