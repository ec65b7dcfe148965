// Flat layers and balls, the tissues in them, and closed forms.
#include "evaluation/layers/phantom.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace palpate::evaluation {
namespace {

constexpr double never = std::numeric_limits<double>::infinity();

struct Tissue {
    const char* name;
    double level, stiffness, puncture_force, drag;  // [mm], [N/mm], [N], [N/mm]
};
// Levels are no multiples of a tick's way, and surfaces lie apart at different distances.
constexpr std::array<Tissue, 5> tissues{{{"skin", 10, 0.4, 1.2, 0.03},
                                         {"fat", 16, 0.2, 0.7, 0.01},
                                         {"fascia", 30, 0.9, 2.0, 0.05},
                                         {"muscle", 33.5, 0.5, 1.0713, 0.03},
                                         {"bone", 60, 1.5, never, 0}}};

template <class Density>
Volume sampled(const Geometry& geometry, Density&& density) {
    std::vector<float> samples;
    samples.reserve(static_cast<std::size_t>(sample_count(geometry)));
    for (int z = 0; z < geometry.size[2]; ++z) {
        for (int y = 0; y < geometry.size[1]; ++y) {
            for (int x = 0; x < geometry.size[0]; ++x) {
                samples.push_back(
                    static_cast<float>(density(physical_from_index(geometry, Vec3(x, y, z)))));
            }
        }
    }
    return {geometry, std::move(samples)};
}

}  // namespace

LayeredPhantom ramp_phantom() {
    const Geometry geometry{.size = {9, 9, 101}};
    return {"flat", Field(sampled(geometry, [](const Vec3& p) { return p[2]; })),
            [](scenes::Random& random) {
                return HandLine{{random.uniform(3, 5), random.uniform(3, 5), 0}, {0, 0, 1}};
            }};
}

LayeredPhantom ball_phantom() {
    constexpr double spacing = 0.125, widest = 4 * std::numbers::pi / 180;
    // Upright, from above the outermost surface to below the innermost one; the centre is (0, 0,
    // 0).
    const Geometry geometry{
        .size = {96, 96, 576}, .spacing = Vec3::Constant(spacing), .origin = {-5.9, -5.9, 8}};
    const auto line = [](scenes::Random& random) {
        const double tilt = widest * std::sqrt(random.uniform());
        const double turn = 2 * std::numbers::pi * random.uniform();
        const Vec3 outward(std::sin(tilt) * std::cos(turn), std::sin(tilt) * std::sin(turn),
                           std::cos(tilt));
        return HandLine{ball_radius * outward, -outward};
    };
    return {"balls", Field(sampled(geometry, [](const Vec3& p) { return ball_radius - p.norm(); })),
            line};
}

Layers five_tissues() {
    Layers layers;
    layers.name = "five tissues";
    for (const Tissue& tissue : tissues) {
        Layer layer;
        layer.name = tissue.name;
        layer.level = tissue.level;
        layer[HapticProperty::stiffness] = tissue.stiffness;
        layer[HapticProperty::puncture_force] = tissue.puncture_force;
        layers.layers.push_back(layer);
    }
    return layers;
}

Layers needle_tissues() {
    Layers layers = five_tissues();
    layers.needle = Needle{};
    for (std::size_t i = 0; i < tissues.size(); ++i) {
        layers.layers[i][HapticProperty::drag] = tissues[i].drag;
    }
    return layers;
}

Layers outermost_of(const Layers& layers) {
    Layers one = layers;
    one.layers.resize(1);
    return one;
}

double stiffness_of(const Layer& layer) {
    return *layer[HapticProperty::stiffness];
}

double puncture_force_of(const Layer& layer) {
    return *layer[HapticProperty::puncture_force];
}

double spring_at(const Layers& layers, double depth) {
    double reached = -never;  // where the hand was when the last surface gave way
    for (const Layer& layer : layers.layers) {
        // The next surface is met at its level, or where the last one let the hand go behind it.
        if (depth <= std::max(reached, layer.level)) return 0;
        const double stretch = depth - layer.level, k = stiffness_of(layer);
        if (k * stretch < puncture_force_of(layer)) return k * stretch;
        reached = layer.level + puncture_force_of(layer) / k;
    }
    return 0;
}

double drag_at(const Layers& layers, double depth) {
    const auto gave_way = [&](std::size_t i) {
        const Layer& layer = layers.layers[i];
        return depth >= layer.level + puncture_force_of(layer) / stiffness_of(layer);
    };
    double sum = 0;
    for (std::size_t i = 0; i < layers.layers.size() && gave_way(i); ++i) {
        // The shaft reaches to the tip, which the next surface may hold.
        const bool is_innermost = i + 1 == layers.layers.size();
        const double end = is_innermost ? depth : std::min(depth, layers.layers[i + 1].level);
        sum += (end - layers.layers[i].level) * *layers.layers[i][HapticProperty::drag];
    }
    return sum;
}

Renderer layered_renderer(const Field& field, std::shared_ptr<const Layers> layers,
                          double physical_damping) {
    RendererSettings settings;
    settings.force.ramp = 0;
    settings.force.rate_limit = never;
    settings.force.limit = settings.device.maximum_force = 1e6;
    settings.device.physical_damping = physical_damping;
    const double outermost = layers->layers.front().level;
    settings.layers = std::move(layers);
    return make_renderer(field, outermost, settings);
}

}  // namespace palpate::evaluation
