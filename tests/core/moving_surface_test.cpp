// The proxy while surfaces grow, shrink, move, appear and vanish under it: G1 for the field of each
// tick, the force within its limits, and the SCP where the analytic surface puts it.
#include <gtest/gtest.h>

#include "support/moving.hpp"

using namespace palpate;
using namespace palpate::support;

namespace {

constexpr double speed = 200;  // [mm/s] the fastest that is asked for: 0.2 mm a tick
constexpr double level = 100;

/// Density of a ball: its distance inwards, 10 a mm. `edge` [mm] is where it saturates.
double ball(const Vec3& p, const Vec3& centre, double radius, double edge = 1e9) {
    return level + 10 * std::clamp(radius - (p - centre).norm(), -edge, edge);
}

struct Off {
    double most = 0, sum = 0;
    int count = 0;
    void add(double error) {
        most = std::max(most, std::abs(error));
        sum += std::abs(error);
        ++count;
    }
    double mean() const { return count ? sum / count : 0; }
};

struct Passing {
    double radius = 10, beside = 4, edge = 1e9;
    double interval = 0.01;  // [s] between frames
    bool pushed = false;     // each frame as it comes, none between
};

/// A ball that comes from the left, passes over the hand at 20 cm/s and goes on to the right.
void let_pass(const Passing& passing, Off& radial, Off& tangential, MovingContact** out) {
    const Geometry geometry = grid({80, 40, 40});
    const Vec3 hand(40, 20 + passing.beside, 20);
    const auto centre = [](double t) { return Vec3(14 + speed * t, 20, 20); };
    constexpr double duration = 0.26;
    const auto frames = played(geometry, duration, passing.interval, [&](const Vec3& p, double t) {
        return ball(p, centre(t), passing.radius, passing.edge);
    });
    static MovingContact contact(frames, level, hand);
    contact = MovingContact(frames, level, hand);
    *out = &contact;
    contact.tick();
    EXPECT_EQ(contact.proxy().mode, Mode::free);
    if (!passing.pushed) apply(contact.session, command::Speed{1});
    bool covered = false;
    for (int i = 1; i <= int(1000 * duration) && !testing::Test::HasFatalFailure(); ++i) {
        double t = 1e-3 * i;
        if (passing.pushed) {
            const int frame = int(t / passing.interval + 1e-6);
            t = frame * passing.interval;
            const Volume& now = frames->frames()[std::size_t(frame)].volume;
            if (contact.field().volume().data() != now.data()) {
                apply(contact.session, command::Samples{samples_of(now)});
            }
        }
        contact.tick();
        const Vec3 c = centre(t);
        const double depth = passing.radius - (hand - c).norm();
        const Vec3& scp = contact.proxy().scp;
        if (depth > 0.4) {
            covered = true;
            EXPECT_EQ(contact.proxy().mode, Mode::constrained);
            radial.add((scp - c).norm() - passing.radius);
            const Vec3 way = (hand - c).normalized();
            tangential.add((scp - c - way * way.dot(scp - c)).norm());
        } else if (depth < -0.4) {
            EXPECT_EQ(scp, hand) << (covered ? "has passed" : "has not come yet");
        }
    }
    EXPECT_TRUE(covered);
}

TEST(MovingSurface, a_ball_that_passes_over_the_hand_pushes_the_proxy_round_itself) {
    struct Case {
        const char* name;
        Passing passing;
        double radial, tangential;  // most [mm]
    };
    const Case cases[] = {
        {"frames each 10 ms", {}, 0.15, 1.5},
        {"frames each 20 ms", {.interval = 0.02}, 0.3, 1.5},
        {"edge of 2 mm, frames each 5 ms", {.edge = 1, .interval = 0.005}, 0.3, 1.5},
        {"pushed at 50 Hz, 4 mm each", {.interval = 0.02, .pushed = true}, 0.1, 1.5},
        {"edge of 2 mm, pushed at 50 Hz", {.edge = 1, .interval = 0.02, .pushed = true}, 0.3, 3},
        {"nearly through the middle", {.beside = 1}, 0.15, 10},
    };
    for (const Case& c : cases) {
        SCOPED_TRACE(c.name);
        Off radial, tangential;
        MovingContact* contact = nullptr;
        let_pass(c.passing, radial, tangential, &contact);
        if (HasFatalFailure()) return;
        std::printf(
            "[ evidence ] %-32s radial mean %.3f most %.3f, tangential mean %.2f most %.2f "
            "mm, recovering %lld, G1 %.1e\n",
            c.name, radial.mean(), radial.most, tangential.mean(), tangential.most,
            static_cast<long long>(contact->recovering), contact->worst_g1);
        EXPECT_LT(radial.most, c.radial);
        EXPECT_LT(tangential.most, c.tangential);
        EXPECT_EQ(contact->recovering, 0);
    }
}

TEST(MovingSurface, a_ball_that_comes_straight_at_the_hand_pushes_the_proxy_ahead_of_it) {
    const auto frames = played(grid({80, 40, 40}), 0.2, 0.01, [](const Vec3& p, double t) {
        return ball(p, Vec3(14 + speed * t, 20, 20), 10);
    });
    MovingContact contact(frames, level, Vec3(40, 20.05, 20.02));
    contact.tick();
    apply(contact.session, command::Speed{1});
    for (int i = 1; i <= 125; ++i) {  // until its middle is a millimetre short of the hand
        contact.tick();
        if (HasFatalFailure()) return;
        const double front = 14 + speed * 1e-3 * i + 10;
        if (front < 40.1) continue;
        ASSERT_NEAR(contact.proxy().scp[0], front, 0.2 + 0.02 * (front - 40)) << i;
    }
    EXPECT_EQ(contact.recovering, 0);
    EXPECT_GT(contact.rate_limited, 0);
}

TEST(MovingSurface, one_that_grows_and_shrinks_carries_the_proxy_out_and_back_to_the_hand) {
    const Vec3 centre(20, 20, 20), way = Vec3(2, -1, 0.5).normalized();
    const Vec3 hand = centre + 5 * way;
    const auto radius = [](double t) { return t < 0.08 ? speed * t : speed * (0.16 - t); };
    const auto frames = played(grid(cube(41)), 0.16, 0.01,
                               [&](const Vec3& p, double t) { return ball(p, centre, radius(t)); });
    MovingContact contact(frames, level, hand);
    contact.tick();
    apply(contact.session, command::Speed{1});
    Off radial, tangential;
    for (int i = 1; i <= 160; ++i) {
        contact.tick();
        if (HasFatalFailure()) return;
        const double r = radius(1e-3 * i);
        const Vec3 from = contact.proxy().scp - centre;
        if (r > 5.2) {
            ASSERT_EQ(contact.proxy().mode, Mode::constrained);
            radial.add(from.norm() - r);
            tangential.add((from - way * way.dot(from)).norm());
        } else if (r < 4.8) {
            ASSERT_EQ(contact.proxy().scp, hand);
        }
    }
    std::printf("[ evidence ] grows and shrinks: radial most %.3f, tangential most %.2f mm\n",
                radial.most, tangential.most);
    EXPECT_LT(radial.most, 0.1);
    EXPECT_LT(tangential.most, 2.5);
    EXPECT_EQ(contact.recovering, 0);
}

TEST(MovingSurface, one_that_recedes_lets_the_proxy_fall_onto_the_next) {
    // A shell shrinks into a ball that stays, with the hand in that ball.
    const Vec3 centre(20, 20, 20), way = Vec3(1, 2, -1).normalized();
    const auto frames = played(grid(cube(41)), 0.1, 0.01, [&](const Vec3& p, double t) {
        return std::max(ball(p, centre, 16 - speed * t), ball(p, centre, 7));
    });
    MovingContact contact(frames, level, centre + 18 * way);
    for (int i = 0; i < 70; ++i) {
        contact.hand -= 0.2 * way;
        contact.tick();
    }
    EXPECT_NEAR((contact.proxy().scp - centre).norm(), 16, 0.1);
    apply(contact.session, command::Speed{1});
    for (int i = 1; i <= 100; ++i) {
        contact.tick();
        if (HasFatalFailure()) return;
        // Between two frames the mean of both, also where one has met the ball and one has not.
        const int frame = std::min((i - 1) / 10, 9);
        const double w = 0.1 * (i - 10 * frame);
        const double r =
            (1 - w) * std::max(16.0 - 2 * frame, 7.0) + w * std::max(14.0 - 2 * frame, 7.0);
        ASSERT_NEAR((contact.proxy().scp - centre).norm(), r, 0.15);
    }
    EXPECT_NEAR((contact.proxy().scp - centre).normalized().dot(way), 1, 0.05);
    // The ball is taken away in one tick: nothing holds the proxy from the hand.
    apply(contact.session, command::Samples{samples_of(
                               volume_of<float>(grid(cube(41)), [](const Index3&) { return 0; }))});
    contact.tick();
    EXPECT_EQ(contact.proxy().scp, contact.hand);
}

struct MovingWall {
    const char* name;
    double thickness;  // [mm]
    double interval;   // [s] between frames
    bool pushed;
    Geometry geometry = grid({70, 20, 20});
};

TEST(MovingSurface, a_thin_wall_that_moves_is_not_passed_through) {
    const MovingWall walls[] = {
        {"2 voxels, frames each 5 ms", 2, 0.005, false},
        {"3 voxels, frames each 10 ms", 3, 0.01, false},
        {"6 voxels, frames each 20 ms", 6, 0.02, false},
        {"6 voxels, pushed at 50 Hz", 6, 0.02, true},
        {"4.5 voxels, pushed at 50 Hz", 4.5, 0.02, true},
        {"4.5 mm, pushed at 50 Hz, oblique", 4.5, 0.02, true,
         grid({100, 20, 25}, {0.7, 1, 0.8}, {4, -70, 9}, oblique_direction())}};
    for (const MovingWall& wall : walls) {
        SCOPED_TRACE(wall.name);
        const auto middle = [](double t) { return 10.3 + speed * t; };
        // Along the grid [mm].
        const double voxel = wall.geometry.spacing[0];
        const auto along = [&](const Vec3& physical) {
            return index_from_physical(wall.geometry, physical)[0] * voxel;
        };
        // Saturated beyond a voxel, as scans are.
        const auto frames =
            played<std::uint8_t>(wall.geometry, 0.2, wall.interval, [&](const Vec3& p, double t) {
                const double from = std::abs(p[0] * voxel - middle(t));
                return 100 + 100 * std::clamp(0.5 * wall.thickness - from, -1.0, 1.0);
            });
        MovingContact contact(frames, level,
                              physical_from_index(wall.geometry, {20 / voxel, 9.7, 9.2}));
        contact.tick();
        if (!wall.pushed) apply(contact.session, command::Speed{1});
        for (int i = 1; i <= 200; ++i) {
            double t = 1e-3 * i;
            if (wall.pushed) {
                const auto frame = std::size_t(t / wall.interval + 1e-6);
                t = double(frame) * wall.interval;
                const Volume& now = frames->frames()[frame].volume;
                if (contact.field().volume().data() != now.data()) {
                    apply(contact.session, command::Samples{samples_of(now)});
                }
            }
            contact.tick();
            if (HasFatalFailure()) return;
            const double front = middle(t) + 0.5 * wall.thickness;
            if (front < along(contact.hand)) continue;
            // Between two frames the front may lag behind by what it moves in one.
            const double lag = wall.pushed ? 0.1 : 0.7 * speed * wall.interval + 0.1;
            ASSERT_GE(along(contact.proxy().scp), front - lag) << "ms " << i;
        }
        EXPECT_EQ(contact.recovering, 0);
    }
}

TEST(MovingSurface, an_isovalue_swept_up_and_down_in_contact_carries_the_proxy_along) {
    const Vec3 centre(20, 20, 20), way = Vec3(-1, 2, 2).normalized();
    MovingContact contact(
        samples_of(volume_of<float>(
            grid(cube(41)), [&](const Index3& i) { return ball(i.cast<double>(), centre, 10); })),
        level, centre + 15 * way);
    for (int i = 0; i < 50; ++i) {
        contact.hand -= 0.2 * way;
        contact.tick();
    }
    for (int i = 0; i < 2000; ++i) {
        // Radius 10 +- 4 mm, up to 20 cm/s, and jumps now and then.
        const double out = i % 500 == 499 ? 6 : 4 * std::sin(0.05 * i);
        apply(contact.session, command::Isovalue{level - 10 * out});
        contact.tick();
        if (HasFatalFailure()) return;
        const Vec3 from = contact.proxy().scp - centre;
        ASSERT_NEAR(from.norm(), 10 + out, 0.1);
        ASSERT_LT((from - way * way.dot(from)).norm(), 1.5);
    }
    EXPECT_EQ(contact.recovering, 0);
}

TEST(MovingSurface, an_isovalue_swept_over_noise_keeps_the_guarantee) {
    for (const TestField& test : {noise_field(), terraces_field(), marschner_lobb_field()}) {
        SCOPED_TRACE(test.name);
        const Geometry& geometry = test.field.geometry();
        MovingContact contact(test.field.shared_samples(), test.isovalue, physical_centre(geometry),
                              test.field.background());
        Random random(4);
        const double range = test.field.range(), low = test.field.samples().minimum();
        for (int i = 0; i < scaled(20'000); ++i) {
            const double swing = 0.5 + 0.6 * std::sin(2e-3 * i);
            apply(contact.session, command::Isovalue{low + range * swing});
            contact.hand +=
                0.3 * random.direction() + 0.02 * (physical_centre(geometry) - contact.hand);
            contact.tick();
            if (HasFatalFailure()) return;
        }
        EXPECT_GT(contact.constrained, contact.ticks / 100);
        EXPECT_LT(contact.recovering, contact.ticks / 4);
    }
}

TEST(MovingSurface, random_edits_at_100_hz_round_the_probe_for_a_million_ticks) {
    const Geometry geometry = grid(cube(33), {0.8, 0.8, 1});
    const Vec3 centre = physical_centre(geometry);
    auto samples = samples_of(volume_of<std::uint8_t>(geometry, [&](const Index3& i) {
        const Vec3 p = physical_from_index(geometry, i.cast<double>());
        return std::clamp(ball(p, centre, 9, 10), 0.0, 200.0);
    }));
    MovingContact contact(samples, level, centre + Vec3(0, 0, 12));
    Random random(12);
    std::int64_t edits = 0, changed = 0, pushed = 0;
    Vec3 aim = centre;
    const int ticks = scaled(1'000'000);
    for (int i = 0; i < ticks; ++i) {
        if (i % 400 == 0) aim = centre + 11 * random.uniform(0, 1) * random.direction();
        contact.hand += 0.01 * (aim - contact.hand) + 0.02 * random.direction();
        if (i % 10 == 0) {
            Brush brush = brush_for(brush_kinds[random.below(4)], contact.field(), level,
                                    random.uniform(0.5, 2.5));
            if (brush.kind == BrushKind::paint) brush.value = random.uniform(0, 200);
            brush.hardness = random.uniform(0, 1);
            brush.strength = random.uniform(0.05, 1);
            // At the SCP, at the hand, or near by; at times a fast stroke from one to the other.
            const Vec3 at = random.chance(0.4) ? contact.session.renderer.proxy.scp_physical
                                               : Vec3(contact.hand + 2 * random.direction());
            const Edited after =
                edited(samples, edit::Stroke{brush, at, random.chance(0.2) ? contact.hand : at});
            ++edits;
            changed += !after.changed.empty();
            pushed +=
                value_at(linear_field(after.samples), contact.session.renderer.proxy.scp) > level;
            samples = after.samples;
            apply(contact.session, command::Samples{samples, std::uint64_t(edits)});
        }
        contact.tick();
        if (HasFatalFailure()) return;
    }
    std::printf(
        "[ evidence ] %d ticks, %lld edits (%lld changed samples, %lld came over the "
        "proxy), constrained %.2f, recovering %lld, rate limited %lld, G1 %.1e\n",
        ticks, static_cast<long long>(edits), static_cast<long long>(changed),
        static_cast<long long>(pushed), double(contact.constrained) / ticks,
        static_cast<long long>(contact.recovering), static_cast<long long>(contact.rate_limited),
        contact.worst_g1);
    EXPECT_GT(contact.constrained, ticks / 10);
    EXPECT_GT(pushed, edits / 100);
    EXPECT_LT(contact.recovering, ticks / 1000);
    EXPECT_GT(contact.rate_limited, ticks / 1000);
}

TEST(MovingSurface, frames_that_appear_and_vanish_push_the_proxy_out_and_let_it_go) {
    const Geometry geometry = grid(cube(24));
    const Vec3 centre = physical_centre(geometry);
    const auto of = [&](auto&& density) {
        return samples_of(volume_of<float>(
            geometry, [&](const Index3& i) { return density(Vec3(i.cast<double>())); }));
    };
    const auto body = of([&](const Vec3& p) { return ball(p, centre, 7); });
    const auto full = of([](const Vec3&) { return 2 * level; });
    const auto empty = of([](const Vec3&) { return 0; });
    const auto noise = samples_of(noise_volume<float>(geometry, 3, 0, 2 * level));
    const Vec3 hand = centre + Vec3(0.3, 4.1, 0.2);
    MovingContact contact(body, level, centre + Vec3(0.3, 9, 0.2));
    while (contact.hand[1] > hand[1]) {
        contact.hand[1] -= 0.1;
        contact.tick();
    }
    Random random(2);
    for (int i = 0; i < scaled(3000); ++i) {
        const int choice = random.below(4);
        apply(contact.session, command::Samples{choice == 0   ? body
                                                : choice == 1 ? full
                                                : choice == 2 ? empty
                                                              : noise});
        for (int wait = random.below(30); wait >= 0; --wait) {
            contact.tick();
            if (HasFatalFailure()) return;
        }
        if (contact.proxy().status == UpdateStatus::recovering) continue;
        const Vec3& scp = contact.proxy().scp;
        if (choice == 2) {
            ASSERT_EQ(scp, contact.hand);
        } else if (choice == 0) {
            ASSERT_NEAR((scp - centre).norm(), 7, 0.1);
        } else if (choice == 1) {
            // Out at the border of the grid, where the background begins.
            ASSERT_TRUE((scp.array() < 0).any() || (scp.array() > 23).any()) << scp.transpose();
        }
    }
    EXPECT_LT(contact.recovering, contact.ticks / 100);
}

TEST(MovingSurface, where_all_of_space_is_solid_there_is_no_force_until_there_is_room_again) {
    const Geometry geometry = grid(cube(16));
    const auto full =
        samples_of(volume_of<float>(geometry, [](const Index3&) { return 2 * level; }));
    const auto half = samples_of(
        volume_of<float>(geometry, [](const Index3& i) { return level + 10 * (8.3 - i[0]); }));
    MovingContact contact(half, level, Vec3(7, 8, 8), 2 * level);  // the background is solid too
    contact.tick();
    EXPECT_NEAR(contact.proxy().scp[0], 8.3, 1e-6);
    for (int round = 0; round < 5; ++round) {
        apply(contact.session, command::Samples{full});
        for (int i = 0; i < scaled(500); ++i) {
            contact.tick();
            if (HasFatalFailure()) return;
            ASSERT_EQ(contact.proxy().status, UpdateStatus::recovering);
        }
        apply(contact.session, command::Samples{half});
        int wait = 0;
        while (contact.tick().tick.proxy.status == UpdateStatus::recovering && wait < 100) ++wait;
        if (HasFatalFailure()) return;
        EXPECT_LT(wait, 100);
        EXPECT_NEAR(contact.proxy().scp[0], 8.3, 1e-6);
    }
}

}  // namespace
