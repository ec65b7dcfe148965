// The rule by which a force reaches a vendor's call.
#include "devices/vendor_library.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace palpate::devices {
namespace {

constexpr std::int64_t ms = 1'000'000;
const Vec3 push(0, 3, 0);

/// A gate that has been told `ready` every millisecond from `begin` to `end`.
void keep(ForceGate& gate, std::int64_t begin, std::int64_t end) {
    for (std::int64_t now = begin; now <= end; now += ms) gate.note(true, now);
}

TEST(ForceGate, lets_nothing_through_before_the_device_was_ready_for_20_ms) {
    ForceGate gate;
    EXPECT_EQ(gate.pass(push, 10, 0), Vec3(0, 0, 0));
    keep(gate, 0, 19 * ms);
    EXPECT_EQ(gate.pass(push, 10, 19 * ms), Vec3(0, 0, 0));
    gate.note(true, 20 * ms);
    EXPECT_EQ(gate.pass(push, 10, 20 * ms), push);
}

TEST(ForceGate, begins_anew_after_a_break) {
    ForceGate gate;
    keep(gate, 0, 100 * ms);
    gate.note(false, 101 * ms);
    EXPECT_EQ(gate.pass(push, 10, 101 * ms), Vec3(0, 0, 0));
    keep(gate, 102 * ms, 121 * ms);
    EXPECT_EQ(gate.pass(push, 10, 121 * ms), Vec3(0, 0, 0));
    gate.note(true, 122 * ms);
    EXPECT_EQ(gate.pass(push, 10, 122 * ms), push);
}

TEST(ForceGate, silence_is_a_break) {
    ForceGate gate;
    keep(gate, 0, 100 * ms);
    EXPECT_EQ(gate.pass(push, 10, 121 * ms), Vec3(0, 0, 0));
    gate.note(true, 121 * ms);
    EXPECT_EQ(gate.pass(push, 10, 121 * ms), Vec3(0, 0, 0));
}

TEST(ForceGate, cuts_to_the_most_and_refuses_what_is_not_finite) {
    ForceGate gate;
    keep(gate, 0, 100 * ms);
    EXPECT_LE((gate.pass(Vec3(30, 0, 40), 5, 100 * ms) - Vec3(3, 0, 4)).norm(), 1e-12);
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(gate.pass(Vec3(nan, 0, 0), 5, 100 * ms), Vec3(0, 0, 0));
    EXPECT_EQ(gate.pass(Vec3(0, 0, std::numeric_limits<double>::infinity()), 5, 100 * ms),
              Vec3(0, 0, 0));
    EXPECT_LE(gate.pass(Vec3(1e200, 1e200, 0), 5, 100 * ms).norm(), 5 + 1e-12);
}

TEST(Position, is_finite_and_within_10_m) {
    EXPECT_TRUE(is_position(Vec3(0, 10'000, 0)));
    EXPECT_FALSE(is_position(Vec3(0, 10'000, 200)));
    EXPECT_FALSE(is_position(Vec3(0, std::numeric_limits<double>::quiet_NaN(), 0)));
    EXPECT_FALSE(is_position(Vec3(0, 0, -std::numeric_limits<double>::infinity())));
}

TEST(VendorLibrary, tells_every_name_it_tried) {
    try {
        VendorLibrary({"/nowhere/a.so", "/nowhere/b.so"}, "install it");
        FAIL();
    } catch (const DeviceError& error) {
        const std::string message = error.what();
        EXPECT_NE(message.find("/nowhere/a.so"), std::string::npos) << message;
        EXPECT_NE(message.find("/nowhere/b.so"), std::string::npos) << message;
        EXPECT_NE(message.find("): install it"), std::string::npos) << message;
    }
}

}  // namespace
}  // namespace palpate::devices
