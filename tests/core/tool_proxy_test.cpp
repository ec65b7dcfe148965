// The proxy of a rigid tool: no point of it ever goes through, and at rest its pose is the best.
#include "palpate/tool_proxy.hpp"

#include <gtest/gtest.h>

#include <string>

#include "support/allocation_counter.hpp"
#include "support/fields.hpp"
#include "support/hand.hpp"
#include "support/tool_guarantees.hpp"

namespace palpate {
namespace {

using support::Hand;
using support::Random;
using support::TestField;
using support::ToolGuarantees;

/// A hand that also turns, up to some speed, and sometimes jumps to any orientation.
class TurningHand {
  public:
    TurningHand(const Geometry& geometry, std::uint64_t seed)
        : hand_(geometry, seed), random_(seed + 1000) {}

    Pose next() {
        if (--left_ <= 0) {
            left_ = 1 + random_.below(60);
            spin_ = random_.direction() * (random_.chance(0.3) ? 0.02 : random_.uniform(0, 0.004));
            if (random_.chance(0.05)) spin_ = random_.direction() * 2;
        }
        orientation_ = turned(orientation_, spin_);
        if (spin_.norm() > 1) spin_.setZero();
        return {hand_.next(), orientation_};
    }

  private:
    Hand hand_;
    Random random_;
    Quaternion orientation_ = Quaternion::Identity();
    Vec3 spin_ = Vec3::Zero();
    int left_ = 0;
};

void keeps(const TestField& test, const Tool& tool, std::uint64_t seed, int usual,
           const ToolSettings& settings = {}) {
    SCOPED_TRACE(test.name);
    const Field field = support::smooth(test.field);
    ToolProxy proxy(std::make_shared<Tool>(tool));
    proxy.isovalue = test.isovalue;
    ToolGuarantees guarantees(field, settings);
    TurningHand hand(field.geometry(), seed);
    const int count = support::scaled_or_asked(usual);
    for (int i = 0; i < count && !testing::Test::HasFailure(); ++i) {
        SCOPED_TRACE("tick " + std::to_string(i));
        guarantees.update(proxy, hand.next());
    }
    guarantees.print(test.name + " " + std::to_string(tool.points().size()));
}

TEST(ToolProxy, keeps_its_guarantees_in_noise_as_a_point) {
    keeps(support::noise_field(), point_tool(), 1, 2000);
}
TEST(ToolProxy, keeps_its_guarantees_in_noise_as_a_rod) {
    keeps(support::noise_field(), rod_tool(4, 0.5), 2, 2000);
}
TEST(ToolProxy, keeps_its_guarantees_in_noise_with_friction) {
    ToolSettings settings;
    settings.friction = {.static_coefficient = 0.6, .dynamic_coefficient = 0.4};
    keeps(support::noise_field(), rod_tool(4, 0.5), 9, 1000, settings);
}
TEST(ToolProxy, keeps_its_guarantees_in_salt_as_a_ball) {
    keeps(support::salt_field(), sphere_tool(1.5, 0.7), 3, 1000);
}
TEST(ToolProxy, keeps_its_guarantees_on_a_box_as_a_box) {
    keeps(support::box_field(), box_tool({4, 3, 2}, 1), 4, 1000);
}
TEST(ToolProxy, keeps_its_guarantees_on_a_shell_as_a_box) {
    keeps(support::shell_field(), box_tool({4, 3, 2}, 0.5), 5, 500);
}
TEST(ToolProxy, keeps_its_guarantees_on_an_anisotropic_grid) {
    keeps(support::anisotropic_field(), rod_tool(4, 0.5), 6, 1000);
}
TEST(ToolProxy, keeps_its_guarantees_on_an_oblique_grid) {
    keeps(support::oblique_field(), box_tool({2, 2, 2}, 1), 7, 1000);
}
TEST(ToolProxy, keeps_its_guarantees_on_marschner_and_lobbs_function) {
    keeps(support::marschner_lobb_field(), box_tool({4, 3, 2}, 0.5), 8, 400);
}

/// Falls along z to 0 at `height`: solid below.
Field plane_field(double height = 12) {
    return Field(support::volume_of<float>(support::grid(support::cube(24)),
                                           [&](const Index3& i) { return height - i[2]; }));
}

ToolProxy proxy_of(const Tool& tool, double isovalue = 0) {
    ToolProxy proxy(std::make_shared<Tool>(tool));
    proxy.isovalue = isovalue;
    return proxy;
}

Pose at(double x, double y, double z, const Vec3& rotation = Vec3::Zero()) {
    return {{x, y, z}, turned(Quaternion::Identity(), rotation)};
}

TEST(ToolProxy, reaches_a_free_hand_to_the_bit) {
    const Field field = plane_field();
    ToolProxy proxy = proxy_of(box_tool({4, 3, 2}, 1));
    update_tool(proxy, field, at(12, 12, 18));
    const Pose hand = at(10, 13, 16, {0.3, -0.2, 0.9});
    const ToolUpdate r = update_tool(proxy, field, hand);
    EXPECT_EQ(r.status, UpdateStatus::done);
    EXPECT_EQ(r.mode, Mode::free);
    EXPECT_EQ(r.proxy.position, hand.position);
    EXPECT_EQ(r.proxy.orientation.coeffs(), hand.orientation.coeffs());
}

TEST(ToolProxy, lays_a_box_flat_on_a_plane_and_lets_it_twist) {
    const Field field = plane_field();
    ToolProxy proxy = proxy_of(box_tool({4, 3, 2}, 1));
    update_tool(proxy, field, at(12, 12, 18));
    const Vec3 tilt(0.05, -0.04, 0);
    ToolUpdate r;
    for (int i = 0; i < 50; ++i) {
        const Quaternion hand = turned(turned(Quaternion::Identity(), tilt), {0, 0, 0.01 * i});
        r = update_tool(proxy, field, {{12, 12, 10}, hand});
    }
    EXPECT_EQ(r.status, UpdateStatus::done);
    EXPECT_GE(r.contacts, 3);
    EXPECT_NEAR(r.proxy.position[2], 13, 1e-6) << "half its height above the plane";
    const Vec3 up = r.proxy.orientation * Vec3::UnitZ();
    EXPECT_NEAR(up[2], 1, 1e-9) << "flat";
    const Vec3 along = r.proxy.orientation * Vec3::UnitX();
    EXPECT_NEAR(std::atan2(along[1], along[0]), 0.49, 2e-3) << "turned with the hand";
}

/// A rod whose end lies on an edge: the equilibrium of force and torque in closed form.
TEST(ToolProxy, tilts_a_rod_until_force_and_torque_are_in_equilibrium) {
    const Field field = plane_field();
    const double length = 6, gyration = 4;
    std::vector<Vec3> points;
    for (int i = -12; i <= 12; ++i) points.emplace_back(i * length / 24, 0, 0);
    ToolProxy proxy = proxy_of(Tool(points, gyration));
    update_tool(proxy, field, at(12, 12, 18));
    // Pressed by 1 mm and turned by 0.3 rad: only the end at +x is held.
    const Vec3 turn(0, 0.5, 0);
    const ToolUpdate r = update_tool(proxy, field, {{12, 12, 12}, turned({1, 0, 0, 0}, turn)});
    ASSERT_EQ(r.status, UpdateStatus::done);
    ASSERT_EQ(r.contacts, 1);
    // With depth d of the middle and angle a: k (d) = N, k_r (0.5 - a) = N l/2 cos a, and the end
    // is on the plane: height = l/2 sin a.
    double low = 0, high = 0.5;
    for (int i = 0; i < 100; ++i) {
        const double a = 0.5 * (low + high);
        const double lift = 0.5 * length * std::sin(a);
        const double torque = gyration * gyration * (0.5 - a);
        (torque > lift * 0.5 * length * std::cos(a) ? low : high) = a;
    }
    const Vec3 rotation = rotation_between(Quaternion::Identity(), r.proxy.orientation);
    EXPECT_NEAR(rotation[1], low, 2e-3 * low);
    EXPECT_NEAR(r.proxy.position[2] - 12, 0.5 * length * std::sin(low), 2e-3);
    EXPECT_NEAR(rotation[0], 0, 1e-6);
    EXPECT_NEAR(r.proxy.position[0], 12, 1e-3);
}

TEST(ToolProxy, is_the_point_proxy_for_a_single_point) {
    for (const TestField& test : {support::noise_field(), support::oblique_field()}) {
        const Field field = support::smooth(test.field);
        ToolProxy proxy = proxy_of(point_tool(), test.isovalue);
        Proxy point;
        point.isovalue = test.isovalue;
        Hand hand(field.geometry(), 11,
                  {.slide = 1, .sweep = 0, .jump = 0, .rest = 0, .lattice = 0});
        int same = 0, all = 0;
        for (int i = 0; i < support::scaled(4000); ++i) {
            const Vec3 hip = hand.next();
            const ToolUpdate a = update_tool(proxy, field, {hip, Quaternion::Identity()});
            const ProxyUpdate b = update_exact(point, field, hip);
            if (a.status != UpdateStatus::done || b.status != UpdateStatus::done) continue;
            ++all;
            same += (a.proxy.position - b.scp).norm() < 0.02;
        }
        // If a surface falls in two, both places are right, and stay apart for a while.
        EXPECT_GT(same, 0.75 * all) << test.name;
        EXPECT_GT(all, 0.9 * support::scaled(4000));
    }
}

TEST(ToolProxy, follows_a_level_that_moves_over_it_and_a_start_inside) {
    const Field field = plane_field();
    const Tool box = box_tool({4, 3, 2}, 1);
    ToolProxy inside = proxy_of(box);
    ToolUpdate r;
    int ticks = 0;
    do r = update_tool(inside, field, at(12, 12, 8));
    while (r.status == UpdateStatus::recovering && ++ticks < 200);
    EXPECT_EQ(r.status, UpdateStatus::done);
    EXPECT_NEAR(r.proxy.position[2], 13, 1e-5);

    ToolProxy proxy = proxy_of(box);
    update_tool(proxy, field, at(12, 12, 18));
    for (int i = 0; i < 100; ++i) {
        proxy.isovalue = -0.03 * i;
        ticks = 0;
        do r = update_tool(proxy, field, at(12, 12, 12));
        while (r.status == UpdateStatus::recovering && ++ticks < 20);
        ASSERT_EQ(r.status, UpdateStatus::done) << i;
        ASSERT_NEAR(r.proxy.position[2], 13 + 0.03 * i, 1e-5) << i;
    }
}

TEST(ToolProxy, never_passes_a_thin_wall_at_three_metres_a_second) {
    // A closed shell of 1.5 voxels; the tool is as long as a third of it and starts inside.
    const Field field =
        Field(support::volume_of<float>(support::grid(support::cube(40)), [](const Index3& i) {
            const double r = (i.cast<double>() - Vec3::Constant(19.5)).norm();
            return 1.5 - std::abs(r - 14);
        }));
    ToolProxy proxy = proxy_of(rod_tool(9, 0.25), 0.75);
    ToolGuarantees guarantees(field);
    guarantees.share_checked = 0.2;
    Random random(3);
    update_tool(proxy, field, at(19.5, 19.5, 15));
    Pose hand = at(19.5, 19.5, 15);
    Vec3 way = random.direction(), spin = random.direction();
    const Vec3 middle = Vec3::Constant(19.5);
    for (int i = 0; i < support::scaled_or_asked(1500) && !testing::Test::HasFailure(); ++i) {
        way = (way + 0.2 * random.direction()).normalized();
        if ((hand.position - middle).norm() > 30) way = (middle - hand.position).normalized();
        spin = (spin + 0.3 * random.direction()).normalized();
        hand = {hand.position + 3 * way, turned(hand.orientation, 0.02 * spin)};
        const ToolUpdate r = guarantees.update(proxy, hand);
        for (const Vec3& point : proxy.tool().points()) {
            ASSERT_LT((physical_from_tool(r.proxy, point) - middle).norm(), 13.5) << i;
        }
    }
    guarantees.print("thin wall");
}

TEST(ToolProxy, sticks_slides_and_twists_with_friction) {
    const Field field = plane_field();
    ToolSettings settings;
    settings.friction = {.static_coefficient = 0.6, .dynamic_coefficient = 0.4};
    const Tool box = box_tool({4, 4, 2}, 1);
    const auto press = [&](ToolProxy& proxy, const Pose& hand) {
        return update_tool(proxy, field, hand, settings).proxy;
    };
    ToolProxy proxy = proxy_of(box);
    press(proxy, at(12, 12, 18));
    const double depth = 2;
    const double down = 13 - depth;
    Pose rest;
    for (int i = 0; i < 5; ++i) rest = press(proxy, at(12, 12, down));
    // Below the static coefficient it stays; beyond, it trails at the dynamic one.
    Pose now = press(proxy, at(12 + 0.55 * depth, 12, down));
    EXPECT_NEAR((now.position - rest.position).norm(), 0, 1e-6) << "sticks";
    double x = 12;
    for (int i = 0; i < 40; ++i) {
        x = 13.4 + 0.1 * i;
        now = press(proxy, at(x, 12, down));
        EXPECT_TRUE(proxy.sliding);
        EXPECT_NEAR(x - now.position[0], 0.4 * depth, 2e-3 * depth) << "trails";
    }
    EXPECT_NEAR(now.position[2], 13, 1e-6);
    for (int i = 0; i < 5; ++i) rest = press(proxy, at(x, 12, down));
    EXPECT_FALSE(proxy.sliding) << "stuck where the hand stopped";
    // A small twist is held by the friction of all contacts, a large one turns the box.
    const auto yaw = [](const Pose& pose) {
        return rotation_between(Quaternion::Identity(), pose.orientation)[2];
    };
    now = press(proxy, at(x, 12, down, {0, 0, 0.1}));
    EXPECT_NEAR(yaw(now), yaw(rest), 1e-4);
    for (double turn = 0.1; turn < 1.5; turn += 0.02) {
        now = press(proxy, at(x, 12, down, {0, 0, turn}));
    }
    EXPECT_GT(yaw(now), 0.4);
    EXPECT_LT(yaw(now), 1.4) << "and it trails";
}

TEST(ToolProxy, has_the_friction_of_the_point_proxy_as_a_point) {
    const Field field = plane_field();
    ToolSettings settings;
    settings.friction = {.static_coefficient = 0.5, .dynamic_coefficient = 0.3};
    ProxySettings of_point;
    of_point.friction = settings.friction;
    ToolProxy proxy = proxy_of(point_tool());
    Proxy point;
    Random random(5);
    Vec3 hip(12, 12, 18), way(0.1, 0, 0);
    int sliding = 0;
    for (int i = 0; i < 500; ++i) {
        way = (way + 0.05 * random.direction()).normalized() * 0.1;
        hip += way;
        for (int a = 0; a < 2; ++a) hip[a] = std::min(std::max(hip[a], 4.0), 20.0);
        hip[2] = std::min(std::max(hip[2], 9.0), 12.5);
        const ToolUpdate a = update_tool(proxy, field, {hip, Quaternion::Identity()}, settings);
        const ProxyUpdate b = update_exact(point, field, hip, of_point);
        ASSERT_LT((a.proxy.position - b.scp).norm(), 1e-3) << i;
        ASSERT_EQ(proxy.sliding, point.sliding) << i;
        sliding += proxy.sliding;
    }
    EXPECT_GT(sliding, 50);
}

TEST(ToolProxy, counts_what_half_spaces_and_friction_cost_as_work) {
    const Field field = plane_field();
    const auto work_of = [&](double coefficient) {
        ToolProxy proxy = proxy_of(box_tool({4, 3, 2}, 1));
        ToolUpdate last;
        for (int i = 0; i < 40; ++i) {
            // Tilted, so that the pull goes through no line between two corners: two would hold it.
            const Quaternion turn = turned(Quaternion::Identity(), {0.2, 0.1, 0.01 * i});
            last = update_tool(proxy, field, {{12 + 0.05 * i, 12, i < 1 ? 18.0 : 10.0}, turn},
                               {.friction = {coefficient, coefficient}});
        }
        EXPECT_GE(last.contacts, 3);
        return last.work;
    };
    const int without = work_of(0), with = work_of(0.4);
    EXPECT_GT(with, without + 50) << "sweeps over the contacts";
}

TEST(ToolProxy, feels_the_other_side_and_other_samples_at_once) {
    Field field = plane_field();
    ToolProxy proxy = proxy_of(box_tool({4, 3, 2}, 1));
    update_tool(proxy, field, at(12, 12, 18));
    EXPECT_EQ(update_tool(proxy, field, at(12, 12, 11)).contacts > 0, true);
    // The plane jumps up by four voxels: the box follows, and falls again when it goes back.
    for (const double height : {16.0, 9.0}) {
        field = plane_field(height);
        ToolUpdate r;
        int ticks = 0;
        do r = update_tool(proxy, field, at(12, 12, 8));
        while (r.status != UpdateStatus::done && ++ticks < 50);
        ASSERT_EQ(r.status, UpdateStatus::done);
        EXPECT_NEAR(r.proxy.position[2], height + 1, 1e-5);
    }
    // Free space is solid now.
    const Field below(field.shared_samples(), Solid::below, std::nullopt, Interpolation::cubic);
    ToolUpdate r;
    int ticks = 0;
    do r = update_tool(proxy, below, at(12, 12, 13));
    while (r.status != UpdateStatus::done && ++ticks < 500);
    ASSERT_EQ(r.status, UpdateStatus::done);
    EXPECT_NEAR(r.proxy.position[2], 8, 1e-5);
}

TEST(ToolProxy, makes_a_hand_unit_that_is_nearly_so) {
    const Field field = plane_field();
    ToolProxy proxy = proxy_of(box_tool({4, 3, 2}, 1));
    Pose hand = at(12, 12, 18, {0.3, 0.2, 0.1});
    hand.orientation.coeffs() *= 1 + 3e-7;
    const ToolUpdate r = update_tool(proxy, field, hand);
    EXPECT_EQ(r.status, UpdateStatus::done);
    EXPECT_NEAR(r.proxy.orientation.norm(), 1, 1e-15);
}

TEST(ToolProxy, refuses_what_it_cannot_follow) {
    const Field cubic = plane_field();
    Field linear = cubic;
    linear.set_interpolation(Interpolation::linear);
    ToolProxy proxy = proxy_of(rod_tool(3, 1));
    const ToolUpdate first = update_tool(proxy, cubic, at(12, 12, 18));
    const double nan = std::nan("");
    Pose bad = at(12, 12, 18);
    bad.orientation.coeffs() *= 1.1;
    EXPECT_EQ(update_tool(proxy, linear, at(12, 12, 18)).status, UpdateStatus::refused);
    EXPECT_EQ(update_tool(proxy, cubic, at(nan, 12, 18)).status, UpdateStatus::refused);
    EXPECT_EQ(update_tool(proxy, cubic, at(12, 3e5, 18)).status, UpdateStatus::refused);
    EXPECT_EQ(update_tool(proxy, cubic, bad).status, UpdateStatus::refused);
    for (const double gyration : {nan, -1.0, 1e-300, 1e300, HUGE_VAL}) {
        EXPECT_EQ(update_tool(proxy, cubic, at(12, 12, 18), {.gyration = gyration}).status,
                  UpdateStatus::refused);
    }
    for (const Friction& friction :
         {Friction{-0.1, 0}, Friction{0.3, -0.1}, Friction{nan, 0}, Friction{0.3, nan}}) {
        EXPECT_EQ(update_tool(proxy, cubic, at(12, 12, 18), {.friction = friction}).status,
                  UpdateStatus::refused);
    }
    EXPECT_EQ(proxy.pose.position, first.proxy.position);
}

TEST(ToolProxy, neither_allocates_nor_differs_in_a_copy) {
    const Field field = support::smooth(support::noise_field().field);
    ToolProxy proxy = proxy_of(box_tool({3, 2, 2}, 0.5), 150);
    TurningHand hand(field.geometry(), 9);
    for (int i = 0; i < 50; ++i) update_tool(proxy, field, hand.next());
    ToolProxy copy = proxy;
    std::vector<Pose> way;
    for (int i = 0; i < support::scaled(400); ++i) way.push_back(hand.next());
    std::vector<Pose> first, second;
    first.reserve(way.size());
    const auto before = support::thread_allocation_count();
    for (const Pose& pose : way) first.push_back(update_tool(proxy, field, pose).proxy);
    EXPECT_EQ(support::thread_allocation_count(), before);
    for (const Pose& pose : way) second.push_back(update_tool(copy, field, pose).proxy);
    for (std::size_t i = 0; i < way.size(); ++i) {
        ASSERT_EQ(first[i].position, second[i].position) << i;
        ASSERT_EQ(first[i].orientation.coeffs(), second[i].orientation.coeffs()) << i;
    }
}

TEST(Tool, refuses_what_is_no_tool) {
    EXPECT_THROW(Tool(std::vector<Vec3>()), std::invalid_argument);
    EXPECT_THROW(Tool({{0, std::nan(""), 0}}), std::invalid_argument);
    EXPECT_THROW(Tool({{1, 0, 0}}, 0.0), std::invalid_argument);
    EXPECT_THROW(sphere_tool(-1, 1), std::invalid_argument);
    EXPECT_THROW(sphere_tool(1000, 0.1), std::invalid_argument);
    EXPECT_THROW(rod_tool(1, 0), std::invalid_argument);
    EXPECT_THROW(box_tool({1000, 1000, 1}, 0.5), std::invalid_argument);
}

TEST(Tool, names_the_number_of_points_however_many_they_would_be) {
    const auto expect_number = [](auto&& make) {
        try {
            make();
            ADD_FAILURE() << "not refused";
        } catch (const std::invalid_argument& e) {
            EXPECT_TRUE(std::string(e.what()).starts_with("a tool has at most 20000 points"));
        }
    };
    for (const double spacing : {1.0, 0.1, 0.01, 1e-6}) {
        expect_number([=] { sphere_tool(200, spacing); });
        expect_number([=] { rod_tool(30'000, spacing); });
        expect_number([=] { box_tool(Vec3::Constant(190), spacing); });
        expect_number([=] { needle_tool(20'000, 1, spacing); });
        expect_number([=] { burr_tool(200, spacing); });
    }
}

TEST(Tool, has_points_no_farther_apart_than_asked) {
    const auto widest = [](const Tool& tool, const Vec3& on_surface) {
        double least = 1e9;
        for (const Vec3& point : tool.points()) {
            least = std::min(least, (point - on_surface).norm());
        }
        return least;
    };
    Random random(1);
    const Tool ball = sphere_tool(3, 0.5), box = box_tool({4, 3, 2}, 0.5);
    for (int i = 0; i < 2000; ++i) {
        const Vec3 d = random.direction();
        EXPECT_LT(widest(ball, 3 * d), 0.5);
        const Vec3 half(2, 1.5, 1);
        EXPECT_LT(widest(box, d / d.cwiseQuotient(half).cwiseAbs().maxCoeff()), 0.36);
    }
    EXPECT_EQ(point_tool().points().size(), 1U);
    EXPECT_FALSE(point_tool().turns());
    EXPECT_EQ(rod_tool(3, 1).points().size(), 4U);
}

}  // namespace
}  // namespace palpate
