// A polyline measured by arc length, and how a hand travels along it. Internal to scenes/.
#pragma once

#include <vector>

#include "palpate/volume.hpp"

namespace palpate::scenes {

/// A polyline of at least one point, measured by arc length [mm].
class Track {
  public:
    explicit Track(std::vector<Vec3> points);

    double length() const { return arc_.back(); }
    const std::vector<Vec3>& points() const { return points_; }
    /// The point at an arc length, held at the ends.
    Vec3 at(double arc) const;

  private:
    std::vector<Vec3> points_;
    std::vector<double> arc_;
};

/// The track with its corners rounded over about `radius` [mm]: twice a moving average, so it stays
/// in the convex hull of its points. A closed track (last point = first) stays closed.
Track rounded(const Track& track, double radius, bool closed);

/// A journey from rest to rest: the speed rises and falls smoothly over `ramp_s`, and never passes
/// `speed`. Short distances are travelled slower, with the same acceleration (at most 1.5 speed /
/// ramp).
class Journey {
  public:
    Journey(double length_mm, double speed_mm_s);

    static constexpr double ramp_s = 0.1;

    double duration() const { return duration_; }
    /// [mm] after t seconds: 0 before the start, the whole length after the end.
    double travelled(double t) const;
    /// The same, to the end and back, repeatedly.
    double there_and_back(double t) const;
    /// The same start, but without slowing down at the end.
    double without_end(double t) const;

  private:
    double length_ = 0;
    double peak_ = 0;  // [mm/s]
    double ramp_ = 0;  // [s]
    double duration_ = 0;
};

}  // namespace palpate::scenes
