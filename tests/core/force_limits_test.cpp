// Force: the limits that hold whatever is asked, the stops, and the settings that are refused.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "palpate/force.hpp"
#include "support/constants.hpp"
#include "support/random.hpp"

using namespace palpate;
using namespace palpate::support;

namespace {

constexpr double rounding = 1 + 1e-12;

ForceInput pressing(double time, const Vec3& pull = Vec3(0, 0, 2)) {
    ForceInput input;
    input.time = time;
    input.constrained = true;
    input.pull = pull;
    return input;
}

/// A state in full contact, past its ramp, and the time of its last tick.
struct Running {
    ForceSettings settings{};
    DeviceLimits limits{};
    ForceState state{};
    double time = 0;

    Running() { run(1000); }
    ForceResult step(ForceInput input) { return render_force(state, settings, limits, input); }
    ForceResult next() { return step(pressing(time += period)); }
    void run(int ticks) {
        for (int i = 0; i < ticks; ++i) next();
    }
};

/// Whatever stopped the force, it is zero at once and comes back from zero by the ramp.
void expect_stop_and_ramp(Running& running, const ForceInput& broken, unsigned why) {
    ASSERT_GT(running.state.force.norm(), 0.9);
    const ForceResult stopped = running.step(broken);
    EXPECT_EQ(stopped.force, Vec3::Zero());
    EXPECT_TRUE(stopped.flags & why) << unsigned(stopped.flags);
    double last = 0;
    for (int i = 0; i < 260; ++i) {
        const ForceResult result = running.next();
        if (i == 0) {
            EXPECT_EQ(result.force, Vec3::Zero());
        }
        if (i != 250) {  // there the sum of the ticks decides
            EXPECT_EQ(bool(result.flags & force_ramping), i < 250) << i;
        }
        ASSERT_NEAR(result.force[2], std::min(1.0, i * period / running.settings.ramp), 1e-9) << i;
        ASSERT_GE(result.force[2], last);
        last = result.force[2];
    }
    EXPECT_DOUBLE_EQ(last, 1);
}

double any_magnitude(Random& random) {
    return std::pow(10, random.uniform(-6, 6));
}

ForceSettings any_settings(Random& random) {
    ForceSettings s;
    s.stiffness = any_magnitude(random);
    s.damping = random.chance(0.5) ? 0 : any_magnitude(random);
    s.viscosity = random.chance(0.5) ? 0 : any_magnitude(random);
    s.magnet = {random.uniform(0, 3), any_magnitude(random)};
    s.limit = any_magnitude(random);
    s.rate_limit = random.chance(0.2) ? infinity : any_magnitude(random);
    s.ramp = random.chance(0.3) ? 0 : random.uniform(0, 0.02);
    s.stale_after = random.chance(0.2) ? infinity : random.uniform(0.001, 0.02);
    return s;
}

double nasty(Random& random) {
    const double choices[] = {0,      not_a_number, infinity, -infinity, 1e300, -1e300,
                              1e-300, 5e-324,       1e154,    1e160,     1,     -2};
    return choices[random.below(12)];
}

/// Mostly a hand, now and then nonsense.
ForceInput any_input(Random& random, double time) {
    const double size = random.chance(0.01) ? 1e200 : any_magnitude(random) * 1e-3;
    ForceInput in;
    in.time = time;
    in.valid = !random.chance(0.002);
    in.enabled = !random.chance(0.002);
    in.constrained = random.chance(0.7);
    in.hand = random.point(-1, 1) * size;
    in.pull = random.point(-1, 1) * size;
    in.normal = random.direction();
    in.surface_distance = random.uniform(-1, 3);
    in.texture_slope = random.chance(0.5) ? Vec3::Zero().eval() : random.point(-3, 3);
    if (random.chance(0.01)) in.pull[random.below(3)] = nasty(random);
    if (random.chance(0.01)) in.hand[random.below(3)] = nasty(random);
    if (random.chance(0.01)) in.texture_slope[random.below(3)] = nasty(random);
    if (random.chance(0.01)) in.normal[random.below(3)] = nasty(random);
    return in;
}

std::string refusal(const ForceSettings& settings, const DeviceLimits& limits = {}) {
    try {
        check(settings, limits);
    } catch (const std::invalid_argument& error) {
        return error.what();
    }
    return "accepted";
}

}  // namespace

/// Limits and settings within and beyond what can be rendered stably.
struct Asked {
    DeviceLimits limits;
    ForceSettings settings;

    explicit Asked(Random& random) {
        limits.maximum_force = random.uniform(0.5, 20);
        limits.rate = random.uniform(250, 8000);
        limits.physical_damping = random.uniform(1e-3, 1e-2);
        limits.delay = random.below(2) ? random.uniform(0, 3e-3) : 0;
        settings.stiffness = random.uniform(0, 10);
        settings.damping = random.below(2) ? random.uniform(0, 5e-3) : 0;
        settings.viscosity = random.below(2) ? random.uniform(0, 5e-3) : 0;
        if (random.below(2)) settings.magnet = {random.uniform(0, 2), random.uniform(0, 3)};
    }
};

TEST(Force, settings_are_lowered_to_what_is_stable_and_no_others_are_touched) {
    Random random(3);
    int touched = 0, left = 0;
    for (int i = 0; i < 20'000; ++i) {
        const Asked asked(random);
        const ForceSettings lowered = stable(asked.settings, asked.limits);
        ASSERT_EQ(refusal(lowered, asked.limits), "accepted");
        if (refusal(asked.settings, asked.limits) == "accepted") {
            ASSERT_EQ(lowered, asked.settings);
            ++left;
            continue;
        }
        ++touched;
        ASSERT_LE(lowered.stiffness, asked.settings.stiffness);
        ASSERT_LE(lowered.magnet.peak, asked.settings.magnet.peak);
        // The spring and its damping keep their proportion.
        ASSERT_NEAR(lowered.damping * asked.settings.stiffness,
                    asked.settings.damping * lowered.stiffness, 1e-12);
        ASSERT_EQ(stable(lowered, asked.limits), lowered);
    }
    EXPECT_GT(touched, 1000);
    EXPECT_GT(left, 1000);
}

TEST(Force, of_two_limits_the_smaller_number_counts_and_one_that_is_none_allows_nothing) {
    const DeviceLimits some{3, 1000, 2e-3};
    EXPECT_EQ(smaller(some, {5, 500, 1e-3}), (DeviceLimits{3, 500, 1e-3}));
    EXPECT_EQ(smaller({5, 500, 1e-3}, some), (DeviceLimits{3, 500, 1e-3}));
    EXPECT_EQ(smaller(some, some), some);
    const DeviceLimits none{0, 0, 0};
    EXPECT_EQ(smaller(some, {not_a_number, not_a_number, not_a_number}), none);
    EXPECT_EQ(smaller({not_a_number, -1, not_a_number}, some), none);
    ForceSettings damped;
    damped.damping = 1e-3;
    const ForceSettings nothing = stable(damped, none);
    EXPECT_EQ(nothing.stiffness, 0);
    EXPECT_EQ(nothing.damping, 0);
}

TEST(Force, never_exceeds_its_limits_whatever_is_asked) {
    Random random(11);
    int limited = 0, rate_limited = 0, stopped = 0, ramping = 0;
    for (int session = 0; session < 400; ++session) {
        const ForceSettings settings = any_settings(random);
        DeviceLimits limits;
        limits.maximum_force = any_magnitude(random);
        const double most = std::min(settings.limit, limits.maximum_force);
        ForceState state;
        double time = random.uniform(-10, 10);
        Vec3 last = Vec3::Zero();
        for (int i = 0; i < scaled(500); ++i) {
            const double step = random.chance(0.01) ? 0.05 : random.uniform(1e-5, 2e-3);
            time += step;
            const ForceResult r = render_force(state, settings, limits, any_input(random, time));
            ASSERT_TRUE(r.force.allFinite()) << session << " " << i;
            ASSERT_LE(r.force.norm(), most * rounding) << session << " " << i;
            if (!r.force.isZero(0) && std::isfinite(settings.rate_limit)) {
                // The time as the state sees it: a difference of two sums.
                const double seen = step + 1e-15 * (1 + std::abs(time));
                ASSERT_LE((r.force - last).norm(),
                          settings.rate_limit * seen * rounding + 1e-12 * most)
                    << session << " " << i;
            }
            last = r.force;
            limited += bool(r.flags & force_limited);
            rate_limited += bool(r.flags & force_rate_limited);
            ramping += bool(r.flags & force_ramping);
            stopped += bool(r.flags & (force_stale | force_not_finite | force_off));
        }
    }
    for (const int met : {limited, rate_limited, stopped, ramping}) EXPECT_GT(met, scaled(2000));
}

TEST(Force, limits_hold_even_for_settings_that_check_refuses) {
    // Each of these in turn, in every setting: no force is larger than the device's limit.
    for (const double bad : {not_a_number, infinity, -infinity, -1.0, 1e300, 0.0}) {
        for (int which = 0; which < 9; ++which) {
            ForceSettings s;
            DeviceLimits limits;
            double* const settings[] = {&s.stiffness,   &s.damping,     &s.viscosity,
                                        &s.limit,       &s.rate_limit,  &s.ramp,
                                        &s.stale_after, &s.magnet.peak, &limits.maximum_force};
            *settings[which] = bad;
            const double device = limits.maximum_force > 0 ? limits.maximum_force : 0;
            ForceState state;
            for (int i = 0; i < 600; ++i) {
                const ForceResult r =
                    render_force(state, s, limits, pressing(i * period, Vec3(0, 0, i * 0.1)));
                ASSERT_TRUE(r.force.allFinite()) << bad << " in " << which;
                ASSERT_LE(r.force.norm(), std::min(device, 3.3 + 1e9 * (which == 3)) * rounding)
                    << bad << " in " << which;
                if (which > 2) {
                    ASSERT_GE(r.force[2], 0) << "pulls in: " << bad << " in " << which;
                }
            }
        }
    }
}

TEST(Force, the_smaller_of_the_two_maxima_holds_and_the_direction_stays) {
    for (const auto& [asked, device] : {std::pair{2.0, 3.3}, {5.0, 3.3}, {0.0, 3.3}}) {
        Running running;
        running.settings.limit = asked;
        running.limits.maximum_force = device;
        ForceResult r;
        for (int i = 0; i < 500; ++i) {
            r = running.step(pressing(running.time += period, Vec3(60, 0, 80)));
        }
        EXPECT_NEAR((r.force - std::min(asked, device) * Vec3(0.6, 0, 0.8)).norm(), 0, 1e-12);
        EXPECT_TRUE(r.flags & force_limited);
    }
}

TEST(Force, a_limit_lowered_while_pressing_holds_at_once) {
    Running running;
    running.settings.rate_limit = 1;
    running.settings.limit = 0.1;
    EXPECT_LE(running.next().force.norm(), 0.1 * rounding);
}

TEST(Force, changes_no_faster_than_its_rate) {
    Running running;
    running.settings.rate_limit = 100;  // 0.1 N a tick
    for (int i = 1; i <= 10; ++i) {
        const ForceResult r = running.step(pressing(running.time += period, Vec3(0, 0, -2)));
        EXPECT_NEAR(r.force[2], 1 - 0.1 * i, 1e-9);
        EXPECT_TRUE(r.flags & force_rate_limited);
    }
    // Leaving contact is no stop: it falls by the rate too.
    Running leaving;
    leaving.settings.rate_limit = 100;
    ForceInput free = pressing(leaving.time + period);
    free.constrained = false;
    EXPECT_NEAR(leaving.step(free).force[2], 0.9, 1e-9);
}

TEST(Force, begins_at_zero_and_ramps_up) {
    ForceState state;
    const ForceSettings settings;
    for (int i = 0; i <= 300; ++i) {
        const ForceResult r =
            render_force(state, settings, DeviceLimits{}, pressing(7 + i * period));
        ASSERT_NEAR(r.force[2], std::min(1.0, i * period / 0.25), 1e-9);
    }
}

TEST(Force, any_doubt_about_the_input_stops_it_at_once_and_the_ramp_begins_anew) {
    const auto broken = [](auto&& change) {
        Running running;
        ForceInput input = pressing(running.time + period);
        change(input);
        return std::pair{running, input};
    };
    const auto expect = [&](unsigned why, auto&& change) {
        auto [running, input] = broken(change);
        expect_stop_and_ramp(running, input, why);
    };
    expect(force_stale, [](ForceInput& i) { i.valid = false; });
    expect(force_off, [](ForceInput& i) { i.enabled = false; });
    expect(force_stale, [](ForceInput& i) { i.time -= period; });      // stands still
    expect(force_stale, [](ForceInput& i) { i.time -= 2 * period; });  // goes back
    expect(force_stale, [](ForceInput& i) { i.time = -1e300; });
    for (const double bad : {not_a_number, infinity, -infinity}) {
        expect(force_not_finite, [=](ForceInput& i) { i.time = bad; });
        for (int axis = 0; axis < 3; ++axis) {
            expect(force_not_finite, [=](ForceInput& i) { i.hand[axis] = bad; });
            expect(force_not_finite, [=](ForceInput& i) { i.pull[axis] = bad; });
            expect(force_not_finite, [=](ForceInput& i) { i.texture_slope[axis] = bad; });
        }
    }
    for (int axis = 0; axis < 3; ++axis) {
        expect(force_not_finite, [=](ForceInput& i) { i.pull[axis] = 1e300; });
    }
}

TEST(Force, a_normal_that_is_not_finite_stops_the_magnet) {
    for (const double bad : {not_a_number, infinity}) {
        Running running;
        running.settings.magnet = {2, 0.5};
        ForceInput input = pressing(running.time + period);
        input.constrained = false;
        input.surface_distance = 1;
        input.normal = Vec3(0, bad, 0);
        expect_stop_and_ramp(running, input, force_not_finite);
    }
}

TEST(Force, a_pause_longer_than_stale_begins_a_ramp_and_a_shorter_one_does_not) {
    Running running;
    running.time += 0.019;
    EXPECT_EQ(running.next().flags, 0);  // 20 ms less rounding: no pause
    Running paused;
    paused.time += 0.021;
    const ForceResult r = paused.next();
    EXPECT_EQ(r.force, Vec3::Zero());
    EXPECT_TRUE(r.flags & force_stale);
    EXPECT_TRUE(r.flags & force_ramping);
    for (int i = 1; i < 240; ++i) ASSERT_NEAR(paused.next().force[2], i * period / 0.25, 1e-9);
    Running ages;
    ages.time = 1e300;
    EXPECT_EQ(ages.next().force, Vec3::Zero());
}

TEST(Force, a_velocity_from_before_a_pause_is_forgotten) {
    Running running;
    running.settings.viscosity = 0.002;
    for (int i = 0; i < 100; ++i) {
        ForceInput in = pressing(running.time += period);
        in.hand = Vec3(i * 0.1, 0, 0);
        running.step(in);
    }
    running.time += 1;
    ForceInput in = pressing(running.time);
    in.hand = Vec3(500, 0, 0);  // elsewhere by now
    running.step(in);
    EXPECT_EQ(running.state.velocity, Vec3::Zero());
}

TEST(Force, off_stays_zero_and_on_again_ramps) {
    Running running;
    for (int i = 0; i < 50; ++i) {
        ForceInput in = pressing(running.time += period);
        in.enabled = false;
        const ForceResult r = running.step(in);
        ASSERT_EQ(r.force, Vec3::Zero());
        ASSERT_EQ(r.flags, force_off);
    }
    EXPECT_EQ(running.next().force, Vec3::Zero());
    EXPECT_NEAR(running.next().force[2], period / 0.25, 1e-9);
}

TEST(Force, each_bad_setting_is_refused_by_name_with_its_range) {
    struct Case {
        const char* name;
        double ForceSettings::*setting;
        std::vector<double> bad;
    };
    const std::vector<double> usual{not_a_number, -1, infinity, -infinity};
    const Case cases[] = {
        {"stiffness",
         &ForceSettings::stiffness,
         {not_a_number, -1, infinity, -infinity, 5.01, 1e300}},
        {"damping", &ForceSettings::damping, {not_a_number, -1, infinity, 0.0025}},
        {"viscosity", &ForceSettings::viscosity, {not_a_number, -1, infinity, 0.0025}},
        {"force limit", &ForceSettings::limit, usual},
        {"force rate limit", &ForceSettings::rate_limit, {not_a_number, -1, 0, -infinity}},
        {"force ramp", &ForceSettings::ramp, usual},
        {"stale time", &ForceSettings::stale_after, {not_a_number, -1, 0, -infinity}},
    };
    for (const Case& c : cases) {
        for (const double bad : c.bad) {
            ForceSettings settings;
            settings.*c.setting = bad;
            const std::string why = refusal(settings);
            EXPECT_NE(why.find(c.name), std::string::npos) << bad << ": " << why;
            EXPECT_NE(why.find("must be"), std::string::npos) << why;
        }
    }
}

TEST(Force, bad_magnets_textures_and_devices_are_refused_by_name) {
    const auto expect = [](const char* name, auto&& change) {
        ForceSettings settings;
        DeviceLimits limits;
        change(settings, limits);
        const std::string why = refusal(settings, limits);
        EXPECT_NE(why.find(name), std::string::npos) << why;
    };
    using S = ForceSettings;
    using D = DeviceLimits;
    for (const double bad : {not_a_number, -1.0, infinity}) {
        expect("magnet distance", [=](S& s, D&) { s.magnet.distance = bad; });
        expect("magnet peak", [=](S& s, D&) { s.magnet.peak = bad; });
        expect("texture amplitude", [=](S& s, D&) { s.texture.amplitude = bad; });
        expect("texture wavelength", [=](S& s, D&) { s.texture.wavelength = bad; });
        expect("maximum force", [=](S&, D& d) { d.maximum_force = bad; });
        expect("physical damping", [=](S&, D& d) { d.physical_damping = bad; });
        expect("rate [Hz]", [=](S&, D& d) { d.rate = bad; });
    }
    expect("texture wavelength", [](S& s, D&) { s.texture.wavelength = 0; });
    expect("maximum force", [](S&, D& d) { d.maximum_force = 0; });
    expect("rate [Hz]", [](S&, D& d) { d.rate = 0.5; });
    expect("magnet peak", [](S& s, D&) { s.magnet = {0.1, 0.2}; });  // 8 N/mm where steepest
    expect("accepted", [](S& s, D&) { s.magnet = {0.2, 0.2}; });
    expect("accepted", [](S& s, D&) { s.rate_limit = s.stale_after = infinity; });
}

TEST(Force, a_refusal_says_the_value_and_what_would_do) {
    ForceSettings settings;
    settings.stiffness = 7;
    EXPECT_EQ(refusal(settings),
              "stiffness [N/mm] = 7: must be at most 5 at 1000 Hz to be rendered stably");
    settings.stiffness = 0.5;
    settings.damping = 3e-9;
    settings.viscosity = -2e-9;
    EXPECT_NE(refusal(settings).find("-2e-09"), std::string::npos) << refusal(settings);
}

TEST(Force, greatest_stiffness_is_what_a_sampled_spring_may_be) {
    DeviceLimits limits;
    limits.rate = 1000;
    limits.physical_damping = 2.5e-3;
    EXPECT_DOUBLE_EQ(greatest_stiffness(limits, 0), 5);
    EXPECT_DOUBLE_EQ(greatest_stiffness(limits, 1e-3), 3);
    EXPECT_EQ(greatest_stiffness(limits, 1), 0);
    limits.rate = 500;
    EXPECT_DOUBLE_EQ(greatest_stiffness(limits, 0), 2.5);
    ForceSettings settings;
    settings.stiffness = 3;
    EXPECT_NE(refusal(settings, limits).find("at most 2.5 at 500 Hz"), std::string::npos);
    // Damping and viscosity use up what the device gives.
    settings.stiffness = 1.5;
    settings.damping = 0.0005;
    settings.viscosity = 0.0005;
    EXPECT_EQ(refusal(settings, limits), "accepted");
    settings.stiffness = 1.501;
    EXPECT_NE(refusal(settings, limits).find("stiffness"), std::string::npos);
}
