// A session with a tool: poses go in, the wrench of the contacts comes out, within limits.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstring>
#include <vector>

#include "palpate/servo.hpp"
#include "support/allocation_counter.hpp"
#include "support/constants.hpp"
#include "support/fields.hpp"
#include "support/press.hpp"

using namespace palpate;
using namespace palpate::support;

namespace {

std::shared_ptr<const Tool> one_arm(const Vec3& arm) {
    return std::make_shared<const Tool>(std::vector<Vec3>{arm}, 5.0);
}

RendererSettings settings_with(std::shared_ptr<const Tool> tool) {
    RendererSettings settings = at_once();
    settings.tool = std::move(tool);
    settings.force.torque_rate_limit = infinity;
    settings.device.maximum_force = settings.force.limit = 100;
    settings.device.maximum_torque = 1000;
    return settings;
}

/// A session on the smooth ramp (density = z, in device mm at first), level 30.
struct FeltLive {
    Session session;
    double time = 0;
    DeviceReading reading;
    SessionTick last{};

    explicit FeltLive(const RendererSettings& settings, const SessionSettings& safety = {})
        : session{make_renderer(smooth(ramp_field()), 30, settings), safety} {
        reading.status = DeviceStatus::ready;
        reading.position = at_depth(20);
    }
    const Tick& next() { return (last = advance(session, time += period, reading)).tick; }
    const Tick& rest_at(double depth, int ticks = 200) {
        for (double z = reading.position[2]; z < depth; z += 0.1) {
            reading.position = at_depth(z);
            next();
        }
        reading.position = at_depth(depth);
        for (int i = 0; i < ticks; ++i) next();
        return last.tick;
    }
};

TEST(ToolSession, one_contact_gives_its_force_and_the_torque_of_its_lever) {
    FeltLive live(settings_with(one_arm({3, 0, 1})));
    const Tick& tick = live.rest_at(31);
    EXPECT_EQ(tick.tool.contacts, 1);
    EXPECT_EQ(tick.proxy.mode, Mode::constrained);
    EXPECT_GT(tick.force.norm(), 0.2);
    EXPECT_NEAR(tick.force.head<2>().norm(), 0, 1e-3 * tick.force.norm()) << "no friction";
    EXPECT_LT(tick.force[2], 0);
    const Vec3 lever = tick.tool.proxy * Vec3(3, 0, 1);
    EXPECT_NEAR((tick.torque - lever.cross(tick.force)).norm(), 0, 2e-3 * tick.torque.norm());
    EXPECT_NEAR(tick.proxy.scp[2] + lever[2], 30, 1e-6);
}

TEST(ToolSession, wrench_is_in_device_axes_and_the_tool_is_scaled_with_the_hand) {
    RendererSettings settings = settings_with(one_arm({3, 0, 1}));
    const Mat3 rotation = oblique_direction();
    settings.transform.rotation = rotation;
    settings.transform.scale = 2;  // 2 mm of the volume are 1 mm of the hand
    FeltLive live(settings);
    const Mat3 upright = rotation.transpose();  // the tool stands in the volume as it is
    live.reading.orientation = upright;
    for (double z = 20; z < 31.5; z += 0.1) {
        live.reading.position = device_from_physical(settings.transform, at_depth(z));
        live.next();
    }
    for (int i = 0; i < 200; ++i) live.next();
    const Tick& tick = live.last.tick;
    EXPECT_EQ(tick.tool.contacts, 1);
    const Vec3 force = rotation * tick.force;  // physical axes
    EXPECT_LT(force[2], -0.1);
    EXPECT_NEAR(force.head<2>().norm(), 0, 1e-3 * force.norm());
    const Vec3 lever = tick.tool.proxy * Vec3(3, 0, 1) / 2;  // mm of the hand
    EXPECT_NEAR((rotation * tick.torque - lever.cross(force)).norm(), 0, 2e-3 * tick.torque.norm());
}

TEST(ToolSession, a_point_tool_feels_what_the_point_feels) {
    const TestField test = noise_field();
    RendererSettings settings = at_once();
    Renderer point = make_renderer(smooth(test.field), test.isovalue, settings);
    settings.tool = std::make_shared<const Tool>(point_tool());
    Renderer tool = make_renderer(smooth(test.field), test.isovalue, settings);
    int together = 0, constrained = 0;
    for (int i = 0; i < 4000; ++i) {
        const Vec3 hand = Vec3::Constant(12) +
                          13 * Vec3(std::sin(0.011 * i), std::sin(0.017 * i), std::cos(0.013 * i));
        const Tick a = render(point, {i * period, hand});
        const Tick b = render(tool, {i * period, hand});
        constrained += a.proxy.mode == Mode::constrained;
        // If two places are equally good, either may be found.
        together += (a.proxy.scp - b.proxy.scp).norm() < 1e-3;
        if (a.proxy.mode == Mode::free && b.proxy.mode == Mode::free) {
            EXPECT_EQ(b.proxy.scp, hand);
        }
    }
    EXPECT_GT(constrained, 1000);
    EXPECT_GT(together, 3600);
}

TEST(ToolSession, a_point_tool_follows_levels_edits_and_friction_as_the_point_does) {
    RendererSettings settings = at_once();
    settings.proxy.friction = {0.3, 0.3};
    const Field field = smooth(ramp_field());
    Session point{make_renderer(field, 30, settings), {}};
    settings.tool = std::make_shared<const Tool>(point_tool());
    Session tool{make_renderer(field, 30, settings), {}};
    Random random(7);
    auto samples = field.shared_samples();
    int constrained = 0;
    for (int i = 0; i < 6000; ++i) {
        std::optional<Command> command;
        if (i % 500 == 250) command = command::Isovalue{random.uniform(24, 33)};
        if (i % 700 == 350) {
            const Vec3 scp = point.renderer.proxy.scp_physical;
            const Brush brush{.kind = BrushKind::carve, .radius = 4, .level = 30, .value = 0};
            samples = edited(samples, edit::Stroke{brush, scp, scp}).samples;
            command = command::Samples{samples, std::uint64_t(i)};
        }
        for (Session* session : {&point, &tool}) {
            if (command) palpate::apply(*session, *command);
        }
        DeviceReading reading;
        reading.status = DeviceStatus::ready;
        reading.position = at_depth(31 + 6 * std::sin(0.004 * i));
        reading.position[0] += 3 * std::sin(0.003 * i);
        const SessionTick a = advance(point, i * period, reading);
        const SessionTick b = advance(tool, i * period, reading);
        constrained += a.tick.proxy.mode == Mode::constrained;
        ASSERT_NEAR((a.tick.proxy.scp - b.tick.proxy.scp).norm(), 0, 1e-3) << i;
        ASSERT_NEAR((a.tick.force - b.tick.force).norm(), 0, 1e-3) << i;
    }
    EXPECT_GT(constrained, 500);
}

TEST(ToolSession, force_and_torque_stay_within_the_device_and_stop_together) {
    RendererSettings settings = settings_with(one_arm({3, 0, 1}));
    settings.device.maximum_force = 0.5;
    settings.device.maximum_torque = 0.7;
    SessionSettings safety;
    safety.deadman_buttons = 1;
    FeltLive live(settings, safety);
    live.reading.buttons = 1;
    live.rest_at(36);
    // One factor lowers both: as much as if all the energy were in one of the springs.
    const Tick& tick = live.last.tick;
    const double turning =
        rotational_stiffness(settings.force, settings.device, settings.tool->gyration());
    const double gyration = std::sqrt(turning / settings.force.stiffness);
    const double force = std::hypot(tick.force.norm(), tick.torque.norm() / gyration);
    EXPECT_NEAR(std::max(force / 0.5, force * gyration / 0.7), 1, 1e-9);
    const Vec3 turn = rotation_between(tick.tool.hand, tick.tool.proxy);
    EXPECT_NEAR(tick.torque.norm() / tick.force.norm(),
                gyration * gyration * turn.norm() / (tick.proxy.scp - tick.proxy.hip).norm(), 1e-9);
    EXPECT_TRUE(tick.force_flags & force_limited);

    const auto expect_stop = [&](const char* why, auto&& change) {
        FeltLive broken = live;
        change(broken);
        const Tick& tick = broken.next();
        EXPECT_TRUE(tick.force.isZero(0) && tick.torque.isZero(0)) << why;
    };
    expect_stop("stale", [](FeltLive& l) { l.reading.age = 1; });
    expect_stop("lost", [](FeltLive& l) { l.reading.status = DeviceStatus::lost; });
    expect_stop("dead-man", [](FeltLive& l) { l.reading.buttons = 0; });
    expect_stop("off", [](FeltLive& l) { apply(l.session, command::Forces{false}); });
    drop_force(live.session, live.last);
    EXPECT_TRUE(live.last.tick.torque.isZero(0));
}

TEST(ToolSession, a_device_without_torque_gets_the_force_alone) {
    RendererSettings settings = settings_with(one_arm({3, 0, 1}));
    settings.device.maximum_torque = 0;
    FeltLive live(settings);
    const Tick& tick = live.rest_at(31);
    EXPECT_TRUE(tick.torque.isZero(0));
    EXPECT_FALSE(tick.force_flags & force_limited) << "nothing that it could give was cut";
    EXPECT_GT(tick.force.norm(), 0.2);
}

TEST(ToolSession, a_soft_rotation_is_still_the_equilibrium_of_what_is_rendered) {
    RendererSettings settings = settings_with(one_arm({3, 0, 1}));
    settings.device.physical_rotational_damping = 1e-3;  // at most 2 N mm/rad
    FeltLive live(settings);
    const Tick& tick = live.rest_at(31);
    const Vec3 lever = tick.tool.proxy * Vec3(3, 0, 1);
    const Vec3 turn = rotation_between(tick.tool.hand, tick.tool.proxy);
    EXPECT_NEAR(tick.torque.norm(), 2 * turn.norm(), 1e-6);
    EXPECT_NEAR((tick.torque - lever.cross(tick.force)).norm(), 0, 2e-3 * tick.torque.norm());
}

TEST(ToolSession, ramp_and_rate_limit_hold_for_torque_as_for_force) {
    RendererSettings settings = settings_with(one_arm({3, 0, 1}));
    settings.force.ramp = 0.1;
    settings.force.torque_rate_limit = 50;
    FeltLive live(settings);
    Vec3 before = Vec3::Zero();
    for (int i = 0; i < 3000; ++i) {
        live.reading.position = at_depth(i < 100 ? 25 : 30 + 0.02 * (i % 97));
        live.reading.orientation =
            turned(Quaternion::Identity(), {0, 0.3 * std::sin(0.1 * i), 0}).toRotationMatrix();
        const Tick& tick = live.next();
        ASSERT_LE((tick.torque - before).norm(), 50 * period * (1 + 1e-6)) << i;
        before = tick.torque;
    }
    EXPECT_GT(before.norm(), 0);
}

TEST(ToolSession, an_orientation_that_is_no_rotation_is_ignored_and_freeze_holds_it) {
    FeltLive live(settings_with(one_arm({3, 0, 1})));
    const Mat3 good = turned(Quaternion::Identity(), {0.1, 0.2, 0.3}).toRotationMatrix();
    live.reading.orientation = good;
    live.next();
    const Quaternion seen = live.last.tick.tool.hand;
    EXPECT_TRUE(seen.toRotationMatrix().isApprox(good, 1e-12));
    for (const Mat3& bad : {Mat3(Mat3::Zero()), Mat3(Mat3::Constant(not_a_number)), Mat3(-good)}) {
        live.reading.orientation = bad;
        live.next();
        EXPECT_EQ(live.last.tick.tool.hand.coeffs(), seen.coeffs());
    }
    apply(live.session, command::Freeze{true});
    live.reading.orientation.setIdentity();
    live.next();
    EXPECT_EQ(live.last.tick.tool.hand.coeffs(), seen.coeffs());
    EXPECT_TRUE(live.last.tick.torque.isZero(0));
    apply(live.session, command::Freeze{false});
    live.next();
    EXPECT_TRUE(live.last.tick.tool.hand.isApprox(Quaternion::Identity()));
}

TEST(ToolSession, tools_are_taken_up_and_put_down_where_the_proxy_is) {
    FeltLive live(at_once());
    live.rest_at(33);
    EXPECT_NEAR(live.last.tick.proxy.scp[2], 30, 1e-6);
    apply(live.session, command::UseTool{std::make_shared<const Tool>(sphere_tool(2, 0.5))});
    live.rest_at(33);
    // The ball's centre stays a radius above, less what its points leave.
    EXPECT_NEAR(live.last.tick.proxy.scp[2], 28, 0.05);
    EXPECT_GT(live.last.tick.tool.contacts, 0);
    const Snapshot seen = snapshot_of(live.session, live.last, 0, 0);
    EXPECT_GE(seen.contact_count, live.last.tick.tool.contacts);
    EXPECT_NEAR(seen.contacts[0].normal[2], -1, 1e-6);
    apply(live.session, command::UseTool{nullptr});
    live.rest_at(33);
    EXPECT_NEAR(live.last.tick.proxy.scp[2], 30, 1e-6);
    EXPECT_EQ(live.last.tick.tool.contacts, 0);
}

TEST(ToolSession, a_tool_that_was_put_down_keeps_no_samples) {
    FeltLive live(at_once());
    apply(live.session, command::UseTool{std::make_shared<const Tool>(sphere_tool(2, 0.5))});
    live.rest_at(33);
    const std::weak_ptr<const Samples> felt = live.session.renderer.field.shared_samples();
    apply(live.session, command::UseTool{nullptr});
    live.next();
    const Field other = smooth(ramp_field());
    apply(live.session, command::Samples{other.shared_samples()});
    live.next();
    EXPECT_TRUE(felt.expired());
}

TEST(ToolSession, what_a_tool_cannot_do_yet_is_refused_in_words) {
    const auto refused = [](auto&& change, Interpolation interpolation = Interpolation::cubic) {
        RendererSettings settings = settings_with(one_arm({1, 0, 0}));
        change(settings);
        Field field = ramp_field();
        field.set_interpolation(interpolation);
        EXPECT_THROW(make_renderer(field, 30, settings), std::invalid_argument);
    };
    refused([](RendererSettings& s) { s.penetrability.on = true; });
    refused([](RendererSettings& s) { s.layers = std::make_shared<const Layers>(); });
    refused([](RendererSettings& s) { s.force.magnet = {1, 0.1}; });
    refused([](RendererSettings& s) { s.force.texture.amplitude = 0.1; });
    refused([](RendererSettings& s) { s.method = &update_straight; });
    refused([](RendererSettings&) {}, Interpolation::linear);
    Session session{make_renderer(ramp_field(), 30), {}};
    EXPECT_THROW(apply(session, command::UseTool{one_arm({1, 0, 0})}), std::invalid_argument);
    EXPECT_NO_THROW(apply(session, command::UseTool{nullptr}));
}

TEST(ToolSession, a_command_for_what_only_a_point_feels_is_refused_and_changes_nothing) {
    const auto tool = one_arm({1, 0, 0});
    const Field field = smooth(ramp_field());
    RendererSettings settings = settings_with(nullptr);
    ForceSettings magnet = settings.force, texture = settings.force;
    magnet.magnet = {1, 0.1};
    texture.texture.amplitude = 0.1;
    const std::vector<Command> others{penetrability_threshold(1, 30, Solid::above),
                                      command::UseLayers{std::make_shared<const Layers>()}, magnet,
                                      texture};
    for (const Command& other : others) {
        Session session{make_renderer(field, 30, settings_with(tool)), {}};
        EXPECT_THROW(apply(session, other), std::invalid_argument) << other.index();
        EXPECT_NO_THROW(check(session.renderer.settings));
        // Nor can a tool be taken up beside one of them.
        session = {make_renderer(field, 30, settings), {}};
        apply(session, other);
        EXPECT_THROW(apply(session, command::UseTool{tool}), std::invalid_argument);
        EXPECT_FALSE(session.renderer.settings.tool);
        // A servo cannot know what is felt by the time: there it rests.
        session = {make_renderer(field, 30, settings_with(tool)), {}};
        make_room_for_tools(session.renderer);
        apply(session, CheckedCommand(other, settings, kind_of(field)));
        const Tick tick = advance(session, 0, {.status = DeviceStatus::ready}).tick;
        EXPECT_EQ(tick.proxy.status, UpdateStatus::done);
    }
}

TEST(ToolSession, rotational_settings_that_are_not_stable_are_refused_or_lowered) {
    const DeviceLimits limits{.maximum_torque = 100, .physical_rotational_damping = 0.1};
    ForceSettings settings;
    settings.rotational_stiffness = 201;  // 2 * 1000 Hz * 0.1
    EXPECT_THROW(check(settings, limits), std::invalid_argument);
    const ForceSettings lowered = stable(settings, limits);
    EXPECT_NO_THROW(check(lowered, limits));
    EXPECT_GT(lowered.rotational_stiffness, 199);
    settings.rotational_stiffness = 150;
    settings.rotational_damping = 0.04;
    EXPECT_THROW(check(settings, limits), std::invalid_argument);
    const ForceSettings both = stable(settings, limits);
    EXPECT_NO_THROW(check(both, limits));
    EXPECT_NEAR(both.rotational_damping / both.rotational_stiffness, 0.04 / 150, 1e-12);
    EXPECT_DOUBLE_EQ(rotational_stiffness(ForceSettings{}, limits, 4), 8);
    EXPECT_DOUBLE_EQ(rotational_stiffness(ForceSettings{}, limits, 40), 200);
    for (const double bad : {-1.0, not_a_number}) {
        settings = {};
        settings.rotational_damping = bad;
        EXPECT_THROW(check(settings, limits), std::invalid_argument);
    }
}

/// Bits that a replay has to give again.
std::vector<double> bits_of(const Tick& tick) {
    std::vector<double> bits;
    for (const Vec3& v : {tick.proxy.scp, tick.force, tick.torque}) {
        bits.insert(bits.end(), v.data(), v.data() + 3);
    }
    const auto& q = tick.tool.proxy.coeffs();
    bits.insert(bits.end(), q.data(), q.data() + 4);
    bits.push_back(tick.tool.contacts);
    return bits;
}

TEST(ToolSession, nothing_allocates_and_the_same_input_gives_the_same_bits) {
    const TestField test = noise_field();
    RendererSettings settings = settings_with(std::make_shared<const Tool>(rod_tool(4, 0.5)));
    settings.proxy.friction = {0.4, 0.3};
    const Session begin{make_renderer(smooth(test.field), test.isovalue, settings), {}};
    Session first = begin, second = begin;
    make_room_for_tools(first.renderer);
    make_room_for_tools(second.renderer);
    const std::vector<CheckedCommand> tools = [&] {
        std::vector<CheckedCommand> list;
        for (const auto& tool :
             {std::make_shared<const Tool>(sphere_tool(2, 0.6)), std::shared_ptr<const Tool>(),
              std::make_shared<const Tool>(box_tool({3, 2, 1}, 0.5))}) {
            list.emplace_back(command::UseTool{tool}, settings, kind_of(first.renderer.field));
        }
        return list;
    }();
    DeviceReading reading;
    reading.status = DeviceStatus::ready;
    Random random(11);
    Vec3 spin = Vec3::Zero();
    Quaternion orientation = Quaternion::Identity();
    std::int64_t allocations = 0;
    int contacts = 0;
    const int count = scaled(3000);
    for (int i = 0; i < count; ++i) {
        if (i % 50 == 0) spin = random.point(-0.02, 0.02);
        orientation = turned(orientation, spin);
        reading.position = Vec3::Constant(12) +
                           9 * Vec3(std::sin(0.011 * i), std::sin(0.017 * i), std::cos(0.013 * i));
        reading.orientation = orientation.toRotationMatrix();
        const bool changes = i % 97 == 96;
        const CheckedCommand& change = tools[std::size_t(i / 97 % 3)];
        const std::int64_t before = thread_allocation_count();
        if (changes) apply(first, change);
        const SessionTick a = advance(first, i * period, reading);
        allocations += thread_allocation_count() - before;
        if (changes) apply(second, change);
        const SessionTick b = repeat(second, a);
        const std::vector<double> one = bits_of(a.tick), two = bits_of(b.tick);
        ASSERT_EQ(0, std::memcmp(one.data(), two.data(), one.size() * sizeof(double))) << i;
        contacts += a.tick.tool.contacts;
        if (i % 500 == 250) second = Session(second);  // a copy goes on alike
    }
    EXPECT_EQ(allocations, 0);
    EXPECT_GT(contacts, count / 10);
}

TEST(ToolSession, a_tool_that_is_taken_up_again_is_as_new) {
    FeltLive live(settings_with(one_arm({0, 0, 5})));
    live.rest_at(32);
    const CheckedCommand away(command::UseTool{nullptr}, live.session.renderer.settings,
                              kind_of(live.session.renderer.field));
    ToolProxy& proxy = *live.session.renderer.tool_proxy;
    ASSERT_GT(proxy.contact_count, 0);
    proxy.sliding = true;
    proxy.trust = 0.125;
    proxy.stride = 2;
    apply(live.session, away);
    apply(live.session, command::UseTool{one_arm({0, 5, 0})});
    EXPECT_FALSE(proxy.sliding);
    EXPECT_EQ(proxy.trust, ToolState{}.trust);
    EXPECT_EQ(proxy.stride, ToolState{}.stride);
    EXPECT_EQ(proxy.contact_count, 0);
    EXPECT_TRUE(proxy.placed);
}

/// As in files with four decimals, and from drivers that compute with few digits.
TEST(ToolSession, orientations_with_few_digits_turn_the_tool) {
    FeltLive live(settings_with(one_arm({0, 0, 5})));
    const auto rounded = [](const Mat3& m) {
        return Mat3(((m * 1e4).array().round() / 1e4).matrix());
    };
    for (int i = 0; i < 200; ++i) {
        const Mat3 exact =
            turned(Quaternion::Identity(), 0.01 * i * Vec3(0.6, 0.3, 0.2)).toRotationMatrix();
        live.reading.orientation = rounded(exact);
        live.next();
        const Mat3& tool = live.session.past.tool;
        ASSERT_TRUE(is_rotation(tool)) << i;
        ASSERT_LE((tool - exact).cwiseAbs().maxCoeff(), 2e-4) << i;
    }
    live.reading.orientation *= 1.01;  // no rotation at all
    const Mat3 before = live.session.past.tool;
    live.next();
    EXPECT_EQ(live.session.past.tool, before);
}

}  // namespace
