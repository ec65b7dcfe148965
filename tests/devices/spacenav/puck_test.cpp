// The messages of spacenavd, and the motion that follows from them.
#include "devices/spacenav/puck.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <array>
#include <cstring>
#include <limits>

#include "support/random.hpp"

namespace palpate::devices::spacenav {
namespace {

constexpr std::int32_t least = std::numeric_limits<std::int32_t>::min();
constexpr std::int32_t most = std::numeric_limits<std::int32_t>::max();

Event slides(std::int32_t x, std::int32_t y, std::int32_t z) {
    return {motion, x, y, z, 0, 0, 0, 8};
}
Event twists(std::int32_t x, std::int32_t y, std::int32_t z) {
    return {motion, 0, 0, 0, x, y, z, 8};
}

/// A hand after half a second of this event.
Hand after(const Event& event, const Feel& feel = {}) {
    Hand hand;
    apply(hand, event, feel);
    advance(hand, 0.5, feel);
    return hand;
}

Mat3 turned(double degrees, const Vec3& axis) {
    return Eigen::AngleAxisd(degrees * 0.017453292519943295, axis).toRotationMatrix();
}

std::span<const unsigned char> bytes_of(const Event& event) {
    return {reinterpret_cast<const unsigned char*>(event.data()), sizeof event};
}

TEST(Puck, slides_to_the_right_up_and_away_where_the_daemon_says_so) {
    EXPECT_LE((after(slides(350, 0, 0)).position - Vec3(50, 0, 0)).norm(), 1e-12);
    EXPECT_LE((after(slides(0, 175, 0)).position - Vec3(0, 25, 0)).norm(), 1e-12);
    EXPECT_LE((after(slides(0, 0, 35)).position - Vec3(0, 0, -5)).norm(), 1e-12);
    EXPECT_EQ(after(slides(350, 350, 350)).orientation, Mat3(Mat3::Identity()));
}

TEST(Puck, twists_about_the_same_axes) {
    EXPECT_LE((after(twists(350, 0, 0)).orientation - turned(45, Vec3::UnitX())).norm(), 1e-12);
    EXPECT_LE((after(twists(0, 350, 0)).orientation - turned(45, Vec3::UnitY())).norm(), 1e-12);
    EXPECT_LE((after(twists(0, 0, 350)).orientation - turned(-45, Vec3::UnitZ())).norm(), 1e-12);
    EXPECT_EQ(after(twists(350, 350, 350)).position, Vec3(0, 0, 0));
}

TEST(Puck, a_twist_is_about_the_axes_of_the_device_not_of_the_tool) {
    Hand hand = after(twists(0, 350, 0));
    apply(hand, twists(350, 0, 0), {});
    advance(hand, 0.5, {});
    const Mat3 expected = turned(45, Vec3::UnitX()) * turned(45, Vec3::UnitY());
    EXPECT_LE((hand.orientation - expected).norm(), 1e-12);
}

TEST(Puck, goes_on_until_it_is_let_go) {
    Hand hand;
    apply(hand, slides(35, 0, 0), {});
    for (int i = 0; i < 100; ++i) advance(hand, 0.001, {});
    EXPECT_NEAR(hand.position[0], 1, 1e-12);
    apply(hand, slides(0, 0, 0), {});
    advance(hand, 0.1, {});
    EXPECT_NEAR(hand.position[0], 1, 1e-12);
    apply(hand, slides(35, 0, 0), {});
    apply(hand, {press, 1}, {});
    release_all(hand);
    advance(hand, 0.1, {});
    EXPECT_NEAR(hand.position[0], 1, 1e-12);
    EXPECT_EQ(hand.buttons, 0U);
}

TEST(Puck, is_as_fast_as_asked_for) {
    const Feel feel{.speed = 20, .turn = 10, .deflection = 500};
    EXPECT_LE((after(slides(250, 0, 0), feel).position - Vec3(5, 0, 0)).norm(), 1e-12);
    EXPECT_LE((after(twists(500, 0, 0), feel).orientation - turned(5, Vec3::UnitX())).norm(),
              1e-12);
}

TEST(Puck, no_deflection_is_more_than_full_and_no_hand_leaves_its_box) {
    EXPECT_LE((after(slides(most, least, 1000)).position - Vec3(50, -50, -50)).norm(), 1e-12);
    Hand hand;
    apply(hand, {motion, most, least, least, most, most, least, most}, {});
    for (int i = 0; i < 100; ++i) advance(hand, 0.02, {});
    EXPECT_EQ(hand.position, Vec3(80, -80, 80));
}

TEST(Puck, an_orientation_stays_one) {
    support::Random random(5);
    Hand hand;
    for (int i = 0; i < 20'000; ++i) {
        const auto count = [&] { return static_cast<std::int32_t>(random.uniform(-400, 400)); };
        apply(hand, twists(count(), count(), count()), {});
        advance(hand, 0.02, {});
    }
    const Mat3& m = hand.orientation;
    EXPECT_LE((m.transpose() * m - Mat3::Identity()).norm(), 1e-12);
    EXPECT_NEAR(m.determinant(), 1, 1e-12);
}

TEST(Puck, buttons_are_held_until_released_and_those_that_cannot_be_are_passed_over) {
    Hand hand;
    apply(hand, {press, 0}, {});
    apply(hand, {press, 31}, {});
    EXPECT_EQ(hand.buttons, 0x80000001U);
    for (const std::int32_t button : {-1, 32, least, most}) apply(hand, {press, button}, {});
    EXPECT_EQ(hand.buttons, 0x80000001U);
    apply(hand, {release, 0}, {});
    EXPECT_EQ(hand.buttons, 0x80000000U);
}

TEST(Puck, events_of_other_types_change_nothing) {
    Hand hand;
    apply(hand, slides(350, 0, 0), {});
    apply(hand, {press, 1}, {});
    for (const std::int32_t type : {4, 5, -1, 0x7faa5500, least, most}) {
        apply(hand, {type, 1, 350, 350, 350, 350, 350, 350}, {});
    }
    EXPECT_EQ(hand.slide, Vec3(1, 0, 0));
    EXPECT_EQ(hand.twist, Vec3(0, 0, 0));
    EXPECT_EQ(hand.buttons, 2U);
}

TEST(Puck, events_are_put_together_from_pieces_of_any_size) {
    support::Random random(3);
    std::vector<unsigned char> stream;
    for (std::int32_t i = 0; i < 200; ++i) {
        const Event event = slides(i, -i, 7 * i);
        const auto bytes = bytes_of(event);
        stream.insert(stream.end(), bytes.begin(), bytes.end());
    }
    EventReader reader;
    std::int32_t seen = 0;
    for (std::size_t at = 0; at < stream.size();) {
        const auto size = static_cast<std::size_t>(random.uniform(0, 90));
        const std::size_t end = std::min(at + size, stream.size());
        reader.take(std::span(stream).subspan(at, end - at));
        at = end;
        while (const auto event = reader.next()) {
            EXPECT_EQ(*event, slides(seen, -seen, 7 * seen));
            ++seen;
        }
    }
    EXPECT_EQ(seen, 200);
}

TEST(Puck, the_answer_about_the_protocol_is_passed_over_wherever_it_comes) {
    std::array<unsigned char, sizeof protocol_1> answer{};
    std::memcpy(answer.data(), &protocol_1, sizeof protocol_1);
    for (std::int32_t before = 0; before <= 3; ++before) {
        EventReader reader;
        for (std::int32_t i = 0; i < 5; ++i) {
            if (i == before) {
                reader.take(std::span(answer).first(3));
                EXPECT_FALSE(reader.next());
                reader.take(std::span(answer).subspan(3));
            }
            reader.take(bytes_of(slides(i, -i, 7 * i)));
            EXPECT_EQ(reader.next(), slides(i, -i, 7 * i)) << i << " with the answer at " << before;
        }
        EXPECT_FALSE(reader.next());
    }
}

TEST(Puck, the_socket_is_looked_for_where_libspnav_does) {
    using Paths = std::vector<std::string>;
    EXPECT_EQ(socket_paths("", ""), Paths{"/var/run/spnav.sock"});
    EXPECT_EQ(socket_paths("/a", "dead-zone = 2\n  socket =  /b c \r\nsocket = /d\n"),
              (Paths{"/a", "/b c", "/var/run/spnav.sock"}));
    EXPECT_EQ(socket_paths("", "#socket = /b\nsocket =\nsocket-of = /c\nsocket\n"),
              Paths{"/var/run/spnav.sock"});
    EXPECT_EQ(socket_paths("/var/run/spnav.sock", "socket=/x"),
              (Paths{"/var/run/spnav.sock", "/x"}));
}

}  // namespace
}  // namespace palpate::devices::spacenav
