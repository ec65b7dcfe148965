// The contact changes while the hand stands: whichever command does it, the force rises no faster
// than by the ramp, and a command that changes nothing is not felt.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <ostream>

#include "palpate/session.hpp"
#include "support/constants.hpp"
#include "support/edits.hpp"
#include "support/layer.hpp"
#include "support/press.hpp"
#include "support/resident.hpp"
#include "support/scripted_device.hpp"

using namespace palpate;
using namespace palpate::support;

namespace {

enum class Touching { point, rod };

/// Density = z + `more`, so the level 60 lies at z = 60 - more.
Volume slope(double more) {
    return volume_of<float>(grid({48, 24, 101}), [&](const Index3& i) { return i[2] + more; });
}
constexpr double level = 60, deep = 30;
constexpr double more = 50;  // makes solid where the hand stands
constexpr double rod_length = 8, tilt = 0.7;

std::shared_ptr<const Layers> layers_at(double isovalue, double stiffness) {
    auto layers = std::make_shared<Layers>();
    layers->layers = {layer_of("wall", isovalue, stiffness, infinity)};
    return layers;
}

RendererSettings usual(Touching touching) {
    RendererSettings settings;
    settings.device.maximum_torque = 100;
    settings.force.torque_limit = 80;
    if (touching == Touching::rod)
        settings.tool = std::make_shared<const Tool>(rod_tool(rod_length, 1));
    return settings;
}

/// A change of what a hand touches that stands at this depth. It starts at another.
struct Change {
    const char* name;
    bool for_tools;
    std::function<void(Session&)> before;  // the hand is placed
    std::function<Command(const Session&)> command;
    double z = deep, start = 20;
    bool has_torque = true;
};
void nothing(Session&) {}
void between_frames(Session& session) {
    session.renderer.field.use(
        std::make_shared<const Samples>(std::vector<Frame>{{0, slope(0)}, {1, slope(more)}}));
}
/// The steeper the surface, the stiffer it is.
void stiffness_over_gradient(Session& session) {
    auto layers = std::make_shared<Layers>(*layers_at(level, 1));
    (*layers)[HapticProperty::stiffness].gradient.knots = {{0, 0.05}, {2, 0.05}, {30, 4}};
    session.renderer.settings.layers = std::move(layers);
}
std::function<Command(const Session&)> use(std::shared_ptr<const Samples> samples) {
    return [samples](const Session&) { return command::Samples{samples}; };
}
std::function<Command(const Session&)> with(double ForceSettings::*member, double value) {
    return [member, value](const Session& session) {
        ForceSettings force = session.renderer.settings.force;
        force.*member = value;
        return force;
    };
}

/// In bricks, of which those beyond z = 64 may not be in memory. The surface is at z = 70.
std::shared_ptr<const Samples> bricks(bool all) {
    PartOf part(slope(level - 70));
    for (const Index3& at : part.all()) {
        if (all || at[2] == 0) part.add(at);
    }
    return part.samples();
}

/// Of the level, the layers or the force.
std::vector<Change> changes_of_settings() {
    return {
        {"isovalue", true, nothing, [](auto&) { return command::Isovalue{level - more}; }},
        {"layers", false, [](Session& s) { s.renderer.settings.force.stiffness = 0.05; },
         [](auto&) { return command::UseLayers{layers_at(level, 2)}; }, level + 8},
        {"no_layers", false,
         [](Session& s) {
             s.renderer.settings.layers = layers_at(level, 0.5);
             s.renderer.proxy.isovalue = level - more;
         },
         [](auto&) { return command::UseLayers{nullptr}; }},
        {"stiffness", true, nothing, with(&ForceSettings::stiffness, 4.5), level + 3},
        {"limit", true, [](Session& s) { s.renderer.settings.force.limit = 0.1; },
         with(&ForceSettings::limit, 3.3), level + 8},
        {"transform", true, nothing,
         [](auto&) {
             return DeviceTransform{.translation = {0, 0, more}};
         }},
    };
}

std::vector<Change> changes_of_samples() {
    const auto other = std::make_shared<const Samples>(slope(more));
    const auto filled = edited(std::make_shared<const Samples>(slope(0)),
                               edit::Fill{{{0, 0, 15}, {47, 23, 40}}, 200})
                            .samples;
    return {
        {"other_samples", true, nothing, use(other)},
        {"edited_samples", true, nothing, use(filled), deep, 20, false},
        {"edited_samples_under_curves", false, stiffness_over_gradient, use(filled)},
        {"samples_that_come", true, [](Session& s) { s.renderer.field.use(bricks(false)); },
         use(bricks(true)), 80, 50},
        {"moment", true, between_frames, [](auto&) { return command::Moment{1}; }},
        {"speed", true, between_frames, [](auto&) { return command::Speed{1000}; }},
    };
}

struct Case {
    Touching touching;
    Interpolation field;
    Change change;
};
std::ostream& operator<<(std::ostream& out, const Case& one) {
    return out << one.change.name;
}
std::vector<Case> all_cases() {
    std::vector<Case> all;
    for (const auto& changes : {changes_of_settings(), changes_of_samples()}) {
        for (const Change& change : changes) {
            all.push_back({Touching::point, Interpolation::linear, change});
            all.push_back({Touching::point, Interpolation::cubic, change});
            if (change.for_tools) all.push_back({Touching::rod, Interpolation::cubic, change});
        }
    }
    return all;
}
class ForceChanges : public testing::TestWithParam<Case> {};

/// Until the force has come to rest, at the device's rate.
Tick stand(Session& session, double& time, const DeviceReading& reading, int ticks,
           const std::function<void(const Tick&)>& judge) {
    Tick last;
    for (int i = 0; i < ticks; ++i) {
        last = advance(session, time += period, reading).tick;
        judge(last);
    }
    return last;
}

TEST_P(ForceChanges, lets_the_force_rise_no_faster_than_the_ramp) {
    const auto& [touching, field, change] = GetParam();
    const Field at_first(std::make_shared<const Samples>(slope(0)), Solid::above, -1000, field);
    Session session{make_renderer(at_first, level, usual(touching)), {.fastest_hand = infinity}};
    change.before(session);
    // The far end of the rod touches, so there is a torque.
    const bool rod = touching == Touching::rod;
    const double reach = rod ? rod_length * std::cos(tilt) : 0;
    DeviceReading reading = ready_at({24.2, 12.1, change.start - reach});
    reading.orientation = turned(Quaternion::Identity(), Vec3(0, tilt, 0)).toRotationMatrix();
    double time = 0;
    for (; reading.position[2] < change.z - reach; reading.position[2] += 0.05) {
        advance(session, time += period, reading);
    }
    const Tick before = stand(session, time, reading, 400, [](auto&) {});
    palpate::apply(session, change.command(session));
    double force = before.force.norm(), torque = before.torque.norm();
    const ForceSettings& settings = session.renderer.settings.force;
    const double part = period / settings.ramp;
    const Tick after = stand(session, time, reading, 600, [&](const Tick& tick) {
        ASSERT_LE(tick.force.norm() - force, settings.limit * part * (1 + 1e-9));
        ASSERT_LE(tick.torque.norm() - torque, settings.torque_limit * part * (1 + 1e-9));
        force = tick.force.norm();
        torque = tick.torque.norm();
    });
    EXPECT_GT(after.force.norm(), before.force.norm() + 1);
    EXPECT_EQ(after.force_flags & force_ramping, 0);
    if (rod && change.has_torque) {
        EXPECT_GT(after.torque.norm(), before.torque.norm());
    }
}

std::string name_of_case(const testing::TestParamInfo<Case>& info) {
    const auto& [touching, field, change] = info.param;
    const char* what = touching == Touching::rod ? "rod_" : "point_";
    return what + std::string(name_of(field)) + "_" + change.name;
}
INSTANTIATE_TEST_SUITE_P(Every, ForceChanges, testing::ValuesIn(all_cases()), name_of_case);

/// What a change leads to takes several ticks where an update runs out of its budget, and where the
/// proxy is pressed through a surface and meets the next one.
TEST(ForceChanges, are_bounded_until_the_proxy_has_got_where_they_lead) {
    const auto samples =
        std::make_shared<const Samples>(noise_volume<std::uint8_t>(grid({24, 24, 24}), 3, 0, 256));
    Random random(7);
    int risen = 0;
    for (int hand = 0; hand < 60; ++hand) {
        const bool rod = hand % 2 == 1;
        RendererSettings settings = usual(rod ? Touching::rod : Touching::point);
        settings.proxy.step_budget = rod ? 300 : 4096;
        Session session{make_renderer(Field(samples, Solid::above, 0), 128.5, settings),
                        {.fastest_hand = infinity}};
        DeviceReading reading = ready_at({-12, 12, 12});
        const Vec3 end(random.uniform(2, 12), random.uniform(8, 16), random.uniform(8, 16));
        const Vec3 step = (end - reading.position) / 300;
        double time = 0;
        for (int i = 0; i < 300; ++i, reading.position += step) {
            advance(session, time += period, reading);
        }
        double force = stand(session, time, reading, 400, [](auto&) {}).force.norm();
        const double most = settings.force.limit * period / settings.force.ramp * (1 + 1e-9);
        for (int change = 0; change < 4; ++change) {
            if (rod) {
                palpate::apply(session, command::Isovalue{random.uniform(110, 150)});
            } else {
                palpate::apply(session, penetrability_threshold(random.uniform(0.5, 3), 0));
            }
            stand(session, time, reading, 300, [&](const Tick& tick) {
                ASSERT_LE(tick.force.norm() - force, most) << hand;
                risen += tick.force.norm() > force;
                force = tick.force.norm();
            });
        }
    }
    EXPECT_GT(risen, 1000);
}

/// 100 mm/s, which is faster than the ramp.
TEST(ForceChanges, a_surface_that_moves_in_a_sequence_pushes_as_it_moves) {
    const auto frames = std::make_shared<const Samples>(
        std::vector<Frame>{{0, slope(0)}, {0.1, slope(10)}, {0.2, slope(20)}});
    Session session{make_renderer(Field(frames, Solid::above, -1000), level, {}), {}};
    const DeviceReading reading = ready_at({24.2, 12.1, 42});
    double time = 0;
    stand(session, time, reading, 400, [](auto&) {});
    palpate::apply(session, command::Speed{1});
    double most = 0;
    stand(session, time, reading, 190, [&](const Tick& tick) {
        const Vec3 pull = tick.proxy.scp - tick.proxy.hip;
        ASSERT_EQ(tick.force, Vec3(0.5 * pull));
        ASSERT_EQ(tick.force_flags, 0);
        most = tick.force.norm();
    });
    EXPECT_GT(most, 0.3);
}

/// Every few ticks, as a window, a brush or a store sends them.
TEST(ForceChanges, commands_that_change_nothing_are_not_felt) {
    int contacts = 0;
    for (const Interpolation field : {Interpolation::linear, Interpolation::cubic}) {
        for (const bool in_layers : {false, true}) {
            for (const double friction : {0.0, 0.4}) {
                const auto samples = std::make_shared<const Samples>(
                    noise_volume<std::uint8_t>(grid({24, 24, 24}), 3, 0, 256));
                RendererSettings settings;
                settings.proxy.friction = {friction, 0.8 * friction};
                if (in_layers) settings.layers = layers_at(128.5, 0.5);
                const Session session{
                    make_renderer(Field(samples, Solid::above, 0, field), 128.5, settings),
                    {.fastest_hand = infinity}};
                Session quiet = session, busy = session;
                Random random(5);
                DeviceReading reading = ready_at({12, 12, 12});
                Vec3 way = Vec3::Zero();
                for (int i = 1; i < scaled(20000); ++i) {
                    way += 0.02 * random.direction() - 0.01 * way;
                    reading.position = Vec3(12, 12, 12) + 4 * way;
                    if (random.chance(0.3)) {
                        apply(busy, command::Samples{samples});
                        apply(busy, session.renderer.settings.force);
                        if (!in_layers) apply(busy, command::Isovalue{128.5});
                    }
                    const Tick one = advance(quiet, i * period, reading).tick;
                    const Tick other = advance(busy, i * period, reading).tick;
                    ASSERT_EQ(one.force, other.force) << i;
                    ASSERT_EQ(one.force_flags, other.force_flags) << i;
                    contacts += one.proxy.mode == Mode::constrained;
                }
            }
        }
    }
    EXPECT_GT(contacts, scaled(10000));
}

}  // namespace
