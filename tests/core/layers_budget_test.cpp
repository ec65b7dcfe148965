// Layers: a tick has one budget, whatever is done in it.
#include <gtest/gtest.h>

#include "palpate/layers.hpp"
#include "support/fields.hpp"
#include "support/hand.hpp"
#include "support/layer.hpp"

using namespace palpate;
using namespace palpate::support;

TEST(LayersBudget, failed_rounds_and_recovery_are_taken_from_the_budget_of_the_tick) {
    for (const bool cubic : {false, true}) {
        TestField test = noise_field();
        if (cubic) test.field = smooth(test.field);
        const auto layers = std::make_shared<Layers>();
        for (int i = 0; i < 8; ++i) {
            layers->layers.push_back(layer_of(std::to_string(i), 60 + 15 * i, 0.5, 0.01));
        }
        Hand hand(test.field.geometry(), 7);
        Proxy proxy;
        LayerState state;
        LayerInput input;
        int full = 0, punctured = 0;
        for (int i = 0; i < scaled(10'000); ++i) {
            input.proxy.step_budget = 20 + 10 * (i % 7);
            input.hip = hand.next();
            input.time = 0.001 * i;
            const LayersUpdate r = update_layers(layers, state, proxy, test.field, input);
            ASSERT_LE(r.proxy.work, input.proxy.step_budget) << "tick " << i;
            ASSERT_GE(r.proxy.work, r.proxy.tetrahedra) << "tick " << i;
            full += r.proxy.work == input.proxy.step_budget;
            punctured += r.felt.punctured;
        }
        EXPECT_GT(punctured, scaled(500));
        EXPECT_GT(full, scaled(50));
    }
}
