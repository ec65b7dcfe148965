// The device as the servo sees it: time, forces, scripts, options.
#include "devices/simulated/simulated.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>
#include <thread>
#include <vector>

#include "devices/link.hpp"
#include "devices/simulated/closed_loop.hpp"
#include "devices/simulated/profiles.hpp"
#include "palpate/io/error.hpp"
#include "palpate/scenes/motions.hpp"
#include "support/allocation_counter.hpp"
#include "support/random.hpp"
#include "support/scratch_folder.hpp"

namespace palpate::devices {
namespace {

using support::contains;
using support::message_of;

const Body& body() {
    static const Body one;
    return one;
}

/// A bare mass of 0.1 kg that nobody holds and nothing rounds: only forces move it.
const std::string loose =
    "omni,friction=no,encoder=0,force_step=0,hand_mass=0.055,hand_stiffness=0,hand_damping=0";

TEST(Simulated, is_always_found_and_names_its_options) {
    const DeviceFinding finding = find_simulated();
    EXPECT_TRUE(finding.found);
    EXPECT_EQ(finding.name, "simulated");
    EXPECT_TRUE(contains(finding.options, "omega3"));
    EXPECT_TRUE(contains(finding.options, "hold"));
    EXPECT_FALSE(contains(finding.options, "random"));
}

TEST(Simulated, starts_at_the_first_point_of_its_script_at_rest_whatever_the_time) {
    for (const double start : {0.0, 1234.5}) {
        const auto device = body().open("omni,hand=slide,encoder=0,seconds=2");
        const DeviceInfo info = device->info();
        const DeviceTransform transform = fit_workspace(body().field.geometry(), info);
        const auto motion = scenes::make_motion(
            "slide", body().field, body().scene.isovalue,
            {.duration_s = 2, .speed_mm_s = 50 * transform.scale, .depth_mm = 4 * transform.scale});
        const DeviceReading reading = device->read(start);
        EXPECT_EQ(reading.status, DeviceStatus::ready);
        EXPECT_EQ(reading.age, 0);
        EXPECT_LE((physical_from_device(transform, reading.position) - motion[0].position).norm(),
                  1e-9);
    }
}

TEST(Simulated, limits_pass_the_check_at_the_rated_stiffness_in_every_grip) {
    for (const std::string& name : profile_names()) {
        for (const std::string& hand : grip_names()) {
            const DeviceInfo info = body().open(name + ",grip=" + hand + ",seconds=1")->info();
            ForceSettings force;
            force.stiffness = info.stiffness;
            // In a light grip the delay of these takes a part of what they are rated for.
            const bool is_lowered = hand == "light" && (name == "falcon" || name == "premium6dof");
            EXPECT_EQ(stable(force, info.limits) != force, is_lowered) << name << hand;
            EXPECT_NO_THROW(check(stable(force, info.limits), info.limits)) << name << hand;
            EXPECT_EQ(info.limits.delay,
                      profile(name).delay + (profile(name).jitter ? exchange_delay(1e-3) : 0));
            EXPECT_EQ(info.limits.continuous_force, profile(name).continuous_force);
            EXPECT_EQ(info.limits.maximum_force, profile(name).maximum_force);
            EXPECT_EQ(info.limits.physical_damping, profile(name).damping + grip(hand).damping);
            EXPECT_TRUE(contains(info.model, hand));
        }
    }
}

TEST(Simulated, reads_whole_encoder_steps) {
    const auto device = body().open("touchx,hand=circle,encoder=0.25,seconds=2");
    int different = 0;
    Vec3 last = Vec3::Zero();
    for (int i = 0; i < 1000; ++i) {
        const Vec3 p = device->read(1e-3 * i).position;
        ASSERT_EQ(p, 0.25 * (p / 0.25).array().rint().matrix());
        different += p != last;
        last = p;
    }
    EXPECT_GT(different, 50);
}

TEST(Simulated, the_same_reads_and_writes_give_the_same_bits) {
    const std::string options = "touch,hand=explore,seconds=2,seed=";
    const auto one = body().open(options + "5"), two = body().open(options + "5");
    const auto other = body().open(options + "6");
    bool differs = false;
    for (int i = 0; i < 1500; ++i) {
        const double time = 1e-3 * i + (i % 7 == 0 ? 3e-4 : 0);
        const Vec3 a = one->read(time).position, b = two->read(time).position;
        ASSERT_EQ(a, b) << i;
        differs |= other->read(time).position != a;
        const Vec3 force(0.5 * (i % 3), -0.2 * (i % 5), 0.1);
        one->write({force}, time);
        two->write({force}, time);
    }
    EXPECT_TRUE(differs);
}

/// Place of a loose mass after `ticks` ms, if `force(i)` is written at the ms i.
template <class Force>
Vec3 moved(const std::string& options, int ticks, Force force) {
    const auto device = body().open(loose + options);
    const Vec3 start = device->read(0).position;
    device->write({force(0)}, 0);
    for (int i = 1; i <= ticks; ++i) {
        device->read(i / 1000.0);
        device->write({force(i)}, i / 1000.0);
    }
    return device->read(ticks / 1000.0).position - start;
}

TEST(Simulated, a_force_moves_the_mass_by_newtons_law) {
    const Vec3 way = moved(",delay=0", 100, [](int) { return Vec3(0, 2, 0); });
    // 2 N on 0.1 kg damped with 0.5e-3 N s/mm: m/B = 0.2 s.
    const double travelled = 2 / 0.5e-3 * (0.1 - 0.2 * (1 - std::exp(-0.1 / 0.2)));
    EXPECT_NEAR(way[1], travelled, 1e-3 * travelled);
}

TEST(Simulated, a_force_acts_exactly_its_delay_later) {
    const Vec3 push(0.5, 1, -2);
    const auto late = body().open(loose + ",delay=2.5");
    const Vec3 start = late->read(0).position;
    late->write({push}, 0);
    EXPECT_EQ(late->read(0.0025).position, start);
    EXPECT_NE(late->read(0.0026).position, start);
    const auto prompt = body().open(loose + ",delay=0");
    prompt->read(0);
    prompt->read(0.0025);
    prompt->write({push}, 0.0025);
    EXPECT_TRUE(
        (late->read(0.02).position - start).isApprox(prompt->read(0.02).position - start, 1e-9));
}

TEST(Simulated, gives_no_more_than_its_greatest_force) {
    const Vec3 most = moved("", 20, [](int) { return Vec3(0, 0, 3.3); });
    const Vec3 absurd = moved("", 20, [](int) { return Vec3(0, 0, 1e6); });
    EXPECT_TRUE(absurd.isApprox(most, 1e-12));
    EXPECT_GT(most[2], 1);
}

TEST(Simulated, rounds_forces_to_whole_steps) {
    const auto way = [](double newtons) {
        const auto device = body().open(
            "omni,friction=no,encoder=0,force_step=0.5,hand_stiffness=0,hand_damping=0");
        const Vec3 start = device->read(0).position;
        device->write({Vec3(newtons, 0, 0)}, 0);
        return Vec3(device->read(0.02).position - start);
    };
    EXPECT_EQ(way(0.24), Vec3(0, 0, 0));
    EXPECT_EQ(way(1.2), way(1.0));
    EXPECT_NE(way(1.3), way(1.0));
}

TEST(Simulated, a_force_that_is_too_old_is_none) {
    const auto once = [](int i) { return i == 0 ? Vec3(1, 0, 0) : Vec3(0, 0, 0); };
    const auto device = body().open(loose + ",delay=0");
    const auto told = body().open(loose + ",delay=0");
    const Vec3 start = device->read(0).position;
    told->read(0);
    device->write({Vec3(1, 0, 0)}, 0);
    told->write({Vec3(1, 0, 0)}, 0);
    for (int i = 1; i <= 60; ++i) {
        device->read(i / 1000.0);
        told->read(i / 1000.0);
        if (i == 20) told->write({Vec3(0, 0, 0)}, i / 1000.0);
    }
    const Vec3 way = device->read(0.06).position - start;
    EXPECT_TRUE(way.isApprox(told->read(0.06).position - start, 1e-9));
    EXPECT_GT(way[0], moved(",delay=0", 60, once)[0]);
    EXPECT_LT(way[0], 0.9 * moved(",delay=0", 60, [](int) { return Vec3(1, 0, 0); })[0]);
}

TEST(Simulated, a_force_that_is_not_finite_is_none) {
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(moved("", 20, [=](int) { return Vec3(1, nan, 0); }), Vec3(0, 0, 0));
}

TEST(Simulated, no_force_after_stop_not_even_one_under_way) {
    const auto device = body().open(loose + ",delay=5");
    const Vec3 start = device->read(0).position;
    device->write({Vec3(1, 0, 0)}, 0);
    device->stop();
    for (int i = 1; i < 50; ++i) {
        ASSERT_EQ(device->read(i / 1000.0).position, start);
        device->write({Vec3(1, 0, 0)}, i / 1000.0);
    }
}

TEST(Simulated, may_be_stopped_from_another_thread) {
    const auto device = body().open(loose);
    device->read(0);
    std::jthread other([&] { device->stop(); });
    for (int i = 1; i < 200; ++i) {
        device->write({Vec3(1, 0, 0)}, i / 1000.0);
        device->read(i / 1000.0);
    }
    other.join();
    // Friction is off: what it still travels it travels by its momentum, ever more slowly.
    Vec3 before = device->read(0.2).position, step = Vec3::Constant(1e9);
    for (int i = 201; i < 260; ++i) {
        device->write({Vec3(1, 0, 0)}, i / 1000.0);
        const Vec3 now = device->read(i / 1000.0).position;
        ASSERT_LE((now - before).norm(), step.norm() + 1e-9);
        step = now - before;
        before = now;
    }
}

TEST(Simulated, a_gap_is_caught_up_by_50_ms_and_the_rest_skipped) {
    const std::string options = "omni,hand=circle,speed=200,seconds=5,encoder=0";
    const auto stalled = body().open(options), steady = body().open(options);
    const auto endless = body().open(options);
    for (int i = 0; i <= 1000; ++i) {
        for (const auto& device : {&stalled, &steady, &endless}) (*device)->read(i / 1000.0);
    }
    const Vec3 before = steady->read(1).position;
    const Vec3 after = steady->read(1.05).position;
    EXPECT_GT((after - before).norm(), 1);
    EXPECT_EQ(stalled->read(11).position, after);
    EXPECT_EQ(endless->read(1e12).position, after);
    EXPECT_LE((stalled->read(11.001).position - steady->read(1.051).position).norm(), 1e-6);
}

TEST(Simulated, in_a_short_gap_nothing_is_lost) {
    const std::string options = "omni,hand=circle,speed=200,seconds=5,encoder=0";
    const auto stalled = body().open(options), steady = body().open(options);
    stalled->read(0);
    for (int i = 0; i <= 48; ++i) steady->read(i / 1000.0);
    EXPECT_LE((stalled->read(0.048).position - steady->read(0.048).position).norm(), 1e-6);
}

TEST(Simulated, a_time_that_stands_or_goes_back_or_is_not_finite_moves_nothing) {
    const auto device = body().open("omni,hand=circle,seconds=5,encoder=0");
    device->read(0);
    const Vec3 there = device->read(0.04).position;
    EXPECT_EQ(device->read(0.04).position, there);
    EXPECT_EQ(device->read(0.01).position, there);
    EXPECT_EQ(device->read(std::numeric_limits<double>::quiet_NaN()).position, there);
    EXPECT_EQ(device->read(std::numeric_limits<double>::infinity()).position, there);
    EXPECT_NE(device->read(0.08).position, there);
}

TEST(Simulated, is_finished_after_its_seconds_unless_it_loops) {
    const auto once = body().open("omni,hand=press,seconds=0.5");
    const auto again = body().open("omni,hand=press,seconds=0.5,loop=yes");
    for (int i = 0; i <= 2000; ++i) {
        const double time = i / 1000.0;
        const DeviceStatus status = once->read(time).status;
        if (i < 500) {
            ASSERT_EQ(status, DeviceStatus::ready) << i;
        } else if (i > 501) {
            ASSERT_EQ(status, DeviceStatus::finished) << i;
        }
        ASSERT_EQ(again->read(time).status, DeviceStatus::ready) << i;
    }
}

TEST(Simulated, a_loop_goes_there_and_back_without_a_jump) {
    for (const char* motion : {"slide", "explore", "tap"}) {
        const auto device = body().open(std::string("omega3,encoder=0,friction=no,seconds=1,"
                                                    "loop=yes,speed=100,hand=") +
                                        motion);
        const Vec3 start = device->read(0).position;
        Vec3 last = start;
        double farthest = 0;
        for (int i = 1; i <= 4000; ++i) {
            const Vec3 now = device->read(i / 1000.0).position;
            ASSERT_LE((now - last).norm(), 0.2) << motion << i;  // 100 mm/s, and swings
            farthest = std::max(farthest, (now - start).norm());
            last = now;
        }
        EXPECT_GT(farthest, 5) << motion;
        EXPECT_LT((last - start).norm(), 2) << motion;
    }
}

TEST(Simulated, follows_the_way_back_as_closely_as_the_way_there) {
    const auto device = body().open("omni,encoder=0,friction=no,hand=slide,seconds=1,loop=yes");
    device->read(0);
    for (int i = 1; i < 800; ++i) device->read(i / 1000.0);
    const Vec3 there = device->read(0.8).position;
    for (int i = 801; i < 1200; ++i) device->read(i / 1000.0);
    const Vec3 back = device->read(1.2).position;
    // What the device damps holds it back both ways: 2 x 0.5e-3 N s/mm x 50 mm/s / 0.3 N/mm.
    EXPECT_NEAR((there - back).norm(), 0.17, 0.1);
}

TEST(Simulated, goes_as_deep_as_the_hand_is_told_if_nothing_pushes_back) {
    const auto device = body().open("omni,hand=hold,depth=3,seconds=4,friction=no,encoder=0");
    const DeviceTransform transform = fit_workspace(body().field.geometry(), device->info());
    Vec3 hand;
    for (int i = 0; i <= 4000; ++i) hand = device->read(i / 1000.0).position;
    const Vec3 physical = physical_from_device(transform, hand);
    double inside = 1, outside = 3;  // times the distance from the centre
    for (int i = 0; i < 60; ++i) {
        const double middle = 0.5 * (inside + outside);
        const bool solid = body().scene.exact(middle * physical) > body().scene.isovalue;
        (solid ? inside : outside) = middle;
    }
    EXPECT_NEAR((inside - 1) * physical.norm() / transform.scale, 3, 0.1);
}

TEST(Simulated, follows_a_file_in_physical_space) {
    const support::ScratchFolder folder;
    support::put_bytes(folder / "hand.csv", "t,x,y,z\n5,0,0,40\n5.5,0,30,40\n9,0,30,40\n");
    const auto device =
        body().open("omni,friction=no,encoder=0,file=" + (folder / "hand.csv").string());
    const DeviceTransform transform = fit_workspace(body().field.geometry(), device->info());
    EXPECT_LE((physical_from_device(transform, device->read(0).position) - Vec3(0, 0, 40)).norm(),
              1e-9);
    for (int i = 1; i <= 3999; ++i) {
        ASSERT_EQ(device->read(i / 1000.0).status, DeviceStatus::ready);
    }
    const DeviceReading end = device->read(4.1);
    EXPECT_EQ(end.status, DeviceStatus::finished);
    EXPECT_LE((physical_from_device(transform, end.position) - Vec3(0, 30, 40)).norm(), 1e-3);
}

TEST(Simulated, every_motion_meets_the_body) {
    for (const char* motion : {"press", "slide", "circle", "tap", "explore", "hold"}) {
        const auto device = body().open(std::string("omni,seconds=3,hand=") + motion);
        double most = 0;
        RendererSettings settings;
        settings.transform = fit_workspace(body().field.geometry(), device->info());
        settings.device = device->info().limits;
        Renderer renderer = make_renderer(body().field, body().scene.isovalue, settings);
        for (int i = 0; i < 2900; ++i) {
            const double time = i / 1000.0;
            const Tick tick =
                render(renderer, {.time = time, .position = device->read(time).position});
            device->write({tick.force}, time);
            most = std::max(most, tick.force.norm());
        }
        EXPECT_GT(most, 0.3) << motion;
        EXPECT_LT(most, 3.3) << motion;
    }
}

TEST(Simulated, reads_and_writes_allocate_nothing) {
    const auto device = body().open("inverse3,hand=explore,seconds=2,loop=yes,delay=20");
    const std::int64_t before = support::allocation_count();
    Vec3 sum = Vec3::Zero();
    for (int i = 0; i < support::scaled(20000); ++i) {
        const double time = i / 1000.0 + (i > 100 ? 10 : 0);
        sum += device->read(time).position;
        device->write({Vec3(0.1, 0.2, 0.3)}, time);
    }
    EXPECT_EQ(support::allocation_count(), before);
    EXPECT_TRUE(sum.allFinite());
}

TEST(Simulated, options_that_cannot_be_meant_are_refused_in_one_line) {
    const auto refusal = [](const std::string& options) {
        return message_of<std::invalid_argument>([&] { body().open(options); });
    };
    EXPECT_TRUE(contains(refusal("phantom"), "profile=phantom: use one of omni, touch"));
    EXPECT_TRUE(contains(refusal("hand=random"), "use one of"));
    EXPECT_TRUE(contains(refusal("hand=approach"), "hold"));
    EXPECT_TRUE(contains(refusal("grip=tight"), "light, normal, firm"));
    EXPECT_TRUE(contains(refusal("delay=1000"), "from 0 to 100"));
    EXPECT_TRUE(contains(refusal("encoder=-1"), "from 0 to 5"));
    EXPECT_TRUE(contains(refusal("seconds=0"), "from 0.5 to 3600"));
    EXPECT_TRUE(contains(refusal("seed=1.5"), "whole number"));
    EXPECT_TRUE(contains(refusal("friction=maybe"), "yes, no"));
    EXPECT_TRUE(contains(refusal("file=x.csv,depth=3"), "depth= has no meaning with file="));
    EXPECT_TRUE(contains(refusal("mass=3"), "no option 'mass'"));
    for (const char* options : {"phantom", "delay=nan", "mass=3"}) {
        EXPECT_FALSE(contains(refusal(options), "\n"));
    }
}

TEST(Simulated, a_file_that_cannot_be_read_is_named) {
    EXPECT_TRUE(contains(message_of<io::InputError>([] { body().open("file=not_there.csv"); }),
                         "not_there.csv"));
}

}  // namespace
}  // namespace palpate::devices
