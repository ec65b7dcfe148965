// Reports of a 3D mouse as events.
#include "devices/spacenav/report.hpp"

#include <gtest/gtest.h>

#include "support/random.hpp"

namespace palpate::devices::spacenav {
namespace {

using Bytes = std::vector<unsigned char>;

/// Numbers of 16 bits, low byte first.
Bytes axes(std::initializer_list<int> values) {
    Bytes bytes;
    for (const int value : values) {
        bytes.push_back(static_cast<unsigned char>(value & 255));
        bytes.push_back(static_cast<unsigned char>(value >> 8 & 255));
    }
    return bytes;
}

TEST(SpacenavReport, axes_are_those_of_the_daemon) {
    ReportReader reader;
    // Right, towards the person and down, as the mouse has them.
    const auto slid = reader.take(1, axes({350, 20, -300}));
    EXPECT_EQ(slid, (std::vector<Event>{{motion, 350, 300, -20, 0, 0, 0, 0}}));
    const auto turned = reader.take(2, axes({1, -2, 3}));
    EXPECT_EQ(turned, (std::vector<Event>{{motion, 350, 300, -20, 1, -3, 2, 0}}));
}

TEST(SpacenavReport, all_axes_of_newer_mice_come_in_one) {
    ReportReader reader;
    const auto events = reader.take(1, axes({350, 20, -300, 1, -2, 3}));
    EXPECT_EQ(events, (std::vector<Event>{{motion, 350, 300, -20, 1, -3, 2, 0}}));
}

TEST(SpacenavReport, a_puck_that_is_pushed_away_moves_the_hand_away) {
    ReportReader reader;
    Hand hand;
    for (const Event& event : reader.take(1, axes({0, -350, 0}))) apply(hand, event, {});
    advance(hand, 0.5, {});
    EXPECT_EQ(hand.position, Vec3(0, 0, -50));
}

TEST(SpacenavReport, buttons_that_change_are_pressed_and_released) {
    ReportReader reader;
    EXPECT_EQ(reader.take(3, Bytes{0b101}), (std::vector<Event>{{press, 0}, {press, 2}}));
    EXPECT_EQ(reader.take(3, Bytes{0b101, 0}), (std::vector<Event>{}));
    EXPECT_EQ(reader.take(3, Bytes{0b100, 0, 0, 0x80}),
              (std::vector<Event>{{release, 0}, {press, 31}}));
}

TEST(SpacenavReport, any_bytes_are_taken) {
    ReportReader reader;
    EXPECT_TRUE(reader.take(1, Bytes(5)).empty());
    EXPECT_TRUE(reader.take(2, Bytes(12)).empty());
    EXPECT_TRUE(reader.take(3, Bytes{}).empty());
    EXPECT_TRUE(reader.take(23, Bytes{1, 2}).empty());
    EXPECT_EQ(reader.take(1, axes({-32768, -32768, -32768}))[0][2], 32768);
}

}  // namespace
}  // namespace palpate::devices::spacenav
