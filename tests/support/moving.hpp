// A hand in a moving field, and checks for every tick: the SCP is free in the field of the tick,
// and the force keeps its limit and its rate.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "palpate/session.hpp"
#include "support/edits.hpp"
#include "support/scripted_device.hpp"

namespace palpate::support {

struct MovingContact {
    Session session;
    double time = 0;
    Vec3 hand = Vec3::Zero();
    SessionTick last;
    Vec3 last_force = Vec3::Zero();
    std::int64_t ticks = 0, constrained = 0, recovering = 0, rate_limited = 0;
    double worst_g1 = -1;

    static constexpr double rate = 60;  // [N/s]: low, so that it binds

    MovingContact(std::shared_ptr<const Samples> samples, double isovalue, const Vec3& at,
                  double background = 0, Solid solid = Solid::above)
        : session{make_renderer(linear_field(std::move(samples), solid, background), isovalue), {}},
          hand(at) {
        session.renderer.settings.force.rate_limit = rate;
        session.renderer.settings.force.ramp = 0;
    }

    const Field& field() const { return session.renderer.field; }
    const ProxyUpdate& proxy() const { return last.tick.proxy; }

    /// A tick, checked. Stop at the first failure.
    const SessionTick& tick() {
        last = advance(session, time += 1e-3, ready_at(hand));
        ++ticks;
        check();
        return last;
    }

  private:
    void check() {
        const ProxyUpdate& p = last.tick.proxy;
        const Vec3& force = last.tick.force;
        const bool recovers = p.status == UpdateStatus::recovering;
        recovering += recovers;
        constrained += p.mode == Mode::constrained;
        rate_limited += (last.tick.force_flags & force_rate_limited) != 0;
        ASSERT_TRUE(p.scp.allFinite() && force.allFinite()) << "tick " << ticks;
        ASSERT_NE(p.status, UpdateStatus::refused);
        if (!recovers) {
            const double density = value_at(field(), session.renderer.proxy.scp);
            const double excess = field().sign() * (density - p.isovalue) / field().range();
            worst_g1 = std::max(worst_g1, excess);
            ASSERT_LE(excess, 1e-9) << "G1 in tick " << ticks;
            if (p.mode == Mode::constrained) {
                ASSERT_GE(excess, -1e-9) << "G2 in tick " << ticks;
            } else if (p.status == UpdateStatus::done) {
                ASSERT_EQ(p.scp, p.hip);
            }
        } else {
            ASSERT_EQ(force, Vec3(0, 0, 0)) << "force while the way out is sought";
        }
        ASSERT_LE(force.norm(), 3.3 + 1e-12);
        // A force that stops because recovery finds no free space drops at once.
        if (!recovers) {
            ASSERT_LE((force - last_force).norm(), rate * 1e-3 + 1e-9) << "tick " << ticks;
        }
        last_force = force;
    }
};

/// Frames of a function of index and time [s], `interval` apart, the first at 0.
template <class T = float, class F>
std::shared_ptr<const Samples> played(const Geometry& geometry, double duration, double interval,
                                      F&& density) {
    std::vector<Frame> frames;
    for (double t = 0; t <= duration + 1e-9; t += interval) {
        frames.push_back({t, volume_of<T>(geometry, [&](const Index3& i) {
                              return density(Vec3(i.cast<double>()), t);
                          })});
    }
    return std::make_shared<const Samples>(std::move(frames));
}

}  // namespace palpate::support
