// Renderer: device state in, force and proxy out, spaces, broken input, changes while running.
#include "palpate/renderer.hpp"
#include "palpate/baselines/methods.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "support/constants.hpp"
#include "support/hand.hpp"
#include "support/press.hpp"

using namespace palpate;
using namespace palpate::support;

namespace {

DeviceTransform oblique(double scale) {
    return {oblique_direction(), Vec3(3, -40, 12), scale};
}

bool same_proxy(const Proxy& a, const Proxy& b) {
    return same_tetrahedron(a.scp.tetrahedron, b.scp.tetrahedron) && a.scp.folded == b.scp.folded &&
           a.scp_physical == b.scp_physical && a.isovalue == b.isovalue && a.mode == b.mode &&
           a.placed == b.placed && a.sliding == b.sliding && a.recovery_reach == b.recovery_reach;
}

/// A renderer whose hand rests at a depth of the ramp, past the force's ramp.
struct Resting {
    Renderer renderer;
    Vec3 hand;
    double time = 0;

    explicit Resting(const RendererSettings& settings, double isovalue = 30, double depth = 31)
        : renderer(make_renderer(ramp_field(), isovalue, settings)), hand(at_depth(depth)) {
        render(renderer, {time, at_depth(isovalue - 1), true});
        for (int i = 0; i < 400; ++i) next();
    }
    Tick next() { return render(renderer, {time += period, hand, true}); }
};

void expect_refused(const char* part, auto&& change) {
    RendererSettings settings;
    change(settings);
    try {
        make_renderer(ramp_field(), 30, settings);
        ADD_FAILURE() << "accepted: " << part;
    } catch (const std::invalid_argument& error) {
        EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
    }
}

}  // namespace

TEST(Renderer, transform_goes_there_and_back) {
    Random random(1);
    for (const double scale : {1e-3, 0.5, 1.0, 3.0, 1e3}) {
        const DeviceTransform transform = oblique(scale);
        EXPECT_EQ(physical_from_device(transform, Vec3::Zero()), transform.translation);
        for (int i = 0; i < 100; ++i) {
            const Vec3 device = random.point(-200, 200);
            const Vec3 physical = physical_from_device(transform, device);
            EXPECT_NEAR((device_from_physical(transform, physical) - device).norm(), 0,
                        1e-12 * (200 + transform.translation.norm() / scale));
            EXPECT_NEAR((physical - transform.translation).norm(), scale * device.norm(), 1e-9);
        }
    }
}

TEST(Renderer, force_is_equation_4_in_device_millimetres_and_device_axes) {
    const Field field = ramp_field();
    for (const double voxels : {0.5, 1.0, 3.0, 0.4}) {
        RendererSettings settings = at_once();
        settings.force.stiffness = 0.7;
        settings.transform = oblique(voxels * field.geometry().spacing.minCoeff());
        Renderer renderer = make_renderer(field, 30, settings);
        const auto at = [&](double t, double z) {
            const Vec3 device = device_from_physical(settings.transform, at_depth(z));
            return render(renderer, {t, device, true});
        };
        EXPECT_EQ(at(0, 20).force, Vec3::Zero());
        const Tick pressed = at(period, 31.5);
        EXPECT_NEAR((pressed.proxy.scp - at_depth(30)).norm(), 0, 1e-9);
        const Vec3 outward = settings.transform.rotation.transpose() * Vec3(0, 0, -1);
        EXPECT_NEAR((pressed.force - 0.7 * 1.5 / voxels * outward).norm(), 0, 1e-9);
        EXPECT_EQ(pressed.force_flags, 0);
        EXPECT_EQ(pressed.time, period);
        EXPECT_EQ(pressed.update_ns, 0);  // no clock was given
    }
}

TEST(Renderer, a_clock_times_the_proxy_update_and_changes_nothing_else) {
    static int reads = 0;
    const Clock seven_a_read = []() noexcept -> std::int64_t { return 7 * ++reads; };
    Renderer plain = make_renderer(ramp_field(), 30), timed = plain;
    for (int i = 0; i < 100; ++i) {
        const TickInput device{i * period, at_depth(28 + 0.05 * i)};
        const Tick one = render(plain, device), other = render(timed, device, {}, seven_a_read);
        ASSERT_EQ(one.update_ns, 0);
        ASSERT_EQ(other.update_ns, 7);
        ASSERT_EQ(reads, 2 * (i + 1));
        ASSERT_EQ(one.proxy.scp, other.proxy.scp);
        ASSERT_EQ(one.force, other.force);
        ASSERT_EQ(one.force_flags, other.force_flags);
    }
}

TEST(Renderer, the_proxy_is_the_methods_own_for_every_method) {
    const TestField noise = noise_field();
    for (const ProxyMethod method : {&update_exact, &baselines::update_paper}) {
        RendererSettings settings;
        settings.method = method;
        Renderer renderer = make_renderer(noise.field, noise.isovalue, settings);
        Proxy proxy;
        proxy.isovalue = noise.isovalue;
        Hand hand(noise.field.geometry(), 3);
        for (int i = 0; i < scaled(20000); ++i) {
            const Vec3 hip = hand.next();
            const Tick rendered = render(renderer, {i * period, hip, true});
            const ProxyUpdate direct = method(proxy, noise.field, hip, settings.proxy, {});
            ASSERT_EQ(rendered.proxy.scp, direct.scp) << i;
            ASSERT_EQ(rendered.proxy.mode, direct.mode);
            ASSERT_EQ(rendered.proxy.density, direct.density);
            ASSERT_EQ(rendered.proxy.tetrahedra, direct.tetrahedra);
            ASSERT_TRUE(same_proxy(renderer.proxy, proxy));
        }
    }
}

TEST(Renderer, a_broken_position_leaves_the_proxy_as_it_is_and_stops_the_force) {
    const std::vector<TickInput> broken{
        {0, {not_a_number, 4, 31}, true},  {0, {4, not_a_number, 31}, true},
        {0, {4, 4, not_a_number}, true},   {0, {infinity, 4, 31}, true},
        {0, {4, 4, -infinity}, true},      {0, {1e300, 4, 31}, true},
        {0, {4, 1e12, 31}, true},          {0, {4, 4, 5}, false},
        {0, {not_a_number, 4, 31}, false},
    };
    for (const TickInput& state : broken) {
        SCOPED_TRACE(state.position.transpose());
        Resting hand({});
        ASSERT_NEAR(hand.next().force[2], -0.5, 1e-9);
        const Proxy before = hand.renderer.proxy;
        TickInput device = state;
        device.time = hand.time += period;
        const Tick stopped = render(hand.renderer, device);
        EXPECT_EQ(stopped.force, Vec3::Zero());
        EXPECT_EQ(stopped.force_flags, force_stale);
        EXPECT_EQ(stopped.proxy.status, UpdateStatus::refused);
        EXPECT_EQ(stopped.proxy.scp, before.scp_physical);
        EXPECT_EQ(stopped.proxy.isovalue, before.isovalue);
        EXPECT_EQ(stopped.proxy.mode, before.mode);
        EXPECT_NEAR(stopped.proxy.density, 30, 1e-9);
        EXPECT_TRUE(same_proxy(hand.renderer.proxy, before));
        for (int i = 0; i < 240; ++i) {
            ASSERT_NEAR(hand.next().force[2], -0.5 * i * period / 0.25, 1e-9) << i;
        }
    }
}

TEST(Renderer, a_broken_position_before_the_first_good_one_is_harmless) {
    Renderer renderer = make_renderer(ramp_field(), 30);
    for (const bool valid : {true, false}) {
        const Tick first = render(renderer, {0, Vec3::Constant(not_a_number), valid});
        EXPECT_EQ(first.force, Vec3::Zero());
        EXPECT_TRUE(first.proxy.scp.allFinite());
        EXPECT_FALSE(renderer.proxy.placed);
    }
    EXPECT_EQ(render(renderer, {period, at_depth(20), true}).proxy.scp, at_depth(20));
}

TEST(Renderer, time_that_goes_wrong_stops_the_force_but_not_the_proxy) {
    for (const double bad : {not_a_number, infinity, -1e300, -1.0}) {
        Resting hand({});
        const Tick stopped = render(hand.renderer, {bad, at_depth(20), true});
        EXPECT_EQ(stopped.force, Vec3::Zero());
        EXPECT_NE(stopped.force_flags & (force_stale | force_not_finite), 0);
        EXPECT_EQ(stopped.proxy.scp, at_depth(20));
        EXPECT_EQ(hand.next().force, Vec3::Zero());
    }
}

TEST(Renderer, a_session_that_begins_inside_comes_out_and_ramps_up) {
    Renderer renderer = make_renderer(ramp_field(), 30);
    Tick at;
    for (int i = 0; i < 400; ++i) {
        at = render(renderer, {i * period, at_depth(32), true});
        ASSERT_LE(at.force.norm(), 1.0 * std::min(1.0, i * period / 0.25) + 1e-9);
    }
    EXPECT_NEAR((at.proxy.scp - at_depth(30)).norm(), 0, 1e-9);
    EXPECT_NEAR(at.force[2], -1, 1e-9);
}

TEST(Renderer, an_isovalue_changed_in_contact_changes_the_force_by_its_rate_only) {
    const TestField noise = noise_field();
    RendererSettings settings;
    settings.force.rate_limit = 200;
    settings.force.stiffness = 1;
    Renderer renderer = make_renderer(noise.field, noise.isovalue, settings);
    Hand hand(noise.field.geometry(), 5, {4, 0, 0, 1, 0, -2});
    Random random(6);
    Vec3 last = Vec3::Zero();
    int limited = 0, loud = 0;
    for (int i = 0; i < scaled(40000); ++i) {
        if (i % 50 == 0) renderer.proxy.isovalue = random.uniform(60, 220);
        const Tick at = render(renderer, {i * period, hand.next(), true});
        const bool stopped = at.force.isZero(0) && (at.force_flags & force_stale);
        if (!stopped) {
            ASSERT_LE((at.force - last).norm(), 0.2 * (1 + 1e-9)) << i;
        }
        limited += bool(at.force_flags & force_rate_limited);
        loud += at.force.norm() > 0.2;
        last = at.force;
    }
    EXPECT_GT(limited, scaled(400));
    EXPECT_GT(loud, scaled(400));
}

TEST(Renderer, while_the_proxy_is_still_inside_there_is_no_force) {
    Resting hand({});
    hand.renderer.proxy.isovalue = -1;  // below the background: all of space is solid
    for (int i = 0; i < 20; ++i) {
        const Tick at = hand.next();
        EXPECT_EQ(at.proxy.status, UpdateStatus::recovering);
        EXPECT_EQ(at.force, Vec3::Zero());
        EXPECT_EQ(at.force_flags, force_stale);
    }
    hand.renderer.proxy.isovalue = 30;
    EXPECT_EQ(hand.next().force, Vec3::Zero());
    for (int i = 0; i < 300; ++i) hand.next();
    EXPECT_NEAR(hand.next().force[2], -0.5, 1e-9);
}

TEST(Renderer, switched_off_the_proxy_follows_without_a_force) {
    Resting hand({});
    hand.renderer.settings.forces_on = false;
    hand.hand = at_depth(31) + Vec3(1, 0, 0);
    const Tick off = hand.next();
    EXPECT_EQ(off.force, Vec3::Zero());
    EXPECT_EQ(off.force_flags, force_off);
    EXPECT_NEAR((off.proxy.scp - at_depth(30) - Vec3(1, 0, 0)).norm(), 0, 1e-9);
    hand.renderer.settings.forces_on = true;
    EXPECT_EQ(hand.next().force, Vec3::Zero());
    EXPECT_GT(hand.next().force.norm(), 0);
}

TEST(Renderer, refuses_settings_that_cannot_be_rendered) {
    expect_refused("method", [](RendererSettings& s) { s.method = nullptr; });
    expect_refused("stiffness", [](RendererSettings& s) { s.force.stiffness = 100; });
    expect_refused("step budget", [](RendererSettings& s) { s.proxy.step_budget = 0; });
    for (const Friction& bad : {Friction{-1, 0}, Friction{0.1, 0.2}, Friction{not_a_number, 0},
                                Friction{0.5, not_a_number}, Friction{infinity, 0}}) {
        expect_refused("friction", [&](RendererSettings& s) { s.proxy.friction = bad; });
        expect_refused("friction", [&](RendererSettings& s) { s.proxy.behind = bad; });
    }
    for (const double bad : {not_a_number, infinity, 0.0, -1.0}) {
        expect_refused("scale", [=](RendererSettings& s) { s.transform.scale = bad; });
    }
    for (int i = 0; i < 9; ++i) {
        for (const double bad : {not_a_number, infinity, 0.7}) {
            expect_refused("rotation",
                           [=](RendererSettings& s) { s.transform.rotation(i / 3, i % 3) = bad; });
        }
    }
    // Closing the clutch would turn one of its axes over, and a tool has no mirrored orientation.
    expect_refused("mirror", [](RendererSettings& s) { s.transform.rotation(1, 1) = -1; });
    for (int i = 0; i < 3; ++i) {
        expect_refused("translation",
                       [=](RendererSettings& s) { s.transform.translation[i] = not_a_number; });
    }
    expect_refused("ranges", [](RendererSettings& s) {
        s.penetrability.on = true;
        s.penetrability.range_count = 99;
    });
    expect_refused("order", [](RendererSettings& s) {
        const std::array<DensityRange, 2> ranges{{{1, 2}, {3, 4}}};
        s.penetrability = penetrability_ranges(1, ranges, Solid::below);
    });
    EXPECT_THROW(make_renderer(ramp_field(), not_a_number), std::invalid_argument);
    EXPECT_NO_THROW(make_renderer(ramp_field(), infinity));
}

TEST(Renderer, warns_of_isovalues_with_nothing_to_feel_or_everything_solid) {
    const auto about = [](Solid solid, double isovalue, std::optional<double> background = {}) {
        const Field field = linear_field(ramp_field(solid).volume(), solid, background);
        const std::string text = isovalue_warning(field, isovalue);
        return text.empty()                                   ? "fine"
               : text.find("nothing") != std::string::npos    ? "nothing"
               : text.find("background") != std::string::npos ? "background"
                                                              : "?";
    };
    // The ramp: 0..100, background 0; below: -100..0, background 0.
    for (const auto& [side, sign] : {std::pair{Solid::above, 1}, {Solid::below, -1}}) {
        EXPECT_STREQ(about(side, sign * 50.0), "fine");
        EXPECT_STREQ(about(side, 0), "fine");
        EXPECT_STREQ(about(side, sign * 99.99), "fine");
        EXPECT_STREQ(about(side, sign * 100.0), "nothing");
        EXPECT_STREQ(about(side, sign * 1e6), "nothing");
        EXPECT_STREQ(about(side, sign * infinity), "nothing");
        EXPECT_STREQ(about(side, sign * -0.01), "background");
        EXPECT_STREQ(about(side, sign * 50.0, sign * 60.0), "background");
        EXPECT_STREQ(about(side, sign * 50.0, sign * 50.0), "fine");
        EXPECT_STREQ(about(side, sign * 150.0, sign * 200.0), "background");
    }
    // A beating heart: the first frame alone has nothing to feel at this level.
    const Volume first = ramp_field().volume();
    const Volume later =
        volume_of<float>(first.geometry(), [](const Index3& i) { return 2 * i[2]; });
    const std::vector<Frame> frames{{0, first}, {1, later}};
    EXPECT_EQ(isovalue_warning(linear_field(std::make_shared<const Samples>(frames)), 150), "");
}
