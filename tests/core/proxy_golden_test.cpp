// Proxy: same input, same output, bit for bit. The hash of seeded trajectories is the same at every
// optimisation level and with every compiler that keeps IEEE arithmetic (-ffp-contract=off).
//
// scripts/golden.sh runs this with g++ and clang++, each at -O0 and -O3. A change of the method
// changes the hashes: read the new ones off the failure, after the other proxy tests have passed.
#include <gtest/gtest.h>

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

/// The same fields, felt smoothly.
std::vector<TestField> smooth_golden_fields() {
    std::vector<TestField> fields = golden_fields();
    for (TestField& test : fields) test.field = smooth(test.field);
    return fields;
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
        EXPECT_EQ(hex(trajectory(fields[i], update_paper, {})), expected[i]) << fields[i].name;
    }
}

TEST(Golden, trajectories_on_smooth_fields_are_the_same_bit_for_bit) {
    const std::vector<std::string> expected{"2de7e32936d314eb", "baaded847ba944c4",
                                            "ad3e1ca59e854492", "274d66ba719a3767",
                                            "5554025aeadb2ee3"};
    const std::vector<std::string> with_friction{"f8a26ccc63c13a8d", "3d9b3c0be2cb3c3a",
                                                 "69c59193bf2a097e", "231a77a158eaaaae",
                                                 "0b59caa6ef035a22"};
    const std::vector<TestField> fields = smooth_golden_fields();
    ProxySettings settings;
    settings.friction = {0.5, 0.25};
    for (std::size_t i = 0; i < fields.size(); ++i) {
        EXPECT_EQ(hex(trajectory(fields[i], update_exact, {})), expected[i]) << fields[i].name;
        EXPECT_EQ(hex(trajectory(fields[i], update_exact, settings)), with_friction[i])
            << fields[i].name;
    }
}

TEST(Golden, trajectories_differ_when_the_input_does) {
    TestField test = noise_field();
    const std::uint64_t hash = trajectory(test, update_exact, {});
    EXPECT_EQ(trajectory(test, update_exact, {}), hash);
    test.isovalue += 1e-9;
    EXPECT_NE(trajectory(test, update_exact, {}), hash);
}
