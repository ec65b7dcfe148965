// Session: input that counts, freeze, clutch, scale, dead-man switch, commands.
#include "palpate/session.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <string>
#include <vector>

#include "palpate/scenes/volumes.hpp"
#include "support/allocation_counter.hpp"
#include "support/constants.hpp"
#include "support/press.hpp"

using namespace palpate;
using namespace palpate::support;

namespace {

/// A session on the ramp (density = z), level 30, and the hand that is fed to it. Device and
/// physical space start out the same.
struct Live {
    Session session;
    double time = 0;
    DeviceReading reading;
    SessionTick last{};

    explicit Live(const RendererSettings& settings = {}, const SessionSettings& safety = {})
        : session{make_renderer(ramp_field(), 30, settings), safety} {
        reading.status = DeviceStatus::ready;
        reading.position = at_depth(29);
    }
    const SessionTick& next() { return last = advance(session, time += period, reading); }
    const SessionTick& next(const Vec3& position) {
        reading.position = position;
        return next();
    }
    /// Rests at a depth until the force has ramped up.
    void rest_at(double depth) {
        for (double z = std::min(29.0, depth); z < depth; z += 0.05) next(at_depth(z));
        for (int i = 0; i < 400; ++i) next(at_depth(depth));
    }
    double force() const { return last.tick.force.norm(); }
    const ProxyUpdate& proxy() const { return last.tick.proxy; }
};

TEST(Session, renders_what_the_renderer_renders) {
    Live live;
    Renderer renderer = make_renderer(ramp_field(), 30);
    double time = 0;
    for (double z = 28; z < 33; z += 0.01) {
        live.next(at_depth(z));
        const Tick tick = render(renderer, {time += period, at_depth(z)});
        ASSERT_EQ(live.last.tick.force, tick.force);
        ASSERT_EQ(live.proxy().scp, tick.proxy.scp);
    }
    EXPECT_GT(live.force(), 1);
}

TEST(Session, a_hand_that_is_lifted_leaves_a_closed_shell_with_a_point_and_with_a_tool) {
    const scenes::Scene shell = scenes::make_volume("shell:32x32x32");
    for (const bool ball : {false, true}) {
        RendererSettings settings;
        if (ball) settings.tool = std::make_shared<const Tool>(sphere_tool(1, 0.5));
        const Field field(shell.volume, Solid::above, {}, Interpolation::cubic);
        Session session{make_renderer(field, shell.isovalue, settings), {}};
        DeviceReading hand;
        hand.status = DeviceStatus::ready;
        double time = 0;
        const auto next = [&] { return advance(session, time += period, hand); };
        SessionTick last = next();
        for (double x = 0; x < 30; x += 0.1) {
            hand.position = {x, 0, 0};
            last = next();
        }
        EXPECT_EQ(last.tick.proxy.mode, Mode::constrained);
        EXPECT_GT((last.tick.proxy.hip - last.tick.proxy.scp).norm(), 5) << "it is caught inside";
        apply(session, command::Lift{});
        last = next();
        EXPECT_EQ(last.tick.proxy.mode, Mode::free);
        EXPECT_EQ(last.tick.proxy.scp, last.tick.proxy.hip);
        for (int i = 0; i < 100; ++i) last = next();
        EXPECT_EQ(last.tick.force, Vec3::Zero()) << "it falls within its rate limit";
        for (double x = 30; x > 5; x -= 0.1) {
            hand.position = {x, 0, 0};
            last = next();
        }
        EXPECT_GT(last.tick.proxy.scp[0], 8) << "and held outside";
        EXPECT_GT(last.tick.force[0], 0);
    }
}

TEST(Session, input_that_is_not_good_gives_no_force_and_leaves_the_proxy) {
    const auto broken = [](auto&& change) {
        Live live;
        live.rest_at(31);
        EXPECT_GT(live.force(), 0.4);
        const Vec3 scp = live.proxy().scp;
        change(live.reading);
        live.next();
        EXPECT_EQ(live.last.tick.force, Vec3(0, 0, 0));
        EXPECT_NE(live.last.tick.force_flags & force_stale, 0);
        EXPECT_EQ(live.proxy().scp, scp);
        EXPECT_EQ(live.proxy().status, UpdateStatus::refused);
    };
    for (const DeviceStatus status :
         {DeviceStatus::starting, DeviceStatus::uncalibrated, DeviceStatus::stale,
          DeviceStatus::lost, DeviceStatus::fault, DeviceStatus::finished}) {
        broken([&](DeviceReading& r) { r.status = status; });
    }
    broken([](DeviceReading& r) { r.age = 0.0201; });
    broken([](DeviceReading& r) { r.age = not_a_number; });
    broken([](DeviceReading& r) { r.age = -1e-9; });
    broken([](DeviceReading& r) { r.age = -infinity; });
    broken([](DeviceReading& r) { r.age = infinity; });
    broken([](DeviceReading& r) { r.position[1] = not_a_number; });
    broken([](DeviceReading& r) { r.position[2] = infinity; });
    broken([](DeviceReading& r) { r.position[0] = 1.1e4; });
    broken([](DeviceReading& r) { r.position[2] += 10.1; });  // 10.1 mm in a millisecond
}

TEST(Session, only_finite_ages_from_0_count_even_where_none_is_too_old) {
    for (const double age : {-1e-9, -infinity, infinity, not_a_number, 0.0, 1e9}) {
        Live live;
        live.session.renderer.settings.force.stale_after = infinity;
        live.rest_at(31);
        live.reading.age = age;
        live.next();
        EXPECT_EQ(live.force() > 0.4, age >= 0 && age < infinity) << age;
    }
}

TEST(Session, a_tick_whose_time_is_not_finite_has_no_force_and_the_hand_counts_again_afterwards) {
    for (const double time : {infinity, -infinity, not_a_number}) {
        for (const bool begun : {false, true}) {
            Live live;
            if (begun) live.rest_at(31);
            EXPECT_EQ(advance(live.session, time, live.reading).tick.force, Vec3(0, 0, 0));
            live.rest_at(31);
            EXPECT_GT(live.force(), 0.4) << time;
        }
    }
}

TEST(Session, a_place_that_was_too_far_counts_once_the_hand_could_have_come_there) {
    Live live;
    live.rest_at(28);
    const Vec3 far = at_depth(28) - Vec3(0, 0, 55);
    int refused = 0;
    while (live.next(far).tick.proxy.status == UpdateStatus::refused) ++refused;
    EXPECT_GE(refused, 4);  // 55 mm at 10 m/s
    EXPECT_LE(refused, 6);
    EXPECT_EQ(live.proxy().hip, far);
}

TEST(Session, after_broken_input_the_force_comes_back_by_the_ramp) {
    Live live;
    live.rest_at(31);
    const double before = live.force();
    live.reading.status = DeviceStatus::lost;
    live.next();
    live.reading.status = DeviceStatus::ready;
    live.next();
    EXPECT_LT(live.force(), 0.01 * before);
    live.rest_at(31);
    EXPECT_DOUBLE_EQ(live.force(), before);
}

TEST(Session, a_dead_man_switch_gives_force_only_while_it_is_held) {
    Live live({}, {.deadman_buttons = 2});
    live.rest_at(31);
    EXPECT_EQ(live.force(), 0);
    EXPECT_NE(live.last.tick.force_flags & force_off, 0);
    live.reading.buttons = 1;  // another one
    live.next();
    EXPECT_EQ(live.force(), 0);
    live.reading.buttons = 3;
    live.rest_at(31);
    EXPECT_NEAR(live.force(), 0.5, 1e-9);
    live.reading.buttons = 0;
    live.next();
    EXPECT_EQ(live.force(), 0);
}

TEST(Session, frozen_hand_and_proxy_stand_still_and_the_force_is_let_go_within_its_rate) {
    RendererSettings settings;
    settings.force.rate_limit = 50;  // 0.05 N a tick
    Live live(settings);
    live.rest_at(31);
    const ProxyUpdate before = live.proxy();
    double force = live.force();
    apply(live.session, command::Freeze{true});
    for (int i = 0; i < 30; ++i) {
        live.next(at_depth(31) + Vec3(0.01 * i, 0, 0.05 * i));
        EXPECT_TRUE(live.last.frozen);
        EXPECT_EQ(live.proxy().hip, before.hip);
        EXPECT_EQ(live.proxy().scp, before.scp);
        EXPECT_LE(force - live.force(), 0.05 + 1e-12);
        force = live.force();
    }
    EXPECT_EQ(force, 0);
}

TEST(Session, a_hand_that_is_deep_inside_when_it_is_unfrozen_is_not_thrown_out) {
    RendererSettings settings;
    settings.force.start_below = 0.3;
    Live live(settings);
    live.rest_at(30.5);
    apply(live.session, command::Freeze{true});
    for (double z = 30.5; z < 34; z += 0.05) live.next(at_depth(z));
    apply(live.session, command::Freeze{false});
    for (int i = 0; i < 300; ++i) {
        live.next(at_depth(34));
        ASSERT_EQ(live.force(), 0);
        ASSERT_NE(live.last.tick.force_flags & force_waiting, 0);
    }
    EXPECT_NEAR(live.proxy().scp[2], 30, 1e-9);  // and the surface was not passed
    for (double z = 34; z > 30.4; z -= 0.05) live.next(at_depth(z));
    live.rest_at(32);
    EXPECT_NEAR(live.force(), 1, 1e-9);
}

TEST(Session, freezing_what_is_frozen_moves_nothing) {
    Live live;
    live.rest_at(29);
    apply(live.session, command::Freeze{true});
    for (int i = 0; i < 20; ++i) live.next(at_depth(29) + Vec3(0.1 * i, 0, 0));
    apply(live.session, command::Freeze{true});
    live.next();
    EXPECT_EQ(live.proxy().hip, at_depth(29));
}

TEST(Session, freezing_before_the_first_position_holds_the_first_position) {
    Live live;
    apply(live.session, command::Freeze{true});
    live.next(at_depth(20));
    live.next(at_depth(21));
    EXPECT_EQ(live.proxy().hip, at_depth(20));
}

TEST(Session, the_volume_hangs_on_the_hand_while_the_clutch_is_closed) {
    for (const bool by_button : {true, false}) {
        Live live({}, {.clutch_buttons = 4});
        live.rest_at(31);
        const ProxyUpdate before = live.proxy();
        if (by_button) {
            live.reading.buttons = 4;
        } else {
            apply(live.session, command::Clutch{true});
        }
        for (int i = 0; i < 100; ++i) {
            live.next(at_depth(31) + Vec3(0.3 * i, -0.2 * i, 0.1 * i));
            ASSERT_TRUE(live.last.clutched);
            ASSERT_LT((live.proxy().hip - before.hip).norm(), 1e-9);
            ASSERT_LT((live.proxy().scp - before.scp).norm(), 1e-9);
        }
        EXPECT_EQ(live.force(), 0);
        live.reading.buttons = 0;
        apply(live.session, command::Clutch{false});
        live.next();
        EXPECT_FALSE(live.last.clutched);
        EXPECT_LT((live.proxy().hip - before.hip).norm(), 1e-9);
        EXPECT_LT(live.force(), 0.01);  // comes back by the ramp
        for (int i = 0; i < 400; ++i) live.next();
        EXPECT_NEAR(live.force(), 0.5, 1e-9);
    }
}

TEST(Session, the_clutch_turns_the_volume_with_the_tool) {
    Live live;
    const Mat3 start = Eigen::AngleAxisd(0.3, Vec3(1, 2, 3).normalized()).toRotationMatrix();
    live.reading.orientation = start;
    live.rest_at(29);
    const Vec3 hip = live.proxy().hip;
    const Mat3 tool = live.last.transform.rotation * live.reading.orientation;
    apply(live.session, command::Clutch{true});
    for (int i = 0; i < 50; ++i) {
        live.reading.orientation =
            Eigen::AngleAxisd(0.02 * i, Vec3(-1, 0.4, 2).normalized()).toRotationMatrix() * start;
        live.next(at_depth(29) + Vec3(0.1 * i, 0, 0));
        ASSERT_LT((live.proxy().hip - hip).norm(), 1e-9);
        ASSERT_LT((live.last.transform.rotation * live.reading.orientation - tool).norm(), 1e-9);
    }
    // An orientation that is broken for a moment turns nothing.
    const Mat3 before = live.last.transform.rotation;
    for (const double broken : {not_a_number, 0.0}) {
        live.reading.orientation = Mat3::Constant(broken);
        live.next();
        EXPECT_EQ(live.last.transform.rotation, before);
    }
}

TEST(Session, another_scale_changes_neither_proxy_nor_force) {
    Live live;
    live.rest_at(31.4);
    const ProxyUpdate before = live.proxy();
    const Vec3 force = live.last.tick.force;
    for (const double scale : {0.5, 2.0, 7.3, 1.0}) {
        apply(live.session, command::Scale{scale});
        live.next();
        EXPECT_EQ(live.last.transform.scale, scale);
        EXPECT_LT((live.proxy().scp - before.scp).norm(), 1e-9);
        EXPECT_LT((live.last.tick.force - force).norm(), 1e-9);
    }
}

TEST(Session, a_new_transform_lets_go_and_starts_anew) {
    Live live;
    live.rest_at(31);
    DeviceTransform moved;
    moved.translation = Vec3(0, 0, 1);
    apply(live.session, moved);
    live.next();
    EXPECT_EQ(live.proxy().hip, at_depth(32));
    EXPECT_LT(live.force(), 0.5);
    for (int i = 0; i < 400; ++i) live.next();
    EXPECT_NEAR(live.force(), 1, 1e-9);
}

TEST(Session, commands_take_effect_in_the_next_tick) {
    Live live;
    live.rest_at(31);
    apply(live.session, command::Isovalue{30.5});
    live.next();
    EXPECT_EQ(live.proxy().isovalue, 30.5);
    ForceSettings force;
    force.stiffness = 1;
    apply(live.session, force);
    for (int i = 0; i < 400; ++i) live.next();
    EXPECT_NEAR(live.force(), 0.5, 1e-9);
    apply(live.session, command::Forces{false});
    live.next();
    EXPECT_EQ(live.force(), 0);
    apply(live.session, command::Forces{true});
    apply(live.session, penetrability_threshold(0.2, 0));
    for (int i = 0; i < 400; ++i) live.next();
    EXPECT_NEAR(live.force(), 0.2, 1e-9);  // given way down to PT
    apply(live.session, Friction{0.5, 0.4});
    EXPECT_EQ(live.session.renderer.settings.proxy.friction.static_coefficient, 0.5);
}

TEST(Session, commands_that_cannot_be_carried_out_are_refused_with_a_reason) {
    const RendererSettings settings;
    const auto refused = [&](const Command& command) {
        EXPECT_THROW(check(command, settings, kind_of(ramp_field())), std::invalid_argument);
    };
    refused(command::Isovalue{not_a_number});
    refused(command::Scale{0});
    refused(command::Scale{infinity});
    ForceSettings force;
    force.stiffness = 50;
    refused(force);
    refused(Friction{0.1, 0.5});
    DeviceTransform sheared;
    sheared.rotation(0, 1) = 0.5;
    refused(sheared);
    Penetrability none = penetrability_threshold(1, 0);
    none.range_count = 0;
    refused(none);
    EXPECT_NO_THROW(check(command::Freeze{true}, settings, kind_of(ramp_field())));
    EXPECT_THROW(check(SessionSettings{.fastest_hand = 0}), std::invalid_argument);
    EXPECT_THROW(check(SessionSettings{.overrun = not_a_number}), std::invalid_argument);
}

TEST(Session, a_tick_that_came_too_late_has_no_force_and_the_next_starts_anew) {
    Live live;
    live.rest_at(31);
    live.next();
    drop_force(live.session, live.last);
    EXPECT_EQ(live.last.tick.force, Vec3(0, 0, 0));
    EXPECT_NE(live.last.tick.force_flags & force_overrun, 0);
    live.next();
    EXPECT_LT(live.force(), 0.01);
}

/// Random input: readings good and bad, buttons, all kinds of commands.
struct RandomInput {
    Random random;
    Vec3 hand = at_depth(28);
    std::int64_t good = 0, bad = 0, commands = 0;
    Penetrability threshold = penetrability_threshold(1, 0), none = no_penetrability();

    void step(Live& live) {
        hand += 0.2 * random.direction();
        hand = hand.cwiseMax(Vec3(0, 0, 20)).cwiseMin(Vec3(8, 8, 45));
        live.reading.position = hand;
        live.reading.buttons =
            random.below(8) == 0 ? static_cast<std::uint32_t>(random.below(4)) : 0;
        const bool breaks = random.below(50) == 0;
        if (breaks) live.reading.position[0] = random.below(2) ? not_a_number : 1e5;
        (breaks ? bad : good) += 1;
        if (random.below(40) != 0) return;
        ++commands;
        switch (random.below(7)) {
            case 0:
                apply(live.session, command::Isovalue{random.uniform(25, 40)});
                break;
            case 1:
                apply(live.session, command::Freeze{random.below(2) == 0});
                break;
            case 2:
                apply(live.session, command::Clutch{random.below(2) == 0});
                break;
            case 3:
                apply(live.session, command::Scale{random.uniform(0.5, 2)});
                break;
            case 4:
                apply(live.session, command::Forces{random.below(3) != 0});
                break;
            case 5:
                apply(live.session, random.below(2) ? threshold : none);
                break;
            default:
                apply(live.session, DeviceTransform{});
                break;
        }
    }
};

TEST(Session, forces_stay_within_limit_and_rate_on_random_input) {
    Live live({}, {.clutch_buttons = 1, .deadman_buttons = 0});
    RandomInput input{Random(11)};
    Vec3 last = Vec3::Zero();
    std::int64_t felt = 0;
    for (int i = 0; i < 100'000; ++i) {
        input.step(live);
        live.next();
        const Vec3& force = live.last.tick.force;
        ASSERT_TRUE(force.allFinite());
        ASSERT_LE(force.norm(), 3.3 + 1e-12);
        const double change = force.isZero(0) ? 0 : (force - last).norm();
        ASSERT_LE(change, 2 + 1e-9);
        last = force;
        felt += !force.isZero(0);
    }
    EXPECT_GT(felt, 5'000);
    EXPECT_GT(input.bad, 500);
    EXPECT_GT(input.commands, 1000);
}

TEST(Session, copies_go_on_alike_bit_for_bit) {
    Live one({}, {.clutch_buttons = 1, .deadman_buttons = 0});
    RandomInput first{Random(5)};
    for (int i = 0; i < 2000; ++i) {
        first.step(one);
        one.next();
    }
    Live two = one;
    RandomInput second = first;
    for (int i = 0; i < 5000; ++i) {
        first.step(one);
        second.step(two);
        one.next();
        two.next();
        ASSERT_EQ(one.last.tick.force, two.last.tick.force);
        ASSERT_EQ(one.proxy().scp, two.proxy().scp);
        ASSERT_EQ(one.last.transform.translation, two.last.transform.translation);
    }
}

TEST(Session, neither_ticks_nor_commands_allocate) {
    Live live({}, {.clutch_buttons = 1, .deadman_buttons = 0});
    RandomInput input{Random(7)};
    input.step(live);
    live.next();
    const std::int64_t before = allocation_count();
    for (int i = 0; i < 20'000; ++i) {
        input.step(live);
        live.next();
    }
    EXPECT_EQ(allocation_count(), before);
}

TEST(Session, to_record_it_changes_nothing_of_a_hand_that_starts_inside) {
    Live live;
    live.session.renderer.starts_inside = true;
    SessionPoint point;
    checkpoint(live.session, point);
    EXPECT_TRUE(live.session.renderer.starts_inside);
    Live again;
    apply(again.session, command::Resume{std::make_shared<const SessionPoint>(point)});
    EXPECT_TRUE(again.session.renderer.starts_inside);
}

}  // namespace
