// Steers a hand over a surface, and searches for the speed and share of contact that are wanted.
#include "evaluation/exploring_hand.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <stdexcept>

#include "scenes/random.hpp"

namespace palpate::evaluation {
namespace {

using scenes::Random;

constexpr double smoothing_s = 0.01;  // of the normal that it feels
constexpr double cycle_s = 2;         // exploring once and touching once
constexpr double swell = 0.8;         // of the speed, up and down
constexpr double swell_hz = 1.3;

Vec3 unit(const Vec3& v, const Vec3& otherwise) {
    const double length = v.norm();
    return length > 1e-12 ? Vec3(v / length) : otherwise;
}

Vec3 unit_vector(Random& random) {
    for (;;) {
        const double x = random.uniform(-1, 1), y = random.uniform(-1, 1),
                     z = random.uniform(-1, 1);
        const double square = x * x + y * y + z * z;
        if (square > 1e-4 && square <= 1) return Vec3(x, y, z) / std::sqrt(square);
    }
}

bool is_solid(const Field& field, double isovalue, const Vec3& physical) {
    return field.sign() * (value_at(field, physical) - isovalue) > field.tolerance();
}

/// A random sample in the solid; nothing if hardly any is.
std::optional<Vec3> solid_sample(const Subject& subject, Random& random) {
    constexpr int most_tries = 3'000'000;
    const Field& field = subject.field;
    const Vec3 size = field.geometry().size.cast<double>();
    for (int i = 0; i < most_tries; ++i) {
        const Vec3 at(random.uniform(), random.uniform(), random.uniform());
        const Index3 index = size.cwiseProduct(at).cast<int>();
        if (field.sign() * (field.volume().sample(index) - subject.isovalue) > 0) {
            return physical_from_index(field.geometry(), index.cast<double>());
        }
    }
    return {};
}

/// The first contact of a hand from outside, on a straight line to a solid sample.
struct Place {
    Vec3 point, outward;  // [mm, physical]; outward is where it came from
};

std::vector<Place> places(const Subject& subject, int count, Random& random) {
    const Geometry& geometry = subject.field.geometry();
    const double outside =
        (geometry.size + Index3::Constant(2)).cast<double>().cwiseProduct(geometry.spacing).norm();
    std::vector<Place> found;
    for (int i = 0; i < count; ++i) {
        const auto target = solid_sample(subject, random);
        if (!target) break;
        const Vec3 outward = unit_vector(random);
        const Vec3 from = *target + outside * outward;
        if (is_solid(subject.field, subject.isovalue, from)) continue;
        const RayHit hit = cast_ray(subject.field, subject.isovalue, from, *target);
        if (hit.hit) found.push_back({hit.point, outward});
    }
    if (found.empty()) {
        throw std::invalid_argument(subject.name +
                                    ": a hand from outside meets no surface at this level; choose "
                                    "another level or volume");
    }
    return found;
}

/// A hand on one trajectory.
class Steering {
  public:
    Steering(const Subject& subject, const ExploringHand& hand, const Place& place, Random& random)
        : field_(subject.field),
          hand_(hand),
          random_(random),
          hip_(place.point + 2 * hand.depth_mm * place.outward),
          touched_(place.point),
          normal_(place.outward),
          heading_(-place.outward) {
        palpate::place(proxy_, field_, hip_, subject.isovalue);
        new_cycle();
    }

    Vec3 step(double t) {
        const double into = std::fmod(t, cycle_s);
        if (into < into_cycle_) new_cycle();
        into_cycle_ = into;
        const bool touches = t < first_touch_s || into >= (1 - hand_.touching) * cycle_s;
        const Vec3 direction = touches ? touching() : exploring();
        const double swelling = 1 + swell * std::sin(2 * std::numbers::pi * swell_hz * t);
        hip_ += hand_.speed_mm_s * swelling / hand_.rate_hz * direction;
        feel();
        return hip_;
    }
    const Vec3& hip() const { return hip_; }

  private:
    static constexpr double first_touch_s = 0.2;  // it begins by coming to the surface

    void new_cycle() {
        turn_per_s_ = random_.uniform(-1.5, 1.5);
        heading_ = unit(normal_ + 0.7 * unit_vector(random_), normal_);
    }

    void feel() {
        constrained_ = update_exact(proxy_, field_, hip_).mode == Mode::constrained;
        if (!constrained_) return;
        const double share = 1 / (smoothing_s * hand_.rate_hz + 1);
        touched_ = proxy_.scp_physical;
        const Vec3 felt = normal_at(proxy_, field_);
        normal_ = unit(normal_ + share * (felt - normal_), felt);
    }

    /// Away from where it last touched; off whatever it meets.
    Vec3 exploring() {
        if (constrained_ && heading_.dot(normal_) < 0.5) {
            heading_ = unit(heading_ + (1 - heading_.dot(normal_)) * normal_, normal_);
        }
        return heading_;
    }

    /// Along the surface at its depth, in a slow turn; free, straight back to the surface.
    Vec3 touching() {
        const Vec3 lag = touched_ - hip_;
        if (!constrained_) return unit(lag - hand_.depth_mm * normal_, -normal_);
        const Vec3 across = normal_.cross(along_);
        along_ += turn_per_s_ / hand_.rate_hz * across;
        // If the proxy is held back, the hand returns to it.
        if (lag.norm() > 4 * hand_.depth_mm) along_ = lag;
        along_ = unit(along_ - along_.dot(normal_) * normal_, normal_.unitOrthogonal());
        keep_to_the_body();
        const double missing = (hand_.depth_mm - lag.dot(normal_)) / hand_.depth_mm;
        return unit(along_ - std::clamp(missing, -2.0, 2.0) * normal_, along_);
    }

    /// Turns before an edge, where the hand would slip off.
    void keep_to_the_body() {
        const Vec3 across = normal_.cross(along_);
        for (const double angle : {0.0, 0.7, -0.7, 1.4, -1.4, 2.1, -2.1, 3.1}) {
            const Vec3 turned = std::cos(angle) * along_ + std::sin(angle) * across;
            const Vec3 ahead = hip_ + 2 * hand_.depth_mm * turned;
            if (!is_solid(field_, proxy_.isovalue, ahead)) continue;
            along_ = turned;
            return;
        }
    }

    const Field& field_;
    const ExploringHand& hand_;
    Random& random_;
    Proxy proxy_;
    Vec3 hip_, touched_, normal_, heading_;  // [mm, physical] and unit vectors
    Vec3 along_ = Vec3::Zero();
    double turn_per_s_ = 0, into_cycle_ = 0;
    bool constrained_ = false;
};

/// 0 where both are as wanted.
double miss(const Behaviour& behaviour, const Behaviour& wanted) {
    return std::max(std::abs(behaviour.speed_mm_s / wanted.speed_mm_s - 1),
                    std::abs(behaviour.constrained_share / wanted.constrained_share - 1));
}

}  // namespace

std::vector<Trajectory> explore(const Subject& subject, const ExploringHand& hand,
                                const std::function<void()>& alive) {
    Random random(hand.seed);
    const auto starts = places(subject, hand.trajectories, random);
    const auto ticks = static_cast<std::size_t>(hand.trajectory_s * hand.rate_hz);
    std::vector<Trajectory> trajectories;
    for (int i = 0; i < hand.trajectories; ++i) {
        Steering steering(subject, hand, starts[std::size_t(i) % starts.size()], random);
        Trajectory trajectory{steering.hip()};
        trajectory.reserve(ticks + 1);
        for (std::size_t k = 0; k < ticks; ++k) {
            trajectory.push_back(steering.step(static_cast<double>(k) / hand.rate_hz));
            alive();
        }
        trajectories.push_back(std::move(trajectory));
    }
    return trajectories;
}

Behaviour behaviour_of(const Subject& subject, const std::vector<Trajectory>& trajectories,
                       double rate_hz) {
    double path = 0;
    std::size_t ticks = 0, constrained = 0;
    follow(subject, trajectories, [&](Proxy& proxy, const Trajectory& hand, std::size_t i) {
        path += (hand[i] - hand[i - 1]).norm();
        constrained += update_exact(proxy, subject.field, hand[i]).mode == Mode::constrained;
        ++ticks;
    });
    return {path * rate_hz / double(ticks), double(constrained) / double(ticks)};
}

TunedHand tuned_hand(const Subject& subject, ExploringHand hand, const Behaviour& wanted,
                     const std::function<void()>& alive) {
    constexpr int attempts = 24;
    constexpr double near_enough = 0.02;
    TunedHand best;
    double low = 0, high = 1;
    hand.speed_mm_s = wanted.speed_mm_s;
    hand.touching = wanted.constrained_share;
    for (int attempt = 0; attempt < attempts; ++attempt) {
        auto trajectories = explore(subject, hand, alive);
        const Behaviour behaviour = behaviour_of(subject, trajectories, hand.rate_hz);
        const bool is_best =
            best.trajectories.empty() || miss(behaviour, wanted) < miss(best.behaviour, wanted);
        if (is_best) best = {std::move(trajectories), behaviour, hand};
        if (miss(best.behaviour, wanted) <= near_enough) break;
        if (behaviour.speed_mm_s > 0) hand.speed_mm_s *= wanted.speed_mm_s / behaviour.speed_mm_s;
        (behaviour.constrained_share < wanted.constrained_share ? low : high) = hand.touching;
        hand.touching = 0.5 * (low + high);
        const double least = (1 - near_enough) * wanted.constrained_share;
        if (low < 0.98 || behaviour.constrained_share >= least) continue;
        // It means to touch all the time and slips off: the body is too fine for so firm a hand.
        hand.depth_mm *= 0.5;
        hand.touching = wanted.constrained_share;
        low = 0;
        high = 1;
    }
    return best;
}

}  // namespace palpate::evaluation
