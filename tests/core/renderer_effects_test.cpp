// Renderer: the force effects through render(), and properties that a servo loop relies on.
#include <gtest/gtest.h>

#include <cmath>

#include "palpate/renderer.hpp"
#include "palpate/scenes/volumes.hpp"
#include "support/allocation_counter.hpp"
#include "support/constants.hpp"
#include "support/hand.hpp"
#include "support/press.hpp"

using namespace palpate;
using namespace palpate::support;

namespace {

RendererSettings everything(const Field& field) {
    RendererSettings settings;
    settings.proxy.friction = {0.4, 0.3};
    const std::array<DensityRange, 2> ranges{{{60, 110}, {150, 220}}};
    settings.penetrability = penetrability_ranges(0.3, ranges, field.solid());
    settings.force.stiffness = 1;
    settings.force.damping = 0.0003;
    settings.force.viscosity = 0.0003;
    settings.force.magnet = {0.5, 0.2};
    settings.force.texture = {0.05, 1.5};
    settings.transform = {oblique_direction(), Vec3(1, 2, 3), 1.3};
    return settings;
}

/// A hand over the field, as device states.
class DeviceHand {
  public:
    DeviceHand(const Field& field, const DeviceTransform& transform, std::uint64_t seed)
        : hand_(field.geometry(), seed, {8, 1, 0, 1, 1, 2}), transform_(transform) {}
    TickInput next() {
        return {period * ++i_, device_from_physical(transform_, hand_.next()), true};
    }

  private:
    Hand hand_;
    DeviceTransform transform_;
    int i_ = 0;
};

void expect_same(const Tick& a, const Tick& b, int i) {
    ASSERT_EQ(a.time, b.time) << i;
    ASSERT_EQ(a.force, b.force) << i;
    ASSERT_EQ(a.force_flags, b.force_flags) << i;
    ASSERT_EQ(a.proxy.scp, b.proxy.scp) << i;
    ASSERT_EQ(a.proxy.isovalue, b.proxy.isovalue) << i;
    ASSERT_EQ(a.proxy.density, b.proxy.density) << i;
    ASSERT_EQ(a.proxy.mode, b.proxy.mode) << i;
}

}  // namespace

TEST(Renderer, does_not_allocate_with_every_effect_on) {
    const Field field = noise_field().field;
    const RendererSettings settings = everything(field);
    Renderer renderer = make_renderer(field, 128, settings);
    DeviceHand hand(field, settings.transform, 1);
    int constrained = 0, free_with_force = 0, presses = 0;
    const StepObserver observer{
        [](const Step& s, void* to) { *static_cast<int*>(to) += s.kind == StepKind::press; },
        &presses};
    delete new int;
    const std::int64_t before = allocation_count();
    for (int i = 0; i < scaled(100000); ++i) {
        TickInput device = hand.next();
        if (i % 1000 == 999) device.position[0] = std::numeric_limits<double>::quiet_NaN();
        if (i % 1500 == 0) renderer.proxy.isovalue = 60 + i % 160;
        const Tick at = render(renderer, device, observer);
        constrained += at.proxy.mode == Mode::constrained;
        free_with_force += at.proxy.mode == Mode::free && at.force.norm() > 0.01;
    }
    EXPECT_EQ(allocation_count(), before);
    EXPECT_GT(before, 0) << "the counter does not count";
    EXPECT_GT(constrained, scaled(20000));
    EXPECT_GT(free_with_force, scaled(1000));
    EXPECT_GT(presses, scaled(1000));
}

TEST(Renderer, is_deterministic_and_a_copy_continues_identically) {
    const Field field = noise_field().field;
    const RendererSettings settings = everything(field);
    Renderer first = make_renderer(field, 128, settings);
    Renderer second = make_renderer(field, 128, settings);
    Renderer copy = first;
    DeviceHand hand(field, settings.transform, 2);
    for (int i = 0; i < scaled(20000); ++i) {
        if (i % 5000 == 2500) copy = first;
        const TickInput device = hand.next();
        const Tick a = render(first, device);
        expect_same(a, render(second, device), i);
        if (i >= scaled(2500) && i >= 2500) expect_same(a, render(copy, device), i);
        if (testing::Test::HasFatalFailure()) return;
    }
}

TEST(Renderer, holds_the_limits_with_every_effect_on) {
    const Field field = noise_field().field;
    RendererSettings settings = everything(field);
    settings.force.limit = 0.25;
    settings.force.rate_limit = 50;
    Renderer renderer = make_renderer(field, 128, settings);
    DeviceHand hand(field, settings.transform, 3);
    Vec3 last = Vec3::Zero();
    int limited = 0;
    for (int i = 0; i < scaled(50000); ++i) {
        const Tick at = render(renderer, hand.next());
        ASSERT_LE(at.force.norm(), 0.25 * (1 + 1e-12));
        if (!at.force.isZero(0)) {
            ASSERT_LE((at.force - last).norm(), 0.05 * (1 + 1e-9)) << i;
        }
        limited += bool(at.force_flags & force_limited);
        last = at.force;
    }
    EXPECT_GT(limited, scaled(1000));
}

TEST(Renderer, with_penetrability_the_spring_never_exceeds_k_times_the_threshold) {
    const Field field = noise_field().field;
    for (const double scale : {0.5, 3.0}) {
        RendererSettings settings = at_once();
        settings.force.stiffness = 0.8;
        settings.penetrability = penetrability_threshold(0.4, 100);
        settings.transform.scale = scale;
        Renderer renderer = make_renderer(field, 128, settings);
        DeviceHand hand(field, settings.transform, 4);
        int at_most = 0;
        for (int i = 0; i < scaled(20000); ++i) {
            const Tick t = render(renderer, hand.next());
            ASSERT_LE(t.force.norm(), 0.8 * 0.4 * (1 + 1e-12)) << i;
            at_most += t.force.norm() > 0.8 * 0.4 * 0.999;
        }
        EXPECT_GT(at_most, scaled(1000));
    }
}

TEST(Renderer, past_the_last_range_of_interest_there_is_no_force_and_nothing_not_finite) {
    RendererSettings settings = at_once();
    settings.force.magnet = {1, 0.3};
    settings.force.texture = {0.1, 2};
    const std::array<DensityRange, 1> ranges{{{10, 20}}};
    settings.penetrability = penetrability_ranges(1, ranges);
    Renderer renderer = make_renderer(ramp_field(), 10, settings);
    int i = 0;
    for (double z = 0; z < 95; z += 0.05, ++i) {
        const Tick at = render(renderer, {i * period, at_depth(z), true});
        ASSERT_TRUE(at.force.allFinite() && at.proxy.scp.allFinite());
        ASSERT_FALSE(std::isnan(at.proxy.isovalue) || std::isnan(at.proxy.density));
        ASSERT_EQ(at.force_flags & (force_not_finite | force_stale), 0);
        if (z > 21.1) {
            ASSERT_EQ(at.force, Vec3::Zero()) << z;
            ASSERT_EQ(at.proxy.isovalue, infinity);
        }
    }
    // And back: the range is felt again.
    render(renderer, {i++ * period, at_depth(15), true});
    const Tick again = render(renderer, {i * period, at_depth(15.5), true});
    EXPECT_NEAR(again.force.norm(), 0.25, 1e-9);  // turned by the texture
}

TEST(Renderer, friction_sticks_up_to_the_static_cone_and_then_trails_at_the_dynamic_one) {
    RendererSettings settings = at_once();
    settings.proxy.friction = {0.6, 0.25};
    Renderer renderer = make_renderer(ramp_field(), 30, settings);
    double time = 0;
    const auto at = [&](double x) {
        return render(renderer, {time += period, Vec3(2 + x, 4, 31), true});
    };
    render(renderer, {time, Vec3(2, 4, 29), true});
    const Vec3 start = at(0).proxy.scp;
    for (double x = 0; x < 0.59; x += 0.01) {
        const Tick stuck = at(x);
        ASSERT_NEAR((stuck.proxy.scp - start).norm(), 0, 1e-9) << x;
        ASSERT_NEAR(stuck.force[0], -0.5 * x, 1e-9);
    }
    for (double x = 0.61; x < 4; x += 0.01) {
        const Tick slid = at(x);
        ASSERT_NEAR(slid.proxy.scp[0], 2 + x - 0.25, 1e-9) << x;
        ASSERT_NEAR(slid.force[0], -0.5 * 0.25, 1e-9);
        ASSERT_NEAR(slid.force[2], -0.5, 1e-9);
    }
    // Resting: the pull is within the static cone, it sticks again when the hand turns.
    at(3.9);
    EXPECT_NEAR(at(3.7).proxy.scp[0], at(3.6).proxy.scp[0], 1e-9);
}

TEST(Renderer, the_magnet_draws_a_hand_onto_a_sphere_and_joins_the_contact_smoothly) {
    const scenes::Scene scene = scenes::make_volume("sphere:64x64x64", SampleType::float32);
    RendererSettings settings = at_once();
    settings.force.magnet = {3, 0.6};
    settings.transform = {oblique_direction(), Vec3(5, -6, 7), 2};
    Renderer renderer = make_renderer(linear_field(scene.volume), scene.isovalue, settings);
    const Vec3 along = Vec3(1, 0.4, -0.3).normalized();
    const Field field = linear_field(scene.volume);
    const RayHit surface = cast_ray(field, scene.isovalue, 31 * along, Vec3::Zero());
    ASSERT_TRUE(surface.hit);
    int i = 0;
    double peak = 0, peak_at = 0, last = 0;
    const Vec3 outward = settings.transform.rotation.transpose() * along;
    for (double d = 3.5; d > -0.2; d -= 0.005, ++i) {  // [device mm] above the surface
        const Vec3 hand = device_from_physical(settings.transform, surface.point + 2 * d * along);
        const Tick at = render(renderer, {i * period, hand, true});
        const double strength = at.force.norm();
        if (at.proxy.density == field.background()) continue;  // no gradient, no magnet
        if (d > 3.05) {
            EXPECT_EQ(strength, 0) << d;
        }
        if (d > 0.05 && d < 2.9) {
            const double along_d = d / 3;
            EXPECT_NEAR(strength, 0.6 * 4 * along_d * (1 - along_d), 0.05) << d;
            EXPECT_LT(at.force.dot(outward), -0.9 * strength) << "towards the surface";
            if (strength > peak) {
                peak = strength;
                peak_at = d;
            }
        }
        if (d < 0.05) {
            EXPECT_LT(strength, 0.13) << d;
        }
        if (d < 2.9 && d > -0.2) {
            EXPECT_LT(std::abs(strength - last), 0.06) << d;
        }
        last = strength;
    }
    EXPECT_NEAR(peak, 0.6, 1e-3);
    EXPECT_NEAR(peak_at, 1.5, 0.15);
}

TEST(Renderer, texture_is_fixed_in_physical_space_and_keeps_the_strength) {
    RendererSettings settings = at_once();
    settings.transform = {oblique_direction(), Vec3(4, 4, 20), 0.5};
    RendererSettings rough = settings;
    rough.force.texture = {0.2, 2.7};
    Renderer a = make_renderer(ramp_field(), 30, settings);
    Renderer b = make_renderer(ramp_field(), 30, rough);
    int turned = 0, i = 0;
    for (double x = 1; x < 7; x += 0.02, ++i) {
        const Vec3 hip(x, 3.3, i == 0 ? 29 : 30.6);
        const TickInput device{i * period, device_from_physical(settings.transform, hip), true};
        const Tick smooth = render(a, device);
        const Tick bumpy = render(b, device);
        ASSERT_EQ(smooth.proxy.scp, bumpy.proxy.scp);
        ASSERT_NEAR(smooth.force.norm(), bumpy.force.norm(), 1e-12);
        if (i == 0) continue;
        const Vec3 force = settings.transform.rotation * bumpy.force;
        Vec3 slope = texture_slope(rough.force.texture, bumpy.proxy.scp);
        slope[2] = 0;  // the surface is level
        ASSERT_NEAR((force.head<2>() / force[2] - slope.head<2>()).norm(), 0, 1e-9);
        turned += slope.norm() > 0.1;
    }
    EXPECT_GT(turned, 100);
}
