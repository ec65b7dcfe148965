// Bodies whose density is their depth, layers in them, and the closed form of what a hand feels
// that goes straight in.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "palpate/renderer.hpp"
#include "scenes/random.hpp"

namespace palpate::evaluation {

inline constexpr double layers_rate = 1000;       ///< [Hz] of every hand here
inline constexpr double most_force_error = 0.01;  ///< [N] RMS, claimed against closed forms
inline constexpr double curve_resolution = 0.1;   ///< [mm] of the curves that are written

/// A straight way of the hand into a body.
struct HandLine {
    Vec3 origin = Vec3::Zero();  ///< [mm, physical] at depth 0
    Vec3 inward = Vec3::Zero();  ///< unit

    Vec3 at(double depth) const { return origin + depth * inward; }
};

/// Its density at depth d [mm] is d.
struct LayeredPhantom {
    std::string name;
    Field field;
    /// A random line straight in, across the layers.
    std::function<HandLine(scenes::Random&)> line;
};

/// Flat layers: density z on 9 x 9 x 101 samples, 1 mm apart, so that both fields are exact.
LayeredPhantom ramp_phantom();
inline constexpr double ball_radius = 80;  ///< [mm]
/// Concentric balls round (0, 0, 0): density ball_radius - r in float32, 0.125 mm apart, in a block
/// in which lines towards the centre are up to 4 degrees off the grid's axis.
LayeredPhantom ball_phantom();
/// How deep a hand may go in either [mm].
inline constexpr double phantom_depth = 64;

/// Skin, fat, fascia, muscle and bone; all but the bone give way.
Layers five_tissues();
/// The same for a needle, each with its drag.
Layers needle_tissues();
/// Only the first layer.
Layers outermost_of(const Layers& layers);

double stiffness_of(const Layer& layer);       ///< [N/mm]
double puncture_force_of(const Layer& layer);  ///< [N]

/// The spring's force [N] on a hand that went straight in to this depth [mm]: each surface holds
/// until its puncture force.
double spring_at(const Layers& layers, double depth);
/// What rubs on a needle's shaft in motion [N]: drag times length in each layer.
double drag_at(const Layers& layers, double depth);

/// A renderer without damping, ramp and limits, so that the force is what the layers make it. A
/// millimetre of hand is one of the body. `physical_damping` [N s/mm] of the device.
Renderer layered_renderer(const Field& field, std::shared_ptr<const Layers> layers,
                          double physical_damping = 1);

}  // namespace palpate::evaluation
