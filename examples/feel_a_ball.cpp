// The smallest use of the library: a hand presses into a volume made in memory, and the force is
// printed.
#include <cmath>
#include <cstdio>
#include <vector>

#include "palpate/palpate.hpp"

int main() {
    using namespace palpate;
    Geometry geometry;
    geometry.size = {64, 64, 64};
    geometry.spacing = {0.5, 0.5, 0.5};  // mm
    const Vec3 centre = physical_centre(geometry);
    std::vector<float> samples;
    for (int k = 0; k < 64; ++k) {
        for (int j = 0; j < 64; ++j) {
            for (int i = 0; i < 64; ++i) {
                const Vec3 at = physical_from_index(geometry, Vec3(i, j, k));
                samples.push_back(static_cast<float>(10 - (at - centre).norm()));
            }
        }
    }
    const Field field(Volume(geometry, std::move(samples)));
    Renderer renderer = make_renderer(field, 0.0);  // the ball of radius 10 mm

    // The hand moves down onto the ball at 50 mm/s, with a tick every millisecond.
    for (int tick = 0; tick <= 400; ++tick) {
        const double time = 0.001 * tick;
        const Vec3 hand = centre + Vec3(0, 0, 25 - 50 * time);
        const Tick result = render(renderer, {time, hand});
        if (tick % 50 != 0) continue;
        std::printf("%.3f s  hand %6.2f mm above the centre  %-12s force %.2f N\n", time,
                    hand[2] - centre[2],
                    result.proxy.mode == Mode::constrained ? "in contact" : "free",
                    result.force.norm());
    }
}
