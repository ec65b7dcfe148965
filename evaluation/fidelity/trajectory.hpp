// Moves a hand along a body's trajectory and compares the force with that of the true surface.
#pragma once

#include <vector>

#include "evaluation/contestants.hpp"
#include "evaluation/fidelity/bodies.hpp"

namespace palpate::evaluation {

/// Of one number over the ticks of a trajectory; NaN where it was never measured.
struct Spread {
    double mean = 0, median = 0, p99 = 0, max = 0;
};
Spread spread_of(const std::vector<double>& numbers);

struct TrajectoryResult {
    Spread angle;          ///< [deg] of the force to the true normal at the SCP
    Spread off_ideal;      ///< [deg] of the force to Body::ideal
    Spread surface_error;  ///< [mm] of the SCP to the true surface, to first order
    Spread turn;           ///< [deg] of the force from tick to tick
    Spread jump;           ///< |change of the force| from tick to tick / mean |force|
    Spread update_us;      ///< [us] of an update alone, the clock's own time included
    double contact_share = 0;
    double step = 0;             ///< [mm] mean, of the hand in a tick
    double worst_deviation = 0;  ///< of an SCP in contact from the level, relative to the range
    std::vector<double> angles;  ///< [deg] off_ideal, tick by tick; NaN without contact
    std::vector<double> turns;   ///< [deg] of the force from each tick to the next, in contact
};

/// From part `from` to part `to` of the body's trajectory in equal parts, one tick each. The force
/// is SCP - HIP: stiffness does not turn it.
TrajectoryResult follow(const Body& body, const Contestant& contestant, int steps, double from,
                        double to);

/// The same angles and errors of a proxy that is always at the sampled isosurface's nearest point;
/// what has to do with time or with ticks is NaN.
TrajectoryResult follow_nearest(const Body& body, int steps);

/// Of a subject's analytic density [1/mm]. Central differences over 1e-3 mm: the surfaces here bend
/// by far more than that.
Vec3 true_gradient(const Subject& subject, const Vec3& physical);

}  // namespace palpate::evaluation
