// A tick of layers: which surfaces hold the proxy, what they feel like, which of them give way and
// close again.
#include <algorithm>
#include <cmath>
#include <limits>

#include "layers/needle.hpp"
#include "palpate/density.hpp"

namespace palpate {
namespace {

/// Surfaces that may give way in one tick.
constexpr int most_punctures = 8;
/// Closer to a level than this [range], the SCP counts as outside of it.
constexpr double at_level = 1e-9;

using enum HapticProperty;

class LayersTick {
  public:
    LayersTick(const Layers& layers, LayerState& state, Proxy& proxy, const Field& field,
               const LayerInput& input, StepObserver observer)
        : layers_(layers),
          count_(static_cast<int>(layers.layers.size())),
          state_(state),
          proxy_(proxy),
          field_(field),
          input_(input),
          observer_(observer) {}

    LayersUpdate run() {
        if (state_.layer_count != count_) begin();
        if (state_.needle.inserted && !layers_.needle) state_.needle = {};
        Vec3 from = state_.moved ? state_.hip : input_.hip;
        move_to(input_.hip);
        while (update_.status == UpdateStatus::done && felt_.punctured < most_punctures &&
               update_.tetrahedra < input_.proxy.step_budget) {
            const std::optional<double> share = gives_way(from);
            if (!share || !open()) break;
            ++felt_.punctured;
            // What comes next is met from where the hand was at that moment.
            from += *share * (input_.hip - from);
            move_to(from);
            move_to(input_.hip);
        }
        if (update_.status == UpdateStatus::recovering) begin();
        if (update_.status == UpdateStatus::done) close();
        return result();
    }

  private:
    double level(int layer) const { return layers_.layers[layer].level; }
    /// How many layers a density lies inside of.
    int inside_at(double density) const {
        int inside = 0;
        while (inside < count_ &&
               field_.sign() * (density - level(inside)) > at_level * field_.range()) {
            ++inside;
        }
        return inside;
    }
    /// Forgets what gave way: the SCP is where it is.
    void begin() {
        state_.layer_count = count_;
        state_.inner = proxy_.placed ? inside_at(value_at(field_, scp_of(proxy_))) : 0;
        state_.outer = state_.inner;
        state_.spring = {};
        state_.needle = {};
        if (count_ == 0) proxy_.behind.reset();
    }
    static const Vec3& scp_of(const Proxy& proxy) { return proxy.scp_physical; }
    /// False where the proxy did not take the hand's position: then nothing here changes either.
    bool moved() const {
        return update_.status != UpdateStatus::refused &&
               update_.status != UpdateStatus::not_finite;
    }

    double gradient() const {
        const bool asked = std::ranges::any_of(
            layers_.curves, [](const PropertyCurves& c) { return !c.gradient.knots.empty(); });
        return asked && proxy_.placed ? gradient_at(field_, scp_of(proxy_)).norm() : 0;
    }
    /// Of a surface; without layers, of the level that the session feels.
    double of_surface(int layer, HapticProperty property, double otherwise) const {
        const double density = layer >= 0 ? level(layer) : proxy_.isovalue;
        return property_of(layers_, layer, property, density, gradient_, otherwise);
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
    /// What the hand feels of a surface and of what the SCP is in.
    ForceSettings force_of(int layer) const {
        ForceSettings force = input_.force;
        force.stiffness = of_surface(layer, stiffness, force.stiffness);
        force.damping = of_surface(layer, damping, force.damping);
        force.viscosity = property_of(layers_, inside() - 1, viscosity, update_.density, gradient_,
                                      force.viscosity);
        return stable(force, input_.limits);
    }

    /// The surface that is touched; -1: none, or one that is not of a layer.
    int touched() const {
        if (update_.mode != Mode::constrained || count_ == 0) return -1;
        if (update_.behind) return state_.outer - 1;
        return state_.inner < count_ ? state_.inner : -1;
    }
    int inside() const {
        if (update_.mode == Mode::constrained) return update_.behind ? state_.outer : state_.inner;
        return std::clamp(inside_at(update_.density), state_.outer, state_.inner);
    }

    ProxySettings put_levels() {
        ProxySettings settings = input_.proxy;
        if (count_ == 0) {
            settings.friction = friction_of(-1);
            return settings;
        }
        const double beyond = field_.sign() * std::numeric_limits<double>::infinity();
        proxy_.isovalue = state_.inner < count_ ? level(state_.inner) : beyond;
        proxy_.behind.reset();
        if (state_.inner < count_) settings.friction = friction_of(state_.inner);
        if (state_.outer > 0) {
            proxy_.behind = level(state_.outer - 1);
            settings.behind = friction_of(state_.outer - 1);
        }
        return settings;
    }

    /// Where the tip heads for: on the line of a needle, else the hand.
    Vec3 target_of(const Vec3& hand) const {
        const NeedleState& needle = state_.needle;
        return needle.inserted ? on_line(needle, along_line(needle, hand)) : hand;
    }

    void move_to(const Vec3& hand) {
        gradient_ = gradient();
        ProxySettings settings = put_levels();
        const ProxyMethod method = state_.needle.inserted ? &update_straight : input_.method;
        // The tick has one budget, however many surfaces give way in it.
        const int before = update_.tetrahedra;
        settings.step_budget = std::max(1, settings.step_budget - before);
        update_ = method(proxy_, field_, target_of(hand), settings, observer_);
        update_.tetrahedra += before;
        if (!moved()) return;
        if (state_.needle.inserted && touched() >= 0 && came_to_channel()) {
            state_.opening[touched()] = update_.scp;
            open_surface(update_.behind);
            return move_to(hand);
        }
        state_.spring.touching &= update_.mode == Mode::constrained;
        if (update_.mode != Mode::constrained) return;
        force_ = force_of(touched());
        distance_ = (update_.scp - update_.hip).norm() * input_.device_per_volume;
        spring_force_ = state_.spring.move(distance_, force_.stiffness);
        state_.spring.touching = true;
    }

    /// Friction pulls aside; only what presses counts. In grooves and corners the normal is that of
    /// one of their sides, but nowhere do less than the friction cone's walls press.
    double pressing_part(int layer, const Vec3& pull) const {
        const double mu = friction_of(layer).static_coefficient;
        return std::max(std::abs(pull.dot(normal_at(proxy_, field_))), 1 / std::sqrt(1 + mu * mu));
    }

    /// Whether the surface touched gave way on the hand's last way, and at which part of it.
    std::optional<double> gives_way(const Vec3& from) const {
        const int layer = touched();
        if (layer < 0 || !(distance_ > 0)) return std::nullopt;
        const double most =
            of_surface(layer, puncture_force, std::numeric_limits<double>::infinity());
        if (!(spring_force_ >= most)) return std::nullopt;
        const Vec3 pull = (update_.scp - update_.hip).normalized();
        const double along = state_.needle.inserted ? 1 : pressing_part(layer, pull);
        if (!(spring_force_ * along >= most)) return std::nullopt;
        const double then =
            state_.spring.rest + (most > 0 ? most / (along * state_.spring.stiffness) : 0);
        const double before = (update_.scp - target_of(from)).dot(pull) * input_.device_per_volume;
        if (!(distance_ > before)) return 0.0;
        return std::clamp((then - before) / (distance_ - before), 0.0, 1.0);
    }

    /// The surface touched gives way. False if there is no room to remember that.
    bool open() {
        const int layer = touched();
        NeedleState& needle = state_.needle;
        if (layers_.needle) {
            if (!needle.inserted) insert_needle();
            if (!cross(needle, layer, !update_.behind, update_.scp)) return false;
        }
        state_.opening[layer] = update_.scp;
        open_surface(update_.behind);
        return true;
    }
    void open_surface(bool behind) { behind ? --state_.outer : ++state_.inner; }

    void insert_needle() {
        const Vec3 pull = (update_.hip - update_.scp).normalized();
        const Vec3 into = -normal_at(proxy_, field_);
        // A tool that points along the surface or out of it says nothing.
        const bool points = input_.pointing.dot(into) > 0.2;
        insert(state_.needle, update_.scp, points ? input_.pointing : pull);
        NeedleState& needle = state_.needle;
        needle.hand = along_line(needle, state_.moved ? state_.hip : input_.hip);
        needle.anchor = along_line(needle, input_.hip);
        // Of what the surface's spring has stored this takes on its part, and no more.
        const double part = aside_of(input_.hip).norm() / distance_;
        needle.aside = {true, state_.spring.stiffness, part * state_.spring.rest};
    }
    /// From the hand to the needle's line [device mm].
    Vec3 aside_of(const Vec3& hand) const {
        return (target_of(hand) - hand) * input_.device_per_volume;
    }
    bool came_to_channel() const {
        return is_in_channel(state_.needle, touched(), update_.scp, layers_.closing);
    }

    /// Surfaces that gave way close when the SCP has left their openings.
    void close() {
        if (state_.needle.inserted) {
            withdraw(state_.needle, update_.scp, layers_.closing);
        }
        for (int layer = state_.inner - 1; layer >= state_.outer; --layer) {
            if ((update_.scp - state_.opening[layer]).norm() <= layers_.closing) continue;
            if (inside() > layer) {
                state_.outer = layer + 1;
                break;
            }
            state_.inner = layer;
        }
        const bool is_open = state_.outer < state_.inner;
        if (state_.needle.inserted && !is_open) {
            count_surfaces(state_.needle, inside(), update_.scp);
        }
    }

    LayersUpdate result() {
        update_.hip = input_.hip;
        LayersUpdate r;
        r.proxy = update_;
        felt_.touched = static_cast<std::int8_t>(touched());
        felt_.inside = static_cast<std::int8_t>(inside());
        r.felt = felt_;
        if (!moved()) return r;
        const bool touching = update_.mode == Mode::constrained;
        r.force = force_of(touched());
        Vec3 force = Vec3::Zero();
        if (touching && distance_ > 0) {
            const Vec3 pull = (update_.scp - target_of(input_.hip)) * input_.device_per_volume;
            force = pull * (spring_force_ / distance_);
        }
        if (state_.needle.inserted) {
            force += needle_force();
            r.force.stiffness = std::max(
                {r.force.stiffness, layers_.needle->lateral_stiffness, input_.force.stiffness});
        }
        r.pulls = touching || state_.needle.inserted;
        if (r.force.stiffness > 0) r.pull = force / r.force.stiffness;
        if (state_.needle.inserted) r.force = stable(r.force, input_.limits);
        state_.moved = true;
        state_.hip = input_.hip;
        state_.time = input_.time;
        return r;
    }

    /// Towards the line, and along it what the shaft feels.
    Vec3 needle_force() {
        NeedleState& needle = state_.needle;
        const Vec3 aside = aside_of(input_.hip);
        const double length = aside.norm();
        const double force = needle.aside.move(length, layers_.needle->lateral_stiffness);
        const double period = input_.time - state_.time;
        const double along = shaft_friction(needle, layers_, input_, update_.scp, period);
        return (length > 0 ? force / length : 0) * aside + along * needle.axis;
    }

    const Layers& layers_;
    const int count_;
    LayerState& state_;
    Proxy& proxy_;
    const Field& field_;
    const LayerInput& input_;
    const StepObserver observer_;
    ProxyUpdate update_;
    LayersFelt felt_;
    ForceSettings force_;
    double gradient_ = 0;      // magnitude at the SCP [data units / mm]
    double distance_ = 0;      // of SCP and HIP [device mm]
    double spring_force_ = 0;  // [N]
};

}  // namespace

LayersUpdate update_layers(const Layers& layers, LayerState& state, Proxy& proxy,
                           const Field& field, const LayerInput& input, StepObserver observer) {
    return LayersTick(layers, state, proxy, field, input, observer).run();
}

}  // namespace palpate
