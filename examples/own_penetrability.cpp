// Your own penetrability function: soft tissue gives way at 0.5 mm, bone at 4 mm.
#include <cstdio>
#include <vector>

#include "palpate/palpate.hpp"

namespace {

struct Tissue {
    double bone_from;  // density
};

double threshold(const palpate::Pressing& pressing, const void* context) {
    const auto& tissue = *static_cast<const Tissue*>(context);
    return pressing.isovalue < tissue.bone_from ? 0.5 : 4.0;  // device mm
}

}  // namespace

int main() {
    using namespace palpate;
    // Layers across z: air, 20 samples of tissue (300), bone (1500).
    Geometry geometry;
    geometry.size = {16, 16, 60};
    std::vector<std::int16_t> samples;
    for (int k = 0; k < 60; ++k) {
        const std::int16_t density = k < 20 ? 1500 : k < 40 ? 300 : -1000;
        samples.insert(samples.end(), 16 * 16, density);
    }
    const Tissue tissue{1000};
    RendererSettings settings;
    settings.penetrability = penetrability_threshold(1.0, -200);
    settings.penetrability.function = &threshold;
    settings.penetrability.context = &tissue;
    Renderer renderer = make_renderer(Field(Volume(geometry, std::move(samples))), -200, settings);

    for (int tick = 0; tick <= 1000; ++tick) {
        const double time = 0.001 * tick;
        const Vec3 hand(7.5, 7.5, 50 - 40 * time);
        const Tick result = render(renderer, {time, hand});
        if (tick % 100 != 0) continue;
        std::printf("hand at z %5.1f mm  felt level %7.1f  force %.2f N\n", hand[2],
                    result.proxy.isovalue, result.force.norm());
    }
}
