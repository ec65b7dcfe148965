// Layers for tests, made from the properties that they examine, and renderers that feel them.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "palpate/renderer.hpp"
#include "support/press.hpp"

namespace palpate::support {

/// Its stiffness [N/mm] and puncture force [N]; the rest is as usual.
inline Layer layer_of(const std::string& name, double level, double stiffness, double force) {
    Layer made;
    made.name = name;
    made.level = level;
    made[HapticProperty::stiffness] = stiffness;
    made[HapticProperty::puncture_force] = force;
    return made;
}

/// Surfaces at these levels, all alike.
inline Layers surfaces_at(const std::vector<double>& levels, double stiffness, double force) {
    Layers layers;
    for (const double level : levels) {
        layers.layers.push_back(layer_of("at " + std::to_string(level), level, stiffness, force));
    }
    return layers;
}

/// Whose force follows the hand at once and has no limit that a test would meet.
inline RendererSettings layered_settings(Layers layers) {
    RendererSettings settings = at_once();
    settings.layers = std::make_shared<Layers>(std::move(layers));
    settings.force.limit = settings.device.maximum_force = 100;
    return settings;
}
inline Renderer renderer_of(const Field& field, const Layers& layers) {
    const double level = layers.layers.empty() ? 0 : layers.layers.front().level;
    return make_renderer(field, level, layered_settings(layers));
}

/// A hand that moves a renderer, at 1 kHz.
struct RenderedHand {
    Renderer renderer;
    double time = 0;
    std::vector<Step> path{};  ///< of the last tick

    Tick to(const Vec3& position) {
        path.clear();
        const StepObserver observer{[](const Step& step, void* to) {
                                        static_cast<std::vector<Step>*>(to)->push_back(step);
                                    },
                                    &path};
        return render(renderer, {.time = time += 0.001, .position = position}, observer);
    }
};

}  // namespace palpate::support
