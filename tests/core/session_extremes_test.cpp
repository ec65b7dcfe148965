// Session: whatever value a command carries, on whatever data, the state stays finite and the
// session goes on; what is not finite is refused at one gate.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>
#include <stdexcept>
#include <type_traits>

#include "palpate/baselines/methods.hpp"
#include "palpate/session.hpp"
#include "support/constants.hpp"
#include "support/fields.hpp"

using namespace palpate;
using namespace palpate::support;

namespace {

using Limits = std::numeric_limits<double>;

constexpr double extremes[] = {infinity,
                               -infinity,
                               not_a_number,
                               1e300,
                               -1e300,
                               Limits::max(),
                               Limits::lowest(),
                               Limits::min(),
                               -Limits::min(),
                               Limits::denorm_min(),
                               -Limits::denorm_min(),
                               1e38,
                               -1e38,
                               1e30,
                               1e-30,
                               1,
                               0,
                               -0.0};

/// Density = unit * z, so that level 30 lies at z = 30: ordinary, at the small and at the large end
/// of float32.
Field ramp_of(double unit, Solid solid) {
    const double sign = solid == Solid::above ? 1 : -1;
    return linear_field(
        volume_of<float>(grid({9, 9, 101}), [&](const Index3& i) { return sign * unit * i[2]; }),
        solid);
}
constexpr double units[] = {1, std::numeric_limits<float>::denorm_min(), 3e36};

/// Layers with `value` in each of their numbers, one at a time. A needle goes in at 0.1 N.
std::vector<Command> layers_with(double value, double isovalue) {
    Layers usual;
    usual.layers.resize(2);
    for (int i = 0; i < 2; ++i) {
        Layer& layer = usual.layers[std::size_t(i)];
        layer.name = std::to_string(i);
        layer.level = isovalue * (1 + 0.01 * i);
        layer[HapticProperty::puncture_force] = 0.1;
        layer[HapticProperty::drag] = 0.01;
    }
    usual.needle = Needle{};
    std::vector<Command> commands;
    const auto with = [&](auto&& change) {
        auto layers = std::make_shared<Layers>(usual);
        change(*layers);
        commands.emplace_back(command::UseLayers{std::move(layers)});
    };
    for (std::size_t i = 0; i < 2; ++i) {
        with([&](Layers& l) { l.layers[i].level = value; });
        for (int p = 0; p < haptic_property_count; ++p) {
            with([&](Layers& l) { l.layers[i].own[std::size_t(p)] = value; });
        }
    }
    for (int p = 0; p < haptic_property_count; ++p) {
        with([&](Layers& l) { l.curves[std::size_t(p)].gradient.knots = {{0, 1}, {1, value}}; });
        with([&](Layers& l) { l.curves[std::size_t(p)].gradient.knots = {{value, 1}}; });
    }
    with([&](Layers& l) { l.closing = value; });
    with([&](Layers& l) { l.needle->lateral_stiffness = value; });
    with([&](Layers& l) { l.needle->static_ratio = value; });
    with([&](Layers& l) { l.needle->stick_speed = value; });
    return commands;
}

/// A device's limits, each of them `value` in turn.
std::vector<Command> limits_with(double value) {
    std::vector<Command> commands;
    for (double DeviceLimits::*member :
         {&DeviceLimits::maximum_force, &DeviceLimits::rate, &DeviceLimits::physical_damping,
          &DeviceLimits::maximum_torque, &DeviceLimits::physical_rotational_damping,
          &DeviceLimits::delay, &DeviceLimits::continuous_force, &DeviceLimits::warming_time}) {
        DeviceLimits limits;
        limits.*member = value;
        commands.emplace_back(limits);
    }
    return commands;
}

/// No tool, and tools with `value` for a coordinate, the gyration or both.
std::vector<Command> tools_with(double value) {
    std::vector<Command> commands;
    commands.emplace_back(command::UseTool{nullptr});
    for (const auto& [point, gyration] : {std::pair{value, 1.0}, {1.0, value}, {value, value}}) {
        try {
            const std::vector<Vec3> points{Vec3(1, 0, 0), Vec3(0, point, 0)};
            commands.emplace_back(command::UseTool{std::make_shared<const Tool>(points, gyration)});
        } catch (const std::invalid_argument&) {  // no tool at all
        }
    }
    return commands;
}

/// Every command with `value` wherever it has a number.
std::vector<Command> commands_with(double value, const Field& field, double isovalue) {
    std::vector<Command> commands = layers_with(value, isovalue);
    const std::initializer_list<Command> simple{command::Isovalue{value}, command::Freeze{true},
                                                command::Clutch{true},    command::Forces{false},
                                                command::Scale{value},    command::Samples{},
                                                command::Moment{value},   command::Speed{value},
                                                Friction{value, value},   Friction{value, 0}};
    commands.insert(commands.end(), simple);
    commands.emplace_back(command::Lift{});
    const auto point = std::make_shared<SessionPoint>();
    point->proxy.isovalue = isovalue;
    point->speed = value;
    commands.emplace_back(command::Resume{point});
    commands.emplace_back(command::Samples{field.shared_samples(), 1});
    for (double ForceSettings::*member :
         {&ForceSettings::stiffness, &ForceSettings::damping, &ForceSettings::viscosity,
          &ForceSettings::limit, &ForceSettings::rate_limit, &ForceSettings::ramp,
          &ForceSettings::stale_after, &ForceSettings::start_below,
          &ForceSettings::rotational_stiffness, &ForceSettings::rotational_damping,
          &ForceSettings::torque_limit, &ForceSettings::torque_rate_limit}) {
        ForceSettings force;
        force.*member = value;
        commands.emplace_back(force);
    }
    ForceSettings force;
    force.magnet = {value, 0.1};
    commands.emplace_back(force);
    force.magnet = {0.1, value};
    commands.emplace_back(force);
    force.magnet = {};
    force.texture = {value, 1};
    commands.emplace_back(force);
    force.texture = {0.01, value};
    commands.emplace_back(force);
    for (const DensityRange range : {DensityRange{value, infinity}, DensityRange{-infinity, value},
                                     DensityRange{value, value}, DensityRange{0, value}}) {
        for (const double threshold : {0.5, value}) {
            Penetrability p;
            p.on = true;
            p.threshold = threshold;
            p.range_count = 1;
            p.ranges[0] = range;
            commands.emplace_back(p);
        }
    }
    DeviceTransform transform;
    transform.scale = value;
    commands.emplace_back(transform);
    for (int a = 0; a < 3; ++a) {
        transform = {};
        transform.translation[a] = value;
        commands.emplace_back(transform);
        transform = {};
        transform.rotation(a, a) = value;
        commands.emplace_back(transform);
    }
    for (const auto& more : {limits_with(value), tools_with(value)})
        commands.insert(commands.end(), more.begin(), more.end());
    return commands;
}

bool is_finite(const LayerState& s) {
    const NeedleState& n = s.needle;
    return s.hip.allFinite() && std::isfinite(s.spring.stiffness) && std::isfinite(s.spring.rest) &&
           n.entry.allFinite() && n.axis.allFinite() && std::isfinite(n.hand) &&
           std::isfinite(n.anchor) && std::isfinite(n.aside.rest);
}

bool is_finite(const Session& s) {
    const Renderer& r = s.renderer;
    const DeviceTransform& t = r.settings.transform;
    return is_finite(r.layers) && r.proxy.scp.folded.allFinite() &&
           r.proxy.scp_physical.allFinite() && r.proxy.normal_before.allFinite() &&
           std::isfinite(r.proxy.recovery_reach) && !std::isnan(r.proxy.isovalue) &&
           !std::isnan(r.isovalue_without_layers.value_or(0)) && r.force.force.allFinite() &&
           r.force.velocity.allFinite() && r.force.hand.allFinite() && r.force.torque.allFinite() &&
           r.force.angular_velocity.allFinite() &&
           (!r.tool_proxy || (r.tool_proxy->pose.position.allFinite() &&
                              r.tool_proxy->pose.orientation.coeffs().allFinite())) &&
           t.rotation.allFinite() && t.translation.allFinite() && std::isfinite(t.scale) &&
           std::isfinite(r.field.time()) && s.past.hand.allFinite() &&
           s.past.held_hip.allFinite() && s.past.held_tool.allFinite();
}

/// A hand that presses into level 30, moves in and out, and turns.
struct Presser {
    Session session;
    double time = 0;
    SessionTick last{};

    Presser(const Field& field, double isovalue, const RendererSettings& settings = {})
        : session{make_renderer(field, isovalue, settings), {}} {}
    /// False if a tick left something that is not finite.
    bool press(double depth, int ticks) {
        for (int i = 0; i < ticks; ++i) {
            DeviceReading reading;
            reading.status = DeviceStatus::ready;
            const double swing = 0.3 * std::sin(0.1 * i);
            reading.position = Vec3(4.2 + swing, 3.9, depth + swing);
            last = advance(session, time += period, reading);
            if (!is_finite(session) || !last.tick.force.allFinite() ||
                !last.tick.proxy.scp.allFinite() || last.tick.force.norm() > 3.3 + 1e-12) {
                return false;
            }
        }
        return true;
    }
    /// True if pressing into the surface ends in contact, with a force.
    bool feels_as_before(int ticks) {
        return press(31, ticks) && last.tick.proxy.status == UpdateStatus::done &&
               last.tick.proxy.mode == Mode::constrained && last.tick.force.norm() > 0.1;
    }
    /// Takes back whatever a command may have changed, but for the device's limits, which only
    /// fall.
    void restore(const Field& field, double isovalue) {
        apply(session, command::UseLayers{nullptr});
        apply(session, command::Isovalue{isovalue});
        apply(session, command::Freeze{false});
        apply(session, command::Clutch{false});
        apply(session, command::Forces{true});
        apply(session, command::Samples{field.shared_samples(), 0});
        apply(session, command::Speed{0});
        apply(session, Friction{});
        apply(session, no_penetrability());
        apply(session, DeviceTransform{});
        session.renderer.settings.device = {};
        apply(session, ForceSettings{});
    }
};

}  // namespace

TEST(SessionExtremes, no_command_with_any_value_leaves_what_is_not_finite_or_lasts) {
    std::set<std::size_t> accepted_kinds, refused_kinds;
    for (const double unit : units) {
        for (const Solid solid : {Solid::above, Solid::below}) {
            const Field field = ramp_of(unit, solid);
            const double isovalue = (solid == Solid::above ? 30 : -30) * unit;
            for (const double value : extremes) {
                Presser unchanged(field, isovalue);  // gets every command that is refused
                ASSERT_TRUE(unchanged.press(31, 20));
                for (const Command& command : commands_with(value, field, isovalue)) {
                    SCOPED_TRACE(testing::Message() << "unit " << unit << ", value " << value
                                                    << ", command " << command.index());
                    Presser presser = unchanged;
                    try {
                        apply(presser.session, command);
                        accepted_kinds.insert(command.index());
                    } catch (const std::invalid_argument&) {
                        refused_kinds.insert(command.index());
                        unchanged = presser;
                        continue;
                    }
                    ASSERT_TRUE(presser.press(31, 40));
                    presser.restore(field, isovalue);
                    ASSERT_TRUE(presser.press(28, 40));
                    ASSERT_TRUE(presser.feels_as_before(300));
                }
                EXPECT_TRUE(unchanged.feels_as_before(300))
                    << "unit " << unit << ", value " << value;
            }
        }
    }
    // Every kind of command was carried out, and every kind that has a number was refused, too.
    EXPECT_EQ(accepted_kinds.size(), std::variant_size_v<Command>);
    EXPECT_EQ(refused_kinds.size(), std::variant_size_v<Command> - 4);
}

TEST(SessionExtremes, with_a_tool_no_command_with_any_value_leaves_what_is_not_finite) {
    Field field = ramp_of(1, Solid::above);
    field.set_interpolation(Interpolation::cubic);
    RendererSettings settings;
    settings.tool =
        std::make_shared<const Tool>(std::vector<Vec3>{{1, 0, 0}, {-1, 0, 0}, {0, 0, 2}});
    settings.device.maximum_torque = 100;
    int tools = 0;
    for (const double value : extremes) {
        Presser unchanged(field, 30, settings);  // gets every command that is refused
        ASSERT_TRUE(unchanged.press(31, 20));
        for (const Command& command : commands_with(value, field, 30)) {
            SCOPED_TRACE(testing::Message()
                         << "value " << value << ", command " << command.index());
            Presser presser = unchanged;
            try {
                apply(presser.session, command);
                tools += std::holds_alternative<command::UseTool>(command);
            } catch (const std::invalid_argument&) {
                unchanged = presser;
                continue;
            }
            ASSERT_TRUE(presser.press(31, 40));
            ASSERT_LE(presser.last.tick.torque.norm(), 100 * (1 + 1e-12));
            apply(presser.session, command::UseTool{settings.tool});
            presser.restore(field, 30);
            presser.session.renderer.settings.device = settings.device;
            ASSERT_TRUE(presser.press(24, 40));
            ASSERT_TRUE(presser.feels_as_before(400));
        }
        EXPECT_TRUE(unchanged.feels_as_before(400)) << "value " << value;
    }
    EXPECT_GT(tools, 10);
}

TEST(SessionExtremes, an_isovalue_at_which_nothing_can_be_free_is_refused_wherever_it_enters) {
    for (const Solid solid : {Solid::above, Solid::below}) {
        const double sign = solid == Solid::above ? 1 : -1;
        const Field field = ramp_of(1, solid);
        for (const double value : {-sign * infinity, not_a_number}) {
            EXPECT_THROW(make_renderer(field, value), std::invalid_argument);
            Presser presser(field, 30 * sign);
            EXPECT_THROW(apply(presser.session, command::Isovalue{value}), std::invalid_argument);
            EXPECT_EQ(presser.session.renderer.proxy.isovalue, 30 * sign);
        }
        // At the other infinity all is free.
        Presser presser(field, 30 * sign);
        apply(presser.session, command::Isovalue{sign * infinity});
        ASSERT_TRUE(presser.press(31, 300));
        EXPECT_EQ(presser.last.tick.proxy.mode, Mode::free);
        EXPECT_EQ(presser.last.tick.force, Vec3(0, 0, 0));
    }
}

TEST(SessionExtremes, only_checked_commands_are_carried_out_without_a_check) {
    static_assert(!std::is_convertible_v<Command, CheckedCommand>);
    static_assert(!std::is_constructible_v<CheckedCommand, Command>);
    Presser presser(ramp_of(1, Solid::above), 30);
    static_assert(noexcept(apply(presser.session, CheckedCommand{})));
    const RendererSettings settings;
    const Geometry& geometry = presser.session.renderer.field.geometry();
    EXPECT_THROW(CheckedCommand(command::Scale{-1}, settings, {geometry}), std::invalid_argument);
    ASSERT_TRUE(presser.press(31, 300));
    EXPECT_GT(presser.last.tick.force.norm(), 0.1);
    apply(presser.session, CheckedCommand{});
    ASSERT_TRUE(presser.press(31, 1));
    EXPECT_EQ(presser.last.tick.force, Vec3(0, 0, 0));
}

TEST(SessionExtremes, an_update_that_is_not_finite_is_taken_back_and_says_so) {
    Presser presser(ramp_of(1, Solid::above), 30);
    ASSERT_TRUE(presser.press(31, 300));
    const Vec3 scp = presser.session.renderer.proxy.scp_physical;
    presser.session.renderer.settings.method = [](Proxy& proxy, const Field&, const Vec3& hip,
                                                  const ProxySettings&, StepObserver) {
        proxy.scp.folded[1] = not_a_number;
        proxy.scp_physical[2] = infinity;
        proxy.mode = Mode::free;
        ProxyUpdate update;
        update.hip = hip;
        update.scp = proxy.scp_physical;
        return update;
    };
    ASSERT_TRUE(presser.press(31, 5));
    EXPECT_EQ(presser.last.tick.proxy.status, UpdateStatus::not_finite);
    EXPECT_EQ(presser.last.tick.proxy.scp, scp);
    EXPECT_EQ(presser.last.tick.proxy.mode, Mode::constrained);
    EXPECT_EQ(presser.last.tick.force, Vec3(0, 0, 0));
    EXPECT_TRUE(presser.last.tick.force_flags & force_not_finite);
    presser.session.renderer.settings.method = &update_exact;
    ASSERT_TRUE(presser.press(31, 300));
    EXPECT_EQ(presser.last.tick.proxy.status, UpdateStatus::done);
    EXPECT_GT(presser.last.tick.force.norm(), 0.1);
}

TEST(SessionExtremes, updates_stay_finite_at_any_isovalue_on_any_data) {
    for (const double unit : units) {
        for (const Solid solid : {Solid::above, Solid::below}) {
            const double sign = solid == Solid::above ? 1 : -1;
            const Volume volume = ramp_of(unit, solid).volume();
            for (const double background : extremes) {
                if (!(std::abs(background) <= std::numeric_limits<float>::max())) {
                    EXPECT_THROW(linear_field(volume, solid, background), std::invalid_argument);
                    continue;
                }
                const Field field = linear_field(volume, solid, background);
                for (const double isovalue : extremes) {
                    for (const ProxyMethod method : {&update_exact, &baselines::update_paper}) {
                        Random random(2);
                        Proxy proxy;
                        proxy.isovalue = sign * 30 * unit;
                        for (int i = 0; i < 60; ++i) {
                            if (i % 20 == 10) proxy.isovalue = isovalue;
                            if (i % 20 == 0) proxy.isovalue = sign * 30 * unit;
                            const Vec3 hip = random.point(-3, 40);
                            const ProxyUpdate r = method(proxy, field, hip, {}, {});
                            ASSERT_TRUE(r.scp.allFinite() && proxy.scp.folded.allFinite() &&
                                        proxy.scp_physical.allFinite())
                                << "unit " << unit << " background " << background << " isovalue "
                                << isovalue;
                            // At once where all of space is solid or nothing tells.
                            if (!(sign * proxy.isovalue > -infinity)) {
                                ASSERT_EQ(r.status, UpdateStatus::refused);
                            }
                        }
                    }
                }
            }
        }
    }
}
