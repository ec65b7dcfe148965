// Random lives of layers on every field and of every kind: the SCP never is where it may not be, by
// a slow evaluation of the field of its own, and nothing opens but by a puncture.
#include <gtest/gtest.h>

#include "support/constants.hpp"
#include "support/hand.hpp"
#include "support/labelled.hpp"
#include "support/layer.hpp"
#include "support/parameter.hpp"
#include "support/press.hpp"

using namespace palpate;
using namespace palpate::support;

namespace {

enum class Kind { levels, labels, both };

struct Life {
    Interpolation interpolation;
    Kind kind;
    Solid solid;
};

Layers layers_for(const Life& life, const Field& data, Random& random) {
    const double low = data.volume().minimum(), range = data.volume().range();
    Layers layers;
    const int levels = life.kind == Kind::labels ? 0 : 3, labels = life.kind == Kind::levels ? 0 : 3;
    for (int i = 0; i < levels; ++i) {
        const double part = 0.3 + 0.2 * i;
        layers.layers.push_back(layer_of("level " + std::to_string(i),
                                         low + (life.solid == Solid::above ? part : 1 - part) * range,
                                         random.uniform(0.3, 1), i == 2 ? infinity : 0.3));
    }
    for (int i = 1; i <= labels; ++i) {
        layers.layers.push_back(layer_of("label " + std::to_string(i), i, random.uniform(0.3, 1),
                                         i == 3 ? infinity : 0.25));
    }
    if (labels > 0) {
        layers.by_label = true;
        layers.levels_beside_labels = std::size_t(levels);
        layers.labels = numbered_labels(
            // No sample of the data lies half-way between two labels.
            random_labels(9, 3, grid(cube(16), Vec3::Constant(1.5), {-1, 0.5, 0.2})),
            layers.layers, layers.levels_beside_labels);
    }
    return layers;
}

class LayerLives : public testing::TestWithParam<Life> {};

TEST_P(LayerLives, stay_in_what_is_open_and_open_nothing_without_a_puncture) {
    const Life& life = GetParam();
    const Field data(noise_field().field.volume(), life.solid, std::nullopt, life.interpolation);
    int touched = 0, punctured = 0, inside = 0;
    for (std::uint64_t seed = 1; seed <= 6; ++seed) {
        Random random(seed);
        const Layers layers = layers_for(life, data, random);
        RendererSettings settings = at_once();
        settings.layers = std::make_shared<const Layers>(layers);
        Renderer renderer = make_renderer(data, layers.layers[0].level, settings);
        Hand hand(data.geometry(), seed);
        for (int i = 0; i < scaled(3000); ++i) {
            const LayerState before = renderer.layers;
            const Tick tick =
                render(renderer, {.time = (i + 1) * 0.001, .position = hand.next()});
            if (i == 0) continue;  // where the hand begins, it may have to be brought out
            const LayerState& state = renderer.layers;
            ASSERT_EQ(tick.proxy.status, UpdateStatus::done) << "seed " << seed << ", tick " << i;
            const TouchedField now{data, layers, state};
            ASSERT_LE(now.beyond(tick.proxy.scp), 1e-9) << "seed " << seed << ", tick " << i;
            if (tick.layers.punctured == 0) {
                const TouchedField was{data, layers, before};
                ASSERT_LE(was.beyond(tick.proxy.scp), 1e-9) << "seed " << seed << ", tick " << i;
                ASSERT_EQ(state.open & ~before.open, 0U);
                if (before.open & state.open & 1U) {
                    ASSERT_LE(state.inner, before.inner);
                    ASSERT_GE(state.outer, before.outer);
                }
            }
            touched += tick.layers.touched >= 0;
            punctured += tick.layers.punctured;
            inside += tick.layers.inside > 0;
        }
    }
    EXPECT_GT(touched, scaled(3000));
    EXPECT_GT(punctured, scaled(100));
    EXPECT_GT(inside, scaled(300));
}

std::vector<Life> lives() {
    std::vector<Life> all;
    for (const auto interpolation : {Interpolation::linear, Interpolation::cubic}) {
        for (const Kind kind : {Kind::levels, Kind::labels, Kind::both}) {
            for (const Solid solid : {Solid::above, Solid::below}) {
                all.push_back({interpolation, kind, solid});
            }
        }
    }
    return all;
}

std::string name_of(const testing::TestParamInfo<Life>& life) {
    const std::array<std::string, 3> kinds{"levels", "labels", "both"};
    return std::string(palpate::name_of(life.param.interpolation)) + "_" +
           kinds[std::size_t(life.param.kind)] +
           (life.param.solid == Solid::above ? "_above" : "_below");
}

INSTANTIATE_TEST_SUITE_P(Kinds, LayerLives, testing::ValuesIn(lives()), name_of);

}  // namespace
