// Layers give back no more energy than they took, and their surfaces are passed in order.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "palpate/renderer.hpp"
#include "support/cubic_guarantees.hpp"
#include "support/edits.hpp"
#include "support/fields.hpp"
#include "support/hand.hpp"
#include "support/labelled.hpp"
#include "support/press.hpp"

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
        Layer layer;
        layer.name = "layer " + std::to_string(i);
        layer.level = test.isovalue + parts.begin()[i] * test.field.range() * test.field.sign();
        layer[stiffness] = stiffnesses.begin()[i];
        layer[puncture_force] = force;
        layers.layers.push_back(layer);
    }
    return layers;
}

Renderer loop_renderer(const Field& field, const Layers& layers) {
    RendererSettings settings = at_once();
    settings.layers = std::make_shared<Layers>(layers);
    settings.force.limit = settings.device.maximum_force = 1e6;
    settings.device.physical_damping = 1;
    return make_renderer(field, layers.layers.front().level, settings);
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
        Renderer renderer = loop_renderer(test.field, layers);
        const Vec3 index(random.uniform(0, size[0]), random.uniform(0, size[1]),
                         random.uniform(0, size[2]));
        const Loop loop(random, physical_from_index(geometry, index), 3);
        double work = 0;
        Tick last;
        Vec3 from = loop(0);
        const auto step = [&](const Vec3& to, int number) {
            const Tick tick = render(renderer, {.time = number * 0.001, .position = to});
            balance.punctures += tick.layers.punctured;
            balance.contacts += tick.layers.touched >= 0;
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

/// The same layers with labels beside them, or in place of them.
Layers with_labels(const TestField& test, Layers layers, bool beside, std::uint64_t seed) {
    if (!beside) layers.layers.clear();
    layers.by_label = true;
    layers.levels_beside_labels = layers.layers.size();
    for (int i = 1; i <= 3; ++i) {
        Layer layer;
        layer.name = "label " + std::to_string(i);
        layer.level = i;
        layer[stiffness] = 0.4 * i;
        layer[puncture_force] = i == 3 ? no_puncture : 0.4;
        layers.layers.push_back(layer);
    }
    Geometry geometry = test.field.geometry();
    geometry.size = cube(16);
    geometry.spacing *= double(test.field.geometry().size[0]) / 16;
    layers.labels = numbered_labels(random_labels(seed, 3, geometry), layers.layers,
                                    layers.levels_beside_labels);
    return layers;
}

/// Noise as it was read, edited, or between two frames.
TestField noise_of_kind(int kind) {
    TestField test = noise_field();
    const Geometry& geometry = test.field.geometry();
    Random random(64);
    if (kind == 1) {
        auto samples = test.field.shared_samples();
        for (int i = 0; i < 5; ++i) {
            samples = edited(samples, random_edit(random, geometry, SampleType::uint8)).samples;
        }
        test.field.use(samples);
    }
    if (kind == 2) {
        test.field.use(std::make_shared<const Samples>(std::vector<Frame>{
            {0, test.field.volume()}, {1, noise_volume<std::uint8_t>(geometry, 65, 0, 256)}}));
        test.field.set_time(0.4);
    }
    return test;
}

TEST(LayersEnergy, is_not_made_by_labels_with_levels_or_without) {
    for (const bool cubic : {false, true}) {
        for (const bool beside : {true, false}) {
            for (const int kind : {0, 1, 2}) {
                const std::uint64_t seed = kind == 0 ? 62 : 65 + kind;
                TestField test = noise_of_kind(kind);
                if (cubic) test = smoothed(test);
                const Layers levels = layers_of(test, {-0.2, 0, 0.2}, {0.4, 1.5, 0.8}, 0.5);
                const Layers layers = with_labels(test, levels, beside, seed);
                SCOPED_TRACE(testing::Message() << cubic << ' ' << beside << ' ' << kind);
                expect_passive(test, layers, seed, scaled_or_asked(40));
            }
        }
    }
}
