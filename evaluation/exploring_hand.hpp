// A simulated hand that explores free space, comes back to the surface and slides along it, again
// and again. The experiments performance and scaling measure with it, on any body.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "evaluation/subject.hpp"
#include "palpate/proxy.hpp"

namespace palpate::evaluation {

/// Where the hand is in each tick [mm, physical]; the first place is free space.
using Trajectory = std::vector<Vec3>;

/// Calls step(proxy, trajectory, i) for each tick i of each trajectory, with a proxy that was
/// placed where the trajectory starts.
template <class Step>
void follow(const Subject& subject, const std::vector<Trajectory>& trajectories, Step&& step) {
    for (const Trajectory& trajectory : trajectories) {
        Proxy proxy;
        place(proxy, subject.field, trajectory.front(), subject.isovalue);
        for (std::size_t i = 1; i < trajectory.size(); ++i) step(proxy, trajectory, i);
    }
}

/// Speeds and lengths are of the hand in physical space: those at the device times the scale of
/// the DeviceTransform.
struct ExploringHand {
    double rate_hz = 1000;
    double speed_mm_s = 50;  ///< mean; it swells and ebbs by 0.8 of that
    double touching = 0.6;   ///< part of its time that it means to touch, 0 to 1
    double depth_mm = 0.5;   ///< how far it presses below the surface
    int trajectories = 20;   ///< each from another side to another place of the body
    double trajectory_s = 5;
    std::uint64_t seed = 1;
};

/// The hand's trajectories over a body. The hand keeps to the surface by a proxy of its own (exact)
/// and bounces off what it meets while it explores, so that thin branches and noise do not stop it.
/// Throws std::invalid_argument if the body has no surface that can be reached from outside the
/// grid. `alive` is called after every tick, and may throw to stop it.
std::vector<Trajectory> explore(
    const Subject& subject, const ExploringHand& hand, const std::function<void()>& alive = [] {});

/// Mean speed [mm/s, physical] and the share of updates, by the method exact,
/// that ended constrained.
struct Behaviour {
    double speed_mm_s = 0;
    double constrained_share = 0;
};
Behaviour behaviour_of(const Subject& subject, const std::vector<Trajectory>& trajectories,
                       double rate_hz);

struct TunedHand {
    std::vector<Trajectory> trajectories;
    Behaviour behaviour;
    ExploringHand hand;
};

/// Changes speed_mm_s and touching of `hand` by bisection until its trajectories come within 2 % of
/// the wanted behaviour (a share of at most 1) on this body, or as near as two dozen attempts bring
/// it. On a body so fine that the hand slips off all the time, it presses half as deep, and half
/// again.
TunedHand tuned_hand(
    const Subject& subject, ExploringHand hand, const Behaviour& wanted,
    const std::function<void()>& alive = [] {});

}  // namespace palpate::evaluation
