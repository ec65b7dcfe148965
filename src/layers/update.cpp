// A tick of layers: how the surfaces that hold the proxy feel, and when they give way.
#include <algorithm>
#include <cmath>
#include <limits>

#include "layers/needle.hpp"
#include "layers/tissues.hpp"
#include "palpate/lattice.hpp"

namespace palpate {
namespace {

/// Surfaces that may give way in one tick.
constexpr int most_punctures = 8;

using enum HapticProperty;

class LayersTick {
  public:
    LayersTick(const std::shared_ptr<const Layers>& layers, LayerState& state, Proxy& proxy,
               const Field& density, const LayerInput& input, StepObserver observer)
        : layers_(*layers),
          state_(state),
          density_(density),
          tissues_(layers, state, proxy, density),
          input_(input),
          observer_(observer) {}

    LayersUpdate run() {
        if (tissues_.is_stale()) begin();
        if (state_.needle.inserted && !layers_.needle) state_.needle = {};
        Vec3 from = state_.moved ? state_.hip : input_.hip;
        move_to(input_.hip);
        while (update_.status == UpdateStatus::done && felt_.punctured < most_punctures &&
               update_.work < input_.proxy.step_budget) {
            const std::optional<double> share = gives_way(from);
            if (!share || !open()) break;
            ++felt_.punctured;
            // From here on, the hand is where it was at that moment.
            from += *share * (input_.hip - from);
            move_to(from);
            move_to(input_.hip);
        }
        if (update_.status == UpdateStatus::recovering) begin();
        if (update_.status == UpdateStatus::done) close();
        return result();
    }

  private:
    /// Forgets what gave way: the SCP is where it is. A hand that starts or recovers inside is
    /// there, but in nothing whose surface never gives way.
    void begin() {
        tissues_.begin(0);
        const Proxy& proxy = tissues_.proxy();
        const Vec3& at = proxy.placed ? proxy.scp_physical : input_.hip;
        int inside = at.allFinite() ? tissues_.inside_at(at) : 0;
        if (!proxy.placed || update_.status == UpdateStatus::recovering) {
            const auto holds = [this](int layer) {
                return !std::isfinite(puncture_force_of(layer));
            };
            const int nested = tissues_.nested();
            if (inside > nested && holds(inside - 1)) inside = tissues_.without_labels_at(at);
            for (int layer = 0; layer < std::min(inside, nested); ++layer) {
                if (holds(layer)) inside = layer;
            }
        }
        tissues_.begin(inside);
        state_.touched = -1;
        state_.spring = {};
        state_.needle = {};
    }
    /// False where the proxy did not take the hand's position: then nothing here changes either.
    bool moved() const {
        return update_.status != UpdateStatus::refused &&
               update_.status != UpdateStatus::not_finite;
    }

    double gradient() {
        const bool asked = std::ranges::any_of(
            layers_.curves, [](const PropertyCurves& c) { return !c.gradient.knots.empty(); });
        const Proxy& proxy = tissues_.proxy();
        return asked && proxy.placed ? gradient_at(density_, proxy.scp_physical).norm() : 0;
    }
    /// Property of a surface, or without layers of the session's level.
    double of_surface(int layer, HapticProperty property, double otherwise) const {
        const bool asks = !layers_[property].density.knots.empty();
        return property_of(layers_, layer, property, asks ? tissues_.density_at_surface(layer) : 0,
                           gradient_, otherwise);
    }
    double puncture_force_of(int layer) const {
        return of_surface(layer, puncture_force, std::numeric_limits<double>::infinity());
    }
    Friction friction_of(int layer) const {
        const Friction& usual = input_.proxy.friction;
        Friction friction;
        friction.static_coefficient = of_surface(layer, static_friction, usual.static_coefficient);
        friction.dynamic_coefficient =
            std::min(friction.static_coefficient,
                     of_surface(layer, dynamic_friction, usual.dynamic_coefficient));
        return friction;
    }
    /// Settings of the force at the touched surface and in the tissue of the SCP.
    ForceSettings force_now() const {
        ForceSettings force = input_.force;
        force.stiffness = of_surface(state_.touched, stiffness, force.stiffness);
        force.damping = of_surface(state_.touched, damping, force.damping);
        const bool asks = !layers_[viscosity].density.knots.empty();
        force.viscosity =
            property_of(layers_, tissues_.inside(update_) - 1, viscosity,
                        asks ? tissues_.density_at_scp(update_) : 0, gradient_, force.viscosity);
        return stable(force, input_.limits);
    }

    ProxySettings bound() {
        const NextLayers next = tissues_.bound();
        ProxySettings settings = input_.proxy;
        settings.friction = friction_of(next.ahead);
        if (next.behind >= 0) settings.behind = friction_of(next.behind);
        return settings;
    }

    /// Target of the tip: on the line of a needle, otherwise the hand.
    Vec3 target_of(const Vec3& hand) const {
        const NeedleState& needle = state_.needle;
        return needle.inserted ? on_line(needle, along_line(needle, hand)) : hand;
    }

    void move_to(const Vec3& hand) {
        gradient_ = gradient();
        ProxySettings settings = bound();
        const ProxyMethod method = state_.needle.inserted ? &update_straight : input_.method;
        // The tick has one budget, however many surfaces give way in it.
        const ProxyUpdate before = update_;
        settings.step_budget -= before.work;
        if (before.work > 0 && settings.step_budget < 1) {
            update_.status = UpdateStatus::out_of_budget;
            update_.hip = target_of(hand);
            return stretch();
        }
        update_ = method(tissues_.proxy(), tissues_.field(), target_of(hand), settings, observer_);
        update_.tetrahedra += before.tetrahedra;
        update_.work += before.work;
        update_.searched = std::max(update_.searched, before.searched);
        if (!moved()) return;
        tissues_.look(update_);
        state_.touched = tissues_.touched(update_);
        if (came_to_channel() && tissues_.open(update_, update_.scp)) return move_to(hand);
        stretch();
    }

    /// The spring, now that SCP and HIP are where they are.
    void stretch() {
        gradient_ = gradient();
        force_ = force_now();
        state_.spring.touching &= pulls(update_);
        if (!pulls(update_)) return;
        distance_ = (update_.scp - update_.hip).norm() * input_.device_per_volume;
        spring_force_ = state_.spring.move(distance_, force_.stiffness);
    }

    /// Friction pulls aside; only what presses counts. In grooves and corners the normal is that of
    /// one of their sides, but nowhere do less than the friction cone's walls press.
    double pressing_part(const Vec3& pull) {
        const double mu = friction_of(state_.touched).static_coefficient;
        return std::max(std::abs(pull.dot(normal())), 1 / std::sqrt(1 + mu * mu));
    }

    /// Whether the surface touched gave way on the hand's last way, and at which part of it.
    std::optional<double> gives_way(const Vec3& from) {
        if (state_.touched < 0 || !(distance_ > 0)) return std::nullopt;
        const double most = puncture_force_of(state_.touched);
        if (!(spring_force_ >= most)) return std::nullopt;
        const Vec3 pull = (update_.scp - update_.hip).normalized();
        const double along = state_.needle.inserted ? 1 : pressing_part(pull);
        if (!(spring_force_ * along >= most)) return std::nullopt;
        const double then =
            state_.spring.rest + (most > 0 ? most / (along * state_.spring.stiffness) : 0);
        const double before = (update_.scp - target_of(from)).dot(pull) * input_.device_per_volume;
        if (!(distance_ > before)) return 0.0;
        return std::clamp((then - before) / (distance_ - before), 0.0, 1.0);
    }
    Vec3 normal() { return normal_at(tissues_.proxy(), tissues_.field()); }

    /// The surface touched gives way. False if it holds, or if there is no room to remember that.
    bool open() {
        NeedleState& needle = state_.needle;
        if (layers_.needle && needle.inserted && !has_room(needle)) return false;
        const int beyond = tissues_.beyond(update_);
        const Vec3 out = layers_.needle ? normal() : Vec3::Zero();
        if (!tissues_.open(update_, update_.scp)) return false;
        if (layers_.needle) {
            if (!needle.inserted) insert_needle(out);
            cross(needle, state_.touched, beyond, update_.scp);
        }
        return true;
    }

    /// `out`: unit normal of the surface.
    void insert_needle(const Vec3& out) {
        const Vec3 pull = (update_.hip - update_.scp).normalized();
        // A tool that points along the surface or out of it gives no direction.
        const bool points = input_.pointing.dot(-out) > 0.2;
        NeedleState& needle = state_.needle;
        needle = {};
        needle.inserted = needle.slipping = true;
        needle.entry = update_.scp;
        needle.axis = points ? input_.pointing : pull;
        needle.hand = along_line(needle, state_.moved ? state_.hip : input_.hip);
        needle.anchor = along_line(needle, input_.hip);
        // The needle takes over its share of the energy in the surface's spring, and no more.
        const double part = aside_of(input_.hip).norm() / distance_;
        needle.aside = {true, state_.spring.stiffness, part * state_.spring.rest};
    }
    /// From the hand to the needle's line [device mm].
    Vec3 aside_of(const Vec3& hand) const {
        return (target_of(hand) - hand) * input_.device_per_volume;
    }
    bool came_to_channel() const {
        return state_.needle.inserted && state_.touched >= 0 &&
               is_in_channel(state_.needle, state_.touched, update_.scp, layers_.closing);
    }

    /// Surfaces that gave way close when the SCP has left their openings.
    void close() {
        NeedleState& needle = state_.needle;
        if (needle.inserted) withdraw(needle, update_.scp, layers_.closing);
        tissues_.close(update_, layers_.closing);
        if (needle.inserted && !tissues_.is_open()) {
            count_surfaces(needle, tissues_.inside(update_), tissues_.nested(), update_.scp);
        }
    }

    LayersUpdate result() {
        update_.hip = input_.hip;
        LayersUpdate r;
        r.proxy = update_;
        felt_.touched = static_cast<std::int8_t>(state_.touched);
        felt_.inside = static_cast<std::int8_t>(tissues_.inside(update_));
        r.felt = felt_;
        if (!moved()) return r;
        r.force = force_;
        const bool pulled = pulls(update_), needle = state_.needle.inserted;
        Vec3 force = Vec3::Zero();
        if (pulled && distance_ > 0) {
            const Vec3 pull = (update_.scp - target_of(input_.hip)) * input_.device_per_volume;
            force = pull * (spring_force_ / distance_);
        }
        if (needle) {
            r.force.stiffness = std::max(
                {r.force.stiffness, layers_.needle->lateral_stiffness, input_.force.stiffness});
        }
        const double stiffness = r.force.stiffness;
        if (needle) {
            r.force = stable(r.force, input_.limits);
            // The limit holds before unstable settings are lowered.
            const double limit = std::min(input_.force.limit, input_.limits.maximum_force);
            force = needle_force(force, limit * stiffness / r.force.stiffness);
        }
        r.pulls = pulled || needle;
        if (stiffness > 0) r.pull = force / stiffness;
        state_.moved = true;
        state_.hip = input_.hip;
        state_.time = input_.time;
        return r;
    }

    /// Along the line what surface and shaft give, and towards it, no more than a limit [N]: both
    /// springs give way together, and friction before them. `contact`: the surface's force.
    Vec3 needle_force(Vec3 contact, double limit) {
        NeedleState& needle = state_.needle;
        Vec3 aside = aside_of(input_.hip);
        const double length = aside.norm();
        const double lateral = needle.aside.move(length, layers_.needle->lateral_stiffness);
        aside *= length > 0 ? lateral / length : 0;
        const auto parts = parts_within(limit, {contact.norm(), state_.spring.stiffness},
                                        {lateral, needle.aside.stiffness});
        contact *= parts[0];
        aside *= parts[1];
        const double along = needle.axis.dot(contact);
        const double room = std::max(std::sqrt(std::max(0.0, limit * limit - aside.squaredNorm())),
                                     std::abs(along));
        const double friction =
            shaft_friction(needle, layers_, input_, update_.scp, input_.time - state_.time,
                           -room - along, room - along);
        Vec3 force = contact + (aside + friction * needle.axis);
        // By rounding it may be below the limit, which the force stage would not report.
        if (force.norm() >= (1 - 1e-12) * limit) force *= 1 + 1e-9;
        return force;
    }

    const Layers& layers_;
    LayerState& state_;
    const Field& density_;
    Tissues tissues_;
    const LayerInput& input_;
    const StepObserver observer_;
    ProxyUpdate update_;
    LayersFelt felt_;
    ForceSettings force_;      // after the last move
    double gradient_ = 0;      // magnitude at the SCP [data units / mm]
    double distance_ = 0;      // of SCP and HIP [device mm]
    double spring_force_ = 0;  // [N]
};

}  // namespace

LayersUpdate update_layers(const std::shared_ptr<const Layers>& layers, LayerState& state,
                           Proxy& proxy, const Field& field, const LayerInput& input,
                           StepObserver observer) {
    return LayersTick(layers, state, proxy, field, input, observer).run();
}

}  // namespace palpate
