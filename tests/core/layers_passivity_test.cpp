// Layers give back no more energy than they took, also in thin layers and where stiffness varies
// along a surface. Every combination with other fields, tools and samples: energy_test.cpp.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "palpate/renderer.hpp"
#include "support/cubic_guarantees.hpp"
#include "support/fields.hpp"
#include "support/hand.hpp"
#include "support/layer.hpp"

using namespace palpate;
using namespace palpate::support;
using enum HapticProperty;

namespace {

constexpr double no_puncture = std::numeric_limits<double>::infinity();

/// Levels of a field in parts of its range from an isovalue, with these stiffnesses.
Layers layers_of(const TestField& test, std::initializer_list<double> parts,
                 std::initializer_list<double> stiffnesses, double force) {
    Layers layers;
    for (std::size_t i = 0; i < parts.size(); ++i) {
        const double off = parts.begin()[i] * test.field.range() * test.field.sign();
        layers.layers.push_back(layer_of("layer " + std::to_string(i), test.isovalue + off,
                                         stiffnesses.begin()[i], force));
    }
    return layers;
}

/// Without surfaces, layers leave the field's level, and penetrability is on.
Renderer loop_renderer(const TestField& test, const Layers& layers) {
    RendererSettings settings = at_once();
    settings.layers = std::make_shared<Layers>(layers);
    const bool has_surfaces = !layers.layers.empty();
    if (!has_surfaces) {
        settings.penetrability =
            penetrability_threshold(no_puncture, test.isovalue, test.field.solid());
    }
    settings.force.limit = settings.device.maximum_force = 1e6;
    settings.device.physical_damping = 1;
    return make_renderer(test.field, has_surfaces ? layers.layers.front().level : test.isovalue,
                         settings);
}

/// A closed path round a point, as a sum of a few waves.
struct Loop {
    Vec3 centre;
    std::array<Vec3, 4> sines, cosines;

    Loop(Random& random, const Vec3& at, double reach) : centre(at) {
        for (int i = 0; i < 4; ++i) {
            sines[i] = reach / (1 + i) * random.uniform(0, 1) * random.direction();
            cosines[i] = reach / (1 + i) * random.uniform(0, 1) * random.direction();
        }
    }
    Vec3 operator()(double part) const {
        Vec3 at = centre;
        for (int i = 0; i < 4; ++i) {
            const double phase = 2 * 3.14159265358979323846 * (i + 1) * part;
            at += std::sin(phase) * sines[i] + (std::cos(phase) - 1) * cosines[i];
        }
        return at;
    }
};

struct Balance {
    double most_gained = -no_puncture;  ///< of all loops [J]
    double lost = 0;                    ///< in all of them [J]
    int punctures = 0, contacts = 0;
    double least_lost = no_puncture;  ///< of the loops with a puncture [J]
};

/// The work of the force on the hand round each of many loops that begin and end in free space.
Balance work_of(const TestField& test, const Layers& layers, int loops, int steps,
                std::uint64_t seed) {
    Random random(seed);
    Balance balance;
    const Geometry& geometry = test.field.geometry();
    const Vec3 size = geometry.size.cast<double>();
    for (int i = 0; i < loops; ++i) {
        Renderer renderer = loop_renderer(test, layers);
        const Vec3 index(random.uniform(0, size[0]), random.uniform(0, size[1]),
                         random.uniform(0, size[2]));
        const Loop loop(random, physical_from_index(geometry, index), 3);
        double work = 0;
        Tick last;
        Vec3 from = loop(0);
        const auto step = [&](const Vec3& to, int number) {
            const Tick tick = render(renderer, {.time = number * 0.001, .position = to});
            balance.punctures += tick.layers.punctured;
            balance.contacts += tick.proxy.mode == Mode::constrained;
            work += 0.5 * (last.force + tick.force).dot(to - from);
            last = tick;
            from = to;
        };
        step(loop(0), 0);
        work = 0;
        const Vec3 begun = renderer.proxy.scp_physical;
        const double stored = 0.5 * (last.force).dot(begun - from);  // of the spring [N mm]
        const int before = balance.punctures;
        for (int k = 1; k <= steps; ++k) step(loop(double(k) / steps), k);
        const double gained = (work - stored) / 1000;
        balance.most_gained = std::max(balance.most_gained, gained);
        balance.lost -= gained;
        if (balance.punctures > before) balance.least_lost = std::min(balance.least_lost, -gained);
    }
    return balance;
}

void expect_passive(const TestField& test, const Layers& layers, std::uint64_t seed,
                    int loops = scaled_or_asked(200)) {
    const Balance balance = work_of(test, layers, loops, 4000, seed);
    std::printf(
        "[ evidence ] %-12s loops %d  contacts %d  punctures %d  most gained %.2e J  lost %.2e J\n",
        test.name.c_str(), loops, balance.contacts, balance.punctures, balance.most_gained,
        balance.lost);
    EXPECT_LE(balance.most_gained, 1e-6);
    EXPECT_GT(balance.least_lost, 0) << "a surface that gives way takes energy";
    EXPECT_GT(balance.contacts, loops * 100);
}

TestField smoothed(const TestField& test) {
    return {test.name, smooth(test.field), test.isovalue};
}

}  // namespace

TEST(LayersEnergy, is_not_made_by_surfaces_that_hold) {
    const TestField test = smoothed(marschner_lobb_field());
    expect_passive(test, layers_of(test, {-0.1, 0.1}, {0.4, 1.5}, no_puncture), 51);
}
TEST(LayersEnergy, is_not_made_by_surfaces_that_give_way) {
    const TestField test = smoothed(marschner_lobb_field());
    expect_passive(test, layers_of(test, {-0.15, -0.05, 0.05, 0.15}, {0.4, 1.5, 0.3, 0.8}, 0.6),
                   52);
}
TEST(LayersEnergy, is_not_made_in_thin_layers_of_noise) {
    const TestField test = smoothed(noise_field());
    expect_passive(test, layers_of(test, {-0.03, -0.02, 0.01, 0.03}, {0.4, 1.5, 0.3, 0.8}, 0.6),
                   53);
}
TEST(LayersEnergy, is_not_made_by_stiffness_that_varies_along_a_surface) {
    const TestField test = smoothed(marschner_lobb_field());
    Layers layers = layers_of(test, {0}, {1}, no_puncture);
    layers[stiffness].gradient.knots = {{0, 0}, {0.3, 1}};
    expect_passive(test, layers, 54);
}
TEST(LayersEnergy, is_not_made_by_varying_stiffness_where_penetrability_is_on) {
    const TestField test = smoothed(marschner_lobb_field());
    Layers layers;
    layers[stiffness].density.knots = {{0, 1}};
    layers[stiffness].gradient.knots = {{0, 0}, {0.3, 1}};
    expect_passive(test, layers, 55);
}
