// Proxy: same input, same output, bit for bit. The hash of seeded trajectories is the same at every
// optimisation level and with every compiler that keeps IEEE arithmetic (-ffp-contract=off).
//
// scripts/golden.sh runs this with g++ and clang++, each at -O0 and -O3. A change of the method
// changes the hashes: read the new ones off the failure, after the other proxy tests have passed.
#include <gtest/gtest.h>

#include "palpate/baselines/methods.hpp"
#include "palpate/layers.hpp"
#include "support/fields.hpp"
#include "support/hand.hpp"
#include "support/proxy_state.hpp"

using namespace palpate;
using namespace palpate::support;

namespace {

/// The bits of the proxy after each of 4000 updates, isovalue moved now and then.
std::uint64_t trajectory(const TestField& test, ProxyMethod method, const ProxySettings& settings) {
    Hand hand(test.field.geometry(), 101);
    Random random(102);
    Proxy proxy;
    proxy.isovalue = test.isovalue;
    Hash hash;
    for (int i = 0; i < 4000; ++i) {
        if (i % 50 == 49) {
            proxy.isovalue = test.isovalue + random.uniform(-0.1, 0.1) * test.field.range();
        }
        const ProxyUpdate r = method(proxy, test.field, hand.next(), settings, {});
        hash.add(proxy);
        hash.add(r.density);
        hash.add(static_cast<std::uint64_t>(r.tetrahedra));
        hash.add(static_cast<std::uint64_t>(r.status));
    }
    return hash.value();
}

std::string hex(std::uint64_t value) {
    char text[20];
    std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(value));
    return text;
}

/// Fields without a sine or an exponential: the C library's may differ in the last bit.
std::vector<TestField> golden_fields() {
    return {noise_field(), anisotropic_field(), oblique_field(), offset_field(), box_field()};
}

/// The same volumes on the smooth field.
std::vector<TestField> smooth_golden_fields() {
    std::vector<TestField> fields = golden_fields();
    for (TestField& test : fields) test.field = smooth(test.field);
    return fields;
}

/// Three surfaces that give way, with friction and a stiffness that follows the gradient: levels of
/// the field, or three labels and nothing at random in each sample of another grid.
Layers golden_layers(const TestField& test, bool by_label) {
    Layers layers;
    const double range = test.field.range();
    for (int i = 0; i < 3; ++i) {
        Layer layer;
        layer.name = std::to_string(i);
        layer.level = by_label ? i + 1 : test.isovalue + (i - 1) * 0.1 * range;
        layer[HapticProperty::puncture_force] = 0.2 + 0.1 * i;
        layer[HapticProperty::static_friction] = 0.2 * i;
        layer[HapticProperty::dynamic_friction] = 0.1 * i;
        layers.layers.push_back(layer);
    }
    layers[HapticProperty::stiffness].gradient.knots = {{0, 0.5}, {0.5 * range, 1}};
    if (!by_label) return layers;
    const Geometry& data = test.field.geometry();
    const Volume labels =
        noise_volume<std::uint8_t>(grid(cube(16), Vec3::Constant(1.5), data.origin), 104, 0, 4);
    layers.by_label = true;
    layers.labels = numbered_labels(labels, layers.layers);
    return layers;
}

/// The bits of proxy, force and state after each of 2000 ticks.
std::uint64_t stroke(const TestField& test, bool by_label, bool with_needle, double limit) {
    Layers layers = golden_layers(test, by_label);
    if (with_needle) layers.needle = Needle{};
    for (Layer& layer : layers.layers) layer[HapticProperty::drag] = 0.05;
    const auto set = std::make_shared<const Layers>(std::move(layers));
    Hand hand(test.field.geometry(), 103);
    Proxy proxy;
    proxy.isovalue = test.isovalue;
    LayerState state;
    LayerInput input;
    input.force.limit = input.limits.maximum_force = limit;
    Hash hash;
    int punctured = 0;
    for (int i = 0; i < 2000; ++i) {
        input.hip = hand.next();
        input.time = 0.001 * i;
        const LayersUpdate r = update_layers(set, state, proxy, test.field, input);
        hash.add(proxy);
        hash.add(r.pull);
        hash.add(r.force.stiffness);
        hash.add(static_cast<std::uint64_t>(r.felt.touched + 1));
        hash.add(static_cast<std::uint64_t>(r.felt.inside));
        hash.add(static_cast<std::uint64_t>(state.open));
        punctured += r.felt.punctured;
    }
    EXPECT_GT(punctured, 20) << test.name;
    return hash.value();
}

}  // namespace

TEST(Golden, trajectories_of_the_exact_method_are_the_same_bit_for_bit) {
    const std::vector<std::string> expected{"0083e5451fddcb3f", "474b4d68d30b15f2",
                                            "588a48aa1c590084", "7b58ae389b7dbbfc",
                                            "f6f61fff57224f3a"};
    const std::vector<TestField> fields = golden_fields();
    for (std::size_t i = 0; i < fields.size(); ++i) {
        EXPECT_EQ(hex(trajectory(fields[i], update_exact, {})), expected[i]) << fields[i].name;
    }
}

TEST(Golden, trajectories_with_friction_are_the_same_bit_for_bit) {
    const std::vector<std::string> expected{"ae6f939f31d367af", "dcab42be59b51be6",
                                            "f15383d1d6b8be61", "27ae0188dfa81631",
                                            "c11ab50494cfb6d8"};
    const std::vector<TestField> fields = golden_fields();
    ProxySettings settings;
    settings.friction = {0.5, 0.25};
    for (std::size_t i = 0; i < fields.size(); ++i) {
        EXPECT_EQ(hex(trajectory(fields[i], update_exact, settings)), expected[i])
            << fields[i].name;
    }
}

TEST(Golden, trajectories_of_the_papers_method_are_the_same_bit_for_bit) {
    const std::vector<std::string> expected{"b0868d89432429b1", "dd0bde8146176890",
                                            "92b51240982c1778", "15f9e7158a66dc97",
                                            "bdb46d8b27496c97"};
    const std::vector<TestField> fields = golden_fields();
    for (std::size_t i = 0; i < fields.size(); ++i) {
        EXPECT_EQ(hex(trajectory(fields[i], baselines::update_paper, {})), expected[i])
            << fields[i].name;
    }
}

TEST(Golden, trajectories_on_smooth_fields_are_the_same_bit_for_bit) {
    const std::vector<std::string> expected{"e8a5d23c375b6586", "5d2150e470caa230",
                                            "cb4cdc35c30f6c86", "acca7b8dcd3ce3e4",
                                            "b4085f91d433ed67"};
    const std::vector<std::string> with_friction{"71d714bbbec9b250", "3fba0163cf94bc33",
                                                 "002a65d42a221dbd", "6df4f016452157bd",
                                                 "8c699d998fef4778"};
    const std::vector<TestField> fields = smooth_golden_fields();
    ProxySettings settings;
    settings.friction = {0.5, 0.25};
    for (std::size_t i = 0; i < fields.size(); ++i) {
        EXPECT_EQ(hex(trajectory(fields[i], update_exact, {})), expected[i]) << fields[i].name;
        EXPECT_EQ(hex(trajectory(fields[i], update_exact, settings)), with_friction[i])
            << fields[i].name;
    }
}

TEST(Golden, strokes_through_layers_are_the_same_bit_for_bit) {
    const std::vector<std::string> expected{
        "b2a06f20351cfcd7", "2bf7027a18a0964f", "024ee6e369ae8a5a", "d0b4fc53a8cf7eaa",
        "cce0063b12c4c95e", "8144431588592592", "f2550651b9f37992", "8bcfc394a2b55438",
        "6f4adef581e43ce5", "bf8606e8ef3cccc9", "64ea7789104de230", "38093b62daeca743",
        "b45874b489a51a4d", "9679e376703040e7", "ec6166a78d5a7315", "fc8ae0670892bdbd"};
    std::vector<TestField> fields{noise_field(), oblique_field()};
    for (TestField& test : smooth_golden_fields()) {
        if (test.name == "noise" || test.name == "oblique") fields.push_back(test);
    }
    auto next = expected.begin();
    for (const TestField& test : fields) {
        for (const bool by_label : {false, true}) {
            for (const bool with_needle : {false, true}) {
                EXPECT_EQ(hex(stroke(test, by_label, with_needle, 1e6)), *next++)
                    << test.name << ' ' << by_label << with_needle;
            }
        }
    }
    EXPECT_EQ(hex(stroke(fields.front(), false, true, 3.3)), "37cd1137c46ed486") << "at the limit";
}

TEST(Golden, trajectories_differ_when_the_input_does) {
    TestField test = noise_field();
    const std::uint64_t hash = trajectory(test, update_exact, {});
    EXPECT_EQ(trajectory(test, update_exact, {}), hash);
    test.isovalue += 1e-9;
    EXPECT_NE(trajectory(test, update_exact, {}), hash);
}
