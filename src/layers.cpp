// Layers: curves, properties and their check. See docs/layers.md.
#include "palpate/layers.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "layers/cover.hpp"

namespace palpate {
namespace {

constexpr std::array<const char*, haptic_property_count> property_names{
    "stiffness", "static friction", "dynamic friction", "damping", "viscosity", "puncture force",
    "drag"};

[[noreturn]] void refuse(const std::string& what) {
    throw std::invalid_argument(what);
}

/// A puncture force may be infinite: the surface never gives way.
void check_value(const std::string& where, int property, double value) {
    const bool may_be_infinite = property == static_cast<int>(HapticProperty::puncture_force);
    if (value >= 0 && (may_be_infinite || std::isfinite(value))) return;
    refuse(where + ": " + property_names[property] + " must be at least 0" +
           (may_be_infinite ? "" : " and finite"));
}

void check_curve(const char* over, int property, const Curve& curve) {
    const std::string where = std::string("the curve over ") + over;
    for (std::size_t i = 0; i < curve.knots.size(); ++i) {
        check_value(where, property, curve.knots[i].value);
        if (!std::isfinite(curve.knots[i].at) ||
            (i > 0 && !(curve.knots[i - 1].at < curve.knots[i].at))) {
            refuse(where + " of " + property_names[property] +
                   ": its knots must be finite and rise");
        }
    }
}

void check_layer(const Layers& all, std::size_t number, double sign) {
    const Layer& layer = all.layers[number];
    if (layer.name.empty()) refuse("layer " + std::to_string(number + 1) + " has no name");
    const std::string where = "layer \"" + layer.name + '"';
    if (!std::isfinite(layer.level)) refuse(where + ": its level must be finite");
    for (std::size_t i = 0; i < number; ++i) {
        if (all.layers[i].name == layer.name) refuse(where + " is there twice");
    }
    if (is_label(all, number)) {
        if (!(layer.level >= 1 && layer.level <= 65535 && layer.level == std::floor(layer.level))) {
            refuse(where + ": its label must be a whole number from 1 to 65535");
        }
        for (std::size_t i = level_count(all); i < number; ++i) {
            if (all.layers[i].level == layer.level) refuse(where + ": its label is another's, too");
        }
    } else if (number > 0 && !(sign * all.layers[number - 1].level < sign * layer.level)) {
        refuse(where + ": levels must " + (sign > 0 ? "rise" : "fall") +
               " from layer to layer, from outside in");
    }
    for (int p = 0; p < haptic_property_count; ++p) {
        if (layer.own[p]) check_value(where, p, *layer.own[p]);
    }
    const auto in_unit = [](double v) { return v >= 0 && v <= 1; };
    if (!std::ranges::all_of(layer.colour, in_unit) || !in_unit(layer.opacity)) {
        refuse(where + ": colour and opacity must be from 0 to 1");
    }
}

}  // namespace

double Curve::operator()(double at) const noexcept {
    if (!(at > knots.front().at)) return knots.front().value;
    for (std::size_t i = 1; i < knots.size(); ++i) {
        const Knot &a = knots[i - 1], &b = knots[i];
        if (at >= b.at) continue;
        // From or to infinity there is no slope.
        if (a.value == b.value || !std::isfinite(a.value)) return a.value;
        if (!std::isfinite(b.value)) return at > a.at ? b.value : a.value;
        return a.value + (b.value - a.value) * ((at - a.at) / (b.at - a.at));
    }
    return knots.back().value;
}

void check(const Layers& layers, Solid solid) {
    if (layers.layers.size() > Layers::most_layers) refuse("more than 16 layers");
    for (int p = 0; p < haptic_property_count; ++p) {
        check_curve("density", p, layers.curves[p].density);
        check_curve("gradient", p, layers.curves[p].gradient);
    }
    if (layers.by_label && layers.levels_beside_labels > layers.layers.size()) {
        refuse("more levels than layers");
    }
    const double sign = solid == Solid::above ? 1 : -1;
    for (std::size_t i = 0; i < layers.layers.size(); ++i) check_layer(layers, i, sign);
    if (!(layers.closing > 0) || !std::isfinite(layers.closing)) {
        refuse("the distance at which surfaces close must be finite and above 0 mm");
    }
    if (layers.needle) check_ranges(*layers.needle);
}

std::shared_ptr<const Field> numbered_labels(const Volume& labels, std::span<const Layer> layers,
                                             std::size_t first) {
    if (layers.size() > Layers::most_layers) refuse("more than 16 layers");
    std::vector<std::uint8_t> numbers(static_cast<std::size_t>(sample_count(labels.geometry())));
    with_type(labels.type(), [&](auto zero) {
        const auto* samples = static_cast<const decltype(zero)*>(labels.data());
        for (std::size_t i = 0; i < numbers.size(); ++i) {
            for (std::size_t k = first; k < layers.size(); ++k) {
                if (double(samples[i]) == layers[k].level) {
                    numbers[i] = static_cast<std::uint8_t>(k + 1);
                }
            }
        }
    });
    return std::make_shared<const Field>(Volume(labels.geometry(), std::move(numbers)),
                                         Solid::above, 0.0);
}

Field labelled_space(const Layers& layers) {
    Field space = *layers.labels;
    LabelCover::put(space, layers.labels, ~1U, 0, 1);
    return space;
}

double property_of(const Layers& layers, int layer, HapticProperty property, double density,
                   double gradient, double otherwise) noexcept {
    const PropertyCurves& curves = layers[property];
    double value = otherwise;
    if (!curves.density.knots.empty()) value = curves.density(density);
    if (layer >= 0 && layers.layers[layer][property]) value = *layers.layers[layer][property];
    // Infinity stays what it is, also where the factor is 0.
    if (curves.gradient.knots.empty() || !std::isfinite(value)) return value;
    return value * curves.gradient(gradient);
}

double ContactSpring::move(double distance, double to_stiffness) noexcept {
    if (!touching) *this = {true, to_stiffness, 0};
    // A spring that hangs slack is as long as the hand lets it.
    rest = std::min(rest, distance);
    if (to_stiffness != stiffness) {
        const double stretch = distance - rest;
        const double twice_energy = stiffness * stretch * stretch;
        const double force =
            std::min(to_stiffness * distance, std::sqrt(to_stiffness * twice_energy));
        stiffness = to_stiffness;
        rest = to_stiffness > 0 ? std::max(0.0, distance - force / to_stiffness) : distance;
    }
    return stiffness * (distance - rest);
}

}  // namespace palpate
