// Moves a proxy tick by tick and measures its force.
#include "evaluation/fidelity/trajectory.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>
#include <numeric>

#include "evaluation/fidelity/nearest_point.hpp"
#include "evaluation/table.hpp"

namespace palpate::evaluation {
namespace {

/// Of vectors that are not zero; accurate near 0, where an arc cosine is not.
double degrees_between(const Vec3& a, const Vec3& b) {
    const Vec3 u = a.normalized(), v = b.normalized();
    return 2 * std::atan2((u - v).norm(), (u + v).norm()) * 180 / std::numbers::pi;
}

/// What is written down at each tick.
struct Log {
    std::vector<double> angle, off_ideal, surface_error, turn, change, strength, update_us;
};

void sum_up(const Log& log, TrajectoryResult& result) {
    result.angle = spread_of(log.angle);
    result.off_ideal = spread_of(log.off_ideal);
    result.surface_error = spread_of(log.surface_error);
    result.turn = spread_of(log.turn);
    result.jump = spread_of(log.change);
    result.update_us = spread_of(log.update_us);
}

void compare(const Body& body, const ProxyUpdate& update, Log& log, std::vector<double>& angles) {
    const Subject& subject = body.subject;
    const Vec3 force = update.scp - update.hip;
    angles.push_back(std::nan(""));
    if (update.mode != Mode::constrained || force.squaredNorm() == 0) return;
    if (subject.exact) {
        const Vec3 gradient = true_gradient(subject, update.scp);
        const double steepness = gradient.norm();
        if (steepness > 0) {
            const Vec3 out = -subject.field.sign() * gradient;
            log.angle.push_back(degrees_between(force, out));
            log.surface_error.push_back(std::abs(subject.exact(update.scp) - subject.isovalue) /
                                        steepness);
            angles.back() = log.angle.back();
        }
    }
    if (body.ideal) {
        log.off_ideal.push_back(degrees_between(force, body.ideal(update.hip)));
        angles.back() = log.off_ideal.back();
    }
}

}  // namespace

Spread spread_of(const std::vector<double>& numbers) {
    const double sum = std::accumulate(numbers.begin(), numbers.end(), 0.0);
    return {sum / double(numbers.size()), quantile(numbers, 0.5), quantile(numbers, 0.99),
            quantile(numbers, 1)};
}

Vec3 true_gradient(const Subject& subject, const Vec3& physical) {
    constexpr double h = 1e-3;  // [mm]
    Vec3 gradient;
    for (int a = 0; a < 3; ++a) {
        const Vec3 step = h * Vec3::Unit(a);
        gradient[a] = (subject.exact(physical + step) - subject.exact(physical - step)) / (2 * h);
    }
    return gradient;
}

TrajectoryResult follow(const Body& body, const Contestant& contestant, int steps, double from,
                        double to) {
    using Clock = std::chrono::steady_clock;
    const Field field = as_felt_by(contestant, body.subject).field;
    const ProxyMethod method = contestant.method;
    Proxy proxy;
    place(proxy, field, body.start, body.subject.isovalue);
    method(proxy, field, body.hand(from), {}, {});
    TrajectoryResult result;
    Log log;
    Vec3 last_force = Vec3::Zero(), last_hand = body.hand(from);
    double contacts = 0, path = 0;
    for (int i = 0; i < steps; ++i) {
        const Vec3 hand = body.hand(from + (to - from) * (i + 1) / steps);
        const auto begin = Clock::now();
        const ProxyUpdate update = method(proxy, field, hand, {}, {});
        const auto end = Clock::now();
        log.update_us.push_back(std::chrono::duration<double, std::micro>(end - begin).count());
        compare(body, update, log, result.angles);
        const bool contact = update.mode == Mode::constrained;
        const Vec3 force = contact ? Vec3(update.scp - update.hip) : Vec3(Vec3::Zero());
        if (contact) {
            contacts += 1;
            log.strength.push_back(force.norm());
            result.worst_deviation =
                std::max(result.worst_deviation,
                         std::abs(update.density - body.subject.isovalue) / field.range());
        }
        if (i > 0) {
            log.change.push_back((force - last_force).norm());
            if (force.squaredNorm() > 0 && last_force.squaredNorm() > 0) {
                log.turn.push_back(degrees_between(force, last_force));
            }
        }
        path += (hand - last_hand).norm();
        last_force = force;
        last_hand = hand;
    }
    const double strength = spread_of(log.strength).mean;
    for (double& change : log.change) change /= strength;
    sum_up(log, result);
    result.turns = std::move(log.turn);
    result.contact_share = contacts / steps;
    result.step = path / steps;
    return result;
}

TrajectoryResult follow_nearest(const Body& body, int steps) {
    const SurfaceMesh mesh = extract_surface(body.subject.field, body.subject.isovalue);
    TrajectoryResult result;
    Log log;
    for (int i = 0; i < steps; ++i) {
        ProxyUpdate rest;
        rest.mode = Mode::constrained;
        rest.hip = body.hand((i + 0.5) / steps);
        rest.scp = nearest_point(mesh, rest.hip);
        compare(body, rest, log, result.angles);
    }
    sum_up(log, result);
    result.contact_share = result.step = result.worst_deviation = std::nan("");
    return result;
}

}  // namespace palpate::evaluation
