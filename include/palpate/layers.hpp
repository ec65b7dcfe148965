// Stage 9, layers: several surfaces in one stroke, each with its own feel. A haptic transfer
// function gives stiffness, friction and so on by density. Surfaces are levels of the density, from
// outside in, and give way when they are pressed hard enough. (Corenthy et al. 2012, section 7,
// propose such penetrability for an application as future work.) Model, energy and limits:
// docs/layers.md.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "palpate/force.hpp"
#include "palpate/names.hpp"
#include "palpate/proxy.hpp"

namespace palpate {

/// The properties that a haptic transfer function gives.
enum class HapticProperty : std::uint8_t {
    stiffness,         ///< [N/mm] of a surface
    static_friction,   ///< coefficient of a surface
    dynamic_friction,  ///< the same, counts as at most the static one
    damping,           ///< [N s/mm] of a surface
    viscosity,         ///< [N s/mm] inside, behind the surface
    puncture_force,    ///< [N] at which a surface gives way; infinity: never
    drag,  ///< [N/mm] friction on a needle's shaft per mm (physical) of its length inside
};
inline constexpr int haptic_property_count = 7;

/// A piecewise linear function: knots in rising order, constant beyond both ends. Without knots it
/// has no value.
struct Curve {
    struct Knot {
        double at, value;
    };
    std::vector<Knot> knots;

    /// Not for a curve without knots.
    double operator()(double at) const noexcept;
};

/// A property at a point: a value over the density there [data units], and a factor over the
/// magnitude of the gradient there [data units / mm].
struct PropertyCurves {
    Curve density, gradient;
};

/// A surface and the tissue behind it.
struct Layer {
    std::string name;
    double level = 0;  ///< isovalue [data units]; by label, the label's number
    /// For pictures: red, green and blue, 0 to 1.
    std::array<double, 3> colour{0.8, 0.8, 0.8};
    double opacity = 1;
    /// Values given here replace the curve over density.
    std::array<std::optional<double>, haptic_property_count> own{};

    std::optional<double>& operator[](HapticProperty p) { return own[static_cast<int>(p)]; }
    const std::optional<double>& operator[](HapticProperty p) const {
        return own[static_cast<int>(p)];
    }
};

/// A hand that holds a needle: after the first puncture it moves along a line.
struct Needle {
    double lateral_stiffness = 0.3;  ///< [N/mm] of the spring towards the line
    double static_ratio = 1.2;       ///< friction along the shaft at rest, of that in motion
    /// [mm/s] Slower than this along the line, the shaft sticks (Karnopp 1985).
    double stick_speed = 1;
};
template <>
inline constexpr auto settings_of<Needle> = std::tuple{
    setting(&Needle::lateral_stiffness, "lateral_stiffness", "N/mm",
            "Stiffness of the pull to the needle's line")
        .titled("lateral stiffness of the needle")
        .within(ranges::not_negative),
    setting(&Needle::static_ratio, "static_ratio", "",
            "Friction at rest, as a multiple of that in motion")
        .titled("static ratio of the needle")
        .within(ranges::at_least_1),
    setting(&Needle::stick_speed, "stick_speed", "mm/s", "Speed below which the shaft sticks")
        .titled("stick speed of the needle")
        .within(ranges::limit_or_zero)};

/// A haptic transfer function. Properties that neither a layer nor a curve gives are those of the
/// session's settings. Without a puncture force, surfaces never give way.
struct Layers {
    static constexpr int most_layers = 16;

    std::string name;
    std::array<PropertyCurves, haptic_property_count> curves;
    /// In the order in which a hand from outside meets them: levels rise, or fall where the solid
    /// is below. If empty, the surface is that of the session's isovalue, with the properties that
    /// the curves give there.
    std::vector<Layer> layers;
    /// [mm, physical] A surface that gave way closes when the SCP is farther than this from the
    /// place where it gave way. Then it can be touched from its other side.
    double closing = 1;
    std::optional<Needle> needle;
    /// True: the tissue depends on the position. A layer is where the label volume has its number,
    /// whatever the density. A surface between two layers has the properties of the later one.
    /// Curves still use the densities.
    bool by_label = false;
    /// With by_label: this many of the layers, the first ones, are levels of the density
    /// nevertheless. They apply where the label volume has none of the labels.
    std::size_t levels_beside_labels = 0;
    std::shared_ptr<const Field> labels;  ///< from numbered_labels()
    std::string label_volume;             ///< name of their source, for recordings

    const PropertyCurves& operator[](HapticProperty p) const { return curves[static_cast<int>(p)]; }
    PropertyCurves& operator[](HapticProperty p) { return curves[static_cast<int>(p)]; }
};

/// Whether a layer's level is a label.
inline bool is_label(const Layers& layers, std::size_t layer) {
    return layers.by_label && layer >= layers.levels_beside_labels;
}
/// How many layers are levels of the density; they come first.
inline std::size_t level_count(const Layers& layers) {
    return layers.by_label ? layers.levels_beside_labels : layers.layers.size();
}

/// A label volume for layers, from `first` on: samples are k + 1 where this volume has the label
/// layers[k].level, else 0. Throws std::invalid_argument for more than 16 layers.
std::shared_ptr<const Field> numbered_labels(const Volume& labels, std::span<const Layer> layers,
                                             std::size_t first = 0);

/// The field that is 1 in all labels of these layers and 0 elsewhere, to show them. It needs
/// labels.
Field labelled_space(const Layers& layers);

/// Throws std::invalid_argument, naming layer or curve, for more than 16 layers, and for levels out
/// of order or not finite (labels: not whole, below 1 or given twice). The same holds for names
/// missing or given twice, knots out of order, and values that are NaN, negative or (except for
/// puncture forces) infinite.
void check(const Layers& layers, Solid solid);

/// A property in a layer (by number from 0; -1: outside of all), at a density [data units] and
/// gradient magnitude [data units / mm]; `otherwise` if it is not given.
double property_of(const Layers& layers, int layer, HapticProperty property, double density,
                   double gradient, double otherwise) noexcept;

/// The layers in a tick.
struct LayersFelt {
    std::int8_t touched = -1;  ///< layer whose surface is touched; -1: none
    /// The SCP is inside this many layers, 0 .. inside - 1. If layer inside - 1 is a label, the SCP
    /// is in that one only.
    std::int8_t inside = 0;
    std::int8_t punctured = 0;  ///< surfaces that gave way in this tick
};

/// The contact's spring. If its stiffness changes, along a surface or from one surface to the next,
/// it gets a rest length [device mm], so it never gains energy.
struct ContactSpring {
    bool touching = false;
    double stiffness = 0;
    double rest = 0;

    /// The force [N] at this distance between SCP and HIP [device mm].
    double move(double distance, double to_stiffness) noexcept;
};

/// A point at which a needle's shaft crosses a surface: `at` [mm, physical] along the line.
struct Crossing {
    double at = 0;
    std::int8_t surface = 0;
    std::int8_t layer = -1;  ///< beyond it; -1: none
};
struct NeedleState {
    static constexpr int most_crossings = 64;

    bool inserted = false;
    Vec3 entry = Vec3::Zero();  ///< [mm, physical]
    Vec3 axis = Vec3::Zero();   ///< unit, physical axes, into the tissue
    double hand = 0;            ///< [mm, physical] along the line
    double anchor = 0;          ///< where friction holds the shaft [mm, physical]
    ContactSpring aside;        ///< between hand and line
    bool slipping = false;
    int crossing_count = 0;
    std::array<Crossing, most_crossings> crossings{};
};

/// Everything that layers keep between two ticks.
struct LayerState {
    /// The set to which this state belongs, held so that no other one can be taken for it; null:
    /// none yet.
    std::shared_ptr<const Layers> set;
    int layer_count = -1, level_count = -1;  ///< of that set
    /// Which labels (bit k + 1 for layer k; bit 0: none of them) the SCP may be in.
    std::uint32_t open = 1;
    /// By labels: the field that the proxy touches instead of the data's. With levels, it is the
    /// data's field with the labels in it. Without levels, it is that of the labels, on their own
    /// lattice: 1 where the SCP may not be, 0 elsewhere, with its surface at 0.5.
    std::optional<Field> covered;
    Vec3 label_opening = Vec3::Zero();  ///< where a label gave way last [mm, physical]
    /// The SCP may be anywhere from inside `outer` layers to inside `inner` ones: the surfaces
    /// between them gave way, at `opening` [mm, physical], and have not closed yet.
    int outer = 0, inner = 0;
    std::array<Vec3, Layers::most_layers> opening{};
    int touched = -1;  ///< the layer whose surface was touched last; -1: none
    ContactSpring spring;
    NeedleState needle;
    bool moved = false;       ///< there was a tick
    double time = 0;          ///< [s] of the last tick
    Vec3 hip = Vec3::Zero();  ///< of the last tick [mm, physical]
};

/// Keeps a state for another set if that set has the same surfaces: the same number of layers, the
/// same number of levels among them, and the same labels. Everything else may differ. False if the
/// surfaces are not the same.
bool keep_for(LayerState& state, const std::shared_ptr<const Layers>& after) noexcept;
/// Resets the state: the proxy stays where it is, on the lattice of the data.
void forget_layers(LayerState& state, Proxy& proxy, const Field& data) noexcept;

/// Whether layers, if any, have surfaces of their own.
inline bool have_surfaces(const std::shared_ptr<const Layers>& layers) {
    return layers && !layers->layers.empty();
}

/// Input to layers in one tick.
struct LayerInput {
    ProxyMethod method = &update_exact;  ///< one that supports Proxy::behind
    Vec3 hip = Vec3::Zero();             ///< [mm, physical]
    ProxySettings proxy;
    ForceSettings force;
    DeviceLimits limits;
    double device_per_volume = 1;  ///< device mm per mm of physical space
    double time = 0;               ///< [s]
    Vec3 pointing = Vec3::Zero();  ///< unit, physical axes, to the tool's tip; zero: not known
};
struct LayersUpdate {
    ProxyUpdate proxy;
    ForceSettings force;       ///< of the touched surface and of the tissue at the SCP, stable
    bool pulls = false;        ///< there is a spring's force on the hand
    Vec3 pull = Vec3::Zero();  ///< that force / force.stiffness [device mm], physical axes
    LayersFelt felt;
};

/// One tick: moves the proxy, instead of a ProxyMethod and penetrability. The proxy never passes a
/// surface that did not give way, from either side (G1, G2 for all of them; docs/layers.md). A
/// surface gives way at the point on the hand's path where its spring reaches the puncture force.
/// The SCP then continues towards the hand in the same tick, through at most eight surfaces. A
/// state of another set is reset at the proxy's position.
LayersUpdate update_layers(const std::shared_ptr<const Layers>& layers, LayerState& state,
                           Proxy& proxy, const Field& field, const LayerInput& input,
                           StepObserver observer = {});

}  // namespace palpate
