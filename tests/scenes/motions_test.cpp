// The motions: smooth, no faster than asked, as deep as asked, on any field, always the same.
#include "palpate/scenes/motions.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstdio>
#include <map>

#include "palpate/field.hpp"
#include "palpate/scenes/volumes.hpp"
#include "scenes/contact.hpp"
#include "scenes/hash.hpp"
#include "scenes/track.hpp"

using namespace palpate;
using namespace palpate::scenes;

namespace {

struct Touched {
    Scene scene = make_volume("sphere");
    Field field = linear_field(scene.volume);
    explicit Touched(std::string_view spec, std::optional<SampleType> type = {})
        : scene(make_volume(spec, type)), field(linear_field(scene.volume)) {}
    std::vector<HandSample> motion(std::string_view name, const MotionSettings& s = {}) const {
        return make_motion(name, field, scene.isovalue, s);
    }
    bool solid(const Vec3& p) const { return value_at(field, p) > scene.isovalue; }
};

bool is_smooth(const std::string& name) {
    return name != "random";
}

double highest_speed(const std::vector<HandSample>& samples) {
    double highest = 0;
    for (std::size_t i = 1; i < samples.size(); ++i) {
        const double way = (samples[i].position - samples[i - 1].position).norm();
        highest = std::max(highest, way / (samples[i].t - samples[i - 1].t));
    }
    return highest;
}

double mean_speed(const std::vector<HandSample>& samples) {
    double way = 0;
    for (std::size_t i = 1; i < samples.size(); ++i) {
        way += (samples[i].position - samples[i - 1].position).norm();
    }
    return way / (samples.back().t - samples.front().t);
}

/// Radius of the sphere scene's surface, by its formula.
constexpr double sphere_radius = 32 * (1 - 0.3);

std::string rendering(const std::vector<HandSample>& samples) {
    std::string text;
    char line[128];
    for (std::size_t i = 0; i < samples.size(); i += 50) {
        const Vec3& p = samples[i].position;
        // + 0.0 turns the -0.000000 of a rounded negative into nothing compilers could differ in.
        std::snprintf(line, sizeof line, "%.3f %.6f %.6f %.6f\n", samples[i].t, p[0] + 0.0,
                      p[1] + 0.0, p[2] + 0.0);
        text += line;
    }
    return text;
}

}  // namespace

TEST(Motions, have_exactly_the_asked_samples_at_the_asked_times) {
    const Touched sphere("sphere");
    for (const std::string& name : motion_names()) {
        const auto samples = sphere.motion(name, {.rate_hz = 500, .duration_s = 1.5});
        ASSERT_EQ(samples.size(), 751u) << name;
        for (std::size_t i = 0; i < samples.size(); ++i) {
            ASSERT_EQ(samples[i].t, static_cast<double>(i) / 500) << name;
            ASSERT_TRUE(samples[i].position.allFinite()) << name;
        }
        EXPECT_EQ(sphere.motion(name, {.duration_s = 0}).size(), 1u) << name;
        EXPECT_EQ(sphere.motion(name, {.rate_hz = 1000, .duration_s = 0.0026}).size(), 4u) << name;
    }
}

TEST(Motions, never_pass_the_asked_speed) {
    for (const std::string spec : {"sphere", "cylinder", "torus", "noise:20x20x20"}) {
        const Touched touched(spec);
        for (const std::string& name : motion_names()) {
            if (!is_smooth(name)) continue;
            for (const double speed : {5.0, 50.0, 400.0}) {
                const auto samples = touched.motion(name, {.duration_s = 4, .speed_mm_s = speed});
                EXPECT_LE(highest_speed(samples), speed * (1 + 1e-9)) << name << spec;
                EXPECT_GT(highest_speed(samples), 0) << name << spec;
            }
        }
    }
}

TEST(Motions, keep_the_asked_speed_where_they_travel) {
    const Touched cylinder("cylinder");
    for (const std::string name : {"slide", "circle", "explore"}) {
        for (const std::uint64_t seed : {1u, 2u, 3u}) {
            const auto samples = cylinder.motion(name, {.duration_s = 20, .seed = seed});
            EXPECT_GT(mean_speed(samples), 0.7 * 50) << name;
            EXPECT_GT(highest_speed(samples), 0.99 * 50) << name;
        }
    }
}

TEST(Motions, are_smooth) {
    // The velocity changes by at most 2/31 of the speed from one tick to the next.
    for (const std::string spec : {"sphere", "cylinder", "shepp-logan:64x64x64"}) {
        const Touched touched(spec);
        for (const std::string& name : motion_names()) {
            if (!is_smooth(name)) continue;
            const auto samples = touched.motion(name, {.duration_s = 6});
            double jolt = 0;
            for (std::size_t i = 2; i < samples.size(); ++i) {
                const Vec3 change = (samples[i].position - samples[i - 1].position) -
                                    (samples[i - 1].position - samples[i - 2].position);
                jolt = std::max(jolt, change.norm() * 1000);
            }
            EXPECT_LT(jolt, 50 * 2.0 / 31 * (1 + 1e-6)) << name << ' ' << spec;  // [mm/s]
        }
    }
}

TEST(Motions, approach_from_outside_and_end_at_the_depth) {
    const Touched sphere("sphere", SampleType::float32);
    for (const std::uint64_t seed : {1u, 2u, 3u, 4u}) {
        for (const double depth : {0.5, 2.0, 8.0}) {
            const auto samples = sphere.motion("approach", {.depth_mm = depth, .seed = seed});
            EXPECT_GT(samples.front().position.cwiseAbs().maxCoeff(), 32);
            EXPECT_NEAR(sphere_radius - samples.back().position.norm(), depth, 0.05);
        }
    }
}

TEST(Motions, press_between_the_surface_and_the_depth) {
    const Touched sphere("sphere", SampleType::float32);
    const auto samples = sphere.motion("press", {.duration_s = 10, .depth_mm = 3});
    double deepest = -1e9, shallowest = 1e9;
    for (const HandSample& sample : samples) {
        if (sample.t < 4) continue;
        deepest = std::max(deepest, sphere_radius - sample.position.norm());
        shallowest = std::min(shallowest, sphere_radius - sample.position.norm());
    }
    EXPECT_NEAR(deepest, 3, 0.05);
    EXPECT_NEAR(shallowest, 0, 0.05);
}

TEST(Motions, slide_along_the_surface_at_the_depth) {
    const Touched sphere("sphere", SampleType::float32);
    for (const std::uint64_t seed : {1u, 2u, 3u}) {
        const auto samples = sphere.motion("slide", {.depth_mm = 2, .seed = seed});
        double farthest = 0;
        for (const HandSample& sample : samples) {
            if (sample.t < 3.5) continue;
            ASSERT_NEAR(sphere_radius - sample.position.norm(), 2, 0.15) << sample.t;
            farthest = std::max(farthest, (sample.position - samples.back().position).norm());
        }
        EXPECT_GT(farthest, 15);
    }
}

TEST(Motions, circle_round_the_axis_of_the_cylinder_at_the_depth) {
    const Touched cylinder("cylinder");
    const auto samples = cylinder.motion("circle", {.duration_s = 12, .depth_mm = 2});
    double turned = 0;
    for (std::size_t i = 3600; i + 1 < samples.size(); ++i) {
        const Vec3& p = samples[i].position;
        const Vec3& q = samples[i + 1].position;
        ASSERT_NEAR(std::hypot(p[0], p[1]), 50 * (1 - 0.4) - 2, 0.1);
        ASSERT_NEAR(p[2], 0, 1e-9);
        turned += std::atan2(p[0] * q[1] - p[1] * q[0], p[0] * q[0] + p[1] * q[1]);
    }
    EXPECT_NEAR(turned, 8.4 * 50 / 28, 0.2);  // [rad] = seconds * speed / radius: one way round
}

TEST(Motions, circle_on_the_face_where_the_centre_cannot_be_gone_round) {
    const Touched plane("plane", SampleType::float32);
    const auto samples = plane.motion("circle", {.duration_s = 10, .depth_mm = 2});
    for (const HandSample& sample : samples) {
        if (sample.t > 3.5) {
            ASSERT_NEAR(sample.position[2], -2, 0.05);
        }
    }
}

TEST(Motions, tap_makes_and_breaks_contact_a_few_times_a_second) {
    const Touched sphere("sphere");
    for (const double speed : {20.0, 50.0, 500.0}) {
        const auto samples = sphere.motion("tap", {.duration_s = 10, .speed_mm_s = speed});
        int contacts = 0;
        for (std::size_t i = 1; i < samples.size(); ++i) {
            contacts += sphere.solid(samples[i].position) && !sphere.solid(samples[i - 1].position);
        }
        EXPECT_GE(contacts, 8) << speed;
        EXPECT_LE(contacts, 26) << speed;
    }
}

TEST(Motions, explore_touches_and_lets_go_at_different_places) {
    for (const std::string spec : {"sphere", "torus", "shepp-logan:64x64x64", "shell"}) {
        for (const std::uint64_t seed : {1u, 2u, 3u}) {
            const Touched touched(spec);
            const auto samples = touched.motion("explore", {.duration_s = 20, .seed = seed});
            int contacts = 0, inside = 0;
            Vec3 low = samples.front().position, high = low;
            for (std::size_t i = 1; i < samples.size(); ++i) {
                const bool now = touched.solid(samples[i].position);
                contacts += now && !touched.solid(samples[i - 1].position);
                inside += now;
                low = low.cwiseMin(samples[i].position);
                high = high.cwiseMax(samples[i].position);
            }
            const double share = inside / static_cast<double>(samples.size());
            EXPECT_GE(contacts, 5) << spec << seed;
            EXPECT_GT(share, 0.05) << spec << seed;
            EXPECT_LT(share, 0.8) << spec << seed;
            EXPECT_GT((high - low).norm(), 30) << spec << seed;
        }
    }
}

TEST(Motions, explore_goes_round_the_body_and_not_through_it) {
    // Depth below the surface of the sphere, and of the torus with its hole (by their formulas).
    const auto in_sphere = [](const Vec3& p) { return sphere_radius - p.norm(); };
    const auto in_torus = [](const Vec3& p) {
        return 0.12 * 80 - std::hypot(std::hypot(p[0], p[1]) - 0.3 * 80, p[2]);
    };
    int touching = 0;
    for (const std::uint64_t seed : {1u, 2u, 3u, 4u, 11u, 15u}) {
        const MotionSettings settings{.duration_s = 20, .depth_mm = 2, .seed = seed};
        for (const HandSample& s : Touched("sphere").motion("explore", settings)) {
            ASSERT_LT(in_sphere(s.position), 2.5) << s.t << ' ' << seed;
            touching += in_sphere(s.position) > 0.5;
        }
        for (const HandSample& s : Touched("torus").motion("explore", settings)) {
            ASSERT_LT(in_torus(s.position), 2.5) << s.t << ' ' << seed;
            touching += in_torus(s.position) > 0.5;
        }
    }
    EXPECT_GT(touching, 30000);
}

TEST(Motions, reach_into_the_solid_in_every_scene) {
    for (const std::string& spec : volume_names()) {
        const Touched touched(spec);
        for (const std::string& name : motion_names()) {
            for (const std::uint64_t seed : {1u, 5u}) {
                int inside = 0;
                for (const HandSample& sample : touched.motion(name, {.seed = seed})) {
                    inside += touched.solid(sample.position);
                }
                EXPECT_GT(inside, 200) << name << ' ' << spec << ' ' << seed;
            }
        }
    }
}

TEST(Motions, reach_the_dark_side_where_that_is_solid) {
    const Scene scene = make_volume("shell");
    const Field field = linear_field(scene.volume, Solid::below);
    for (const std::string& name : motion_names()) {
        int inside = 0;
        for (const HandSample& s : make_motion(name, field, scene.isovalue, {})) {
            inside += value_at(field, s.position) < scene.isovalue;
        }
        EXPECT_GT(inside, 300) << name;
    }
}

TEST(Motions, find_a_single_solid_voxel_in_a_corner) {
    const Volume volume = box({40, 40, 40}, {38, 1, 37}, {38, 1, 37});
    for (const std::uint64_t seed : {1u, 2u, 3u, 4u, 5u}) {
        Random random(seed);
        EXPECT_TRUE(any_contact(linear_field(volume), 250, random).found);
    }
    const auto samples = make_motion("approach", linear_field(volume), 250, {.depth_mm = 0.005});
    const Vec3 speck = physical_from_index(volume.geometry(), Vec3(38, 1, 37));
    EXPECT_LT((samples.back().position - speck).norm(), 0.1);
}

TEST(Motions, move_about_the_centre_where_there_is_no_surface) {
    const Touched sphere("sphere");
    for (const double level : {1e6, std::nan("")}) {
        for (const std::string& name : motion_names()) {
            if (!is_smooth(name)) continue;
            const auto samples = make_motion(name, sphere.field, level, {});
            double nearest = 1e9;
            for (const HandSample& s : samples) {
                ASSERT_TRUE(s.position.allFinite()) << name;
                nearest = std::min(nearest, s.position.norm());
            }
            EXPECT_LT(nearest, 12) << name;
            EXPECT_GT(mean_speed(samples), 0.5) << name;
        }
    }
}

TEST(Motions, work_on_thin_noisy_anisotropic_and_oblique_volumes) {
    const Mat3 turned = Eigen::AngleAxisd(1.1, Vec3(3, 1, 2).normalized()).toRotationMatrix();
    const std::vector<Volume> volumes{
        make_volume("noise:1x1x1").volume,
        make_volume("noise:1x24x24").volume,
        make_volume("noise:30x1x1").volume,
        salt({20, 20, 20}, 0.25, 3),
        thin_shell({30, 30, 30}, 10, 0.3),
        noise(centred({30, 20, 10}, {0.01, 0.02, 0.3}, turned), SampleType::int16, 3, 255),
        noise(centred({8, 8, 8}, {100, 70, 30}, turned), SampleType::float32, 3, 255)};
    for (const Volume& volume : volumes) {
        for (const std::string& name : motion_names()) {
            for (const std::uint64_t seed : {1u, 2u}) {
                const auto samples = make_motion(name, linear_field(volume), 127, {.seed = seed});
                ASSERT_EQ(samples.size(), 10001u);
                for (const HandSample& s : samples) ASSERT_TRUE(s.position.allFinite()) << name;
                if (is_smooth(name)) {
                    EXPECT_LE(highest_speed(samples), 50 * (1 + 1e-9)) << name;
                }
            }
        }
    }
}

TEST(Motions, random_stays_in_the_padded_box_and_jumps_there_at_any_speed) {
    const Touched sphere("sphere:20x30x40");
    const auto samples = sphere.motion("random");
    int far = 0, near = 0, rests = 0;
    for (std::size_t i = 1; i < samples.size(); ++i) {
        const Vec3& p = samples[i].position;
        ASSERT_TRUE((p.cwiseAbs().array() <= Vec3(11.5, 16.5, 21.5).array()).all());
        const double way = (p - samples[i - 1].position).norm();
        far += way > 10;
        near += way > 0 && way < 1e-4;
        rests += way == 0;
    }
    EXPECT_GT(far, 100);
    EXPECT_GT(near, 100);
    EXPECT_GT(rests, 100);
}

TEST(Motions, are_the_same_for_the_same_seed_only) {
    const Touched torus("torus");
    for (const std::string& name : motion_names()) {
        const auto text = [&](std::uint64_t seed) {
            return rendering(torus.motion(name, {.duration_s = 3, .seed = seed}));
        };
        EXPECT_EQ(text(1), text(1)) << name;
        if (name != "circle") {  // goes round the centre whatever the seed
            EXPECT_NE(text(1), text(2)) << name;
        }
    }
}

TEST(Motions, are_the_same_text_everywhere) {
    const std::map<std::string, std::uint64_t> golden{
        {"approach", 0x3bc845194fa57cfeu}, {"press", 0x9d3e90e0d2f264adu},
        {"slide", 0xe7033a94b41ee398u},    {"circle", 0xb242344cfa8710d2u},
        {"tap", 0xd427f0b64bdf55c3u},      {"explore", 0x2fc8fdbafc2cddcbu},
        {"random", 0xa54259c37e5fa352u},
    };
    const Touched cylinder("cylinder");
    for (const auto& [name, hash] : golden) {
        EXPECT_EQ(hash_of(rendering(cylinder.motion(name, {.duration_s = 5}))), hash) << name;
    }
}

TEST(Motions, bad_names_and_settings_are_refused_with_what_to_do) {
    const Touched sphere("sphere:8x8x8");
    try {
        sphere.motion("stroke");
        FAIL() << "no exception";
    } catch (const std::invalid_argument& error) {
        for (const std::string& name : motion_names()) {
            EXPECT_NE(std::string(error.what()).find(name), std::string::npos) << error.what();
        }
    }
    const double nan = std::nan("");
    for (const MotionSettings& settings :
         {MotionSettings{.rate_hz = 0}, MotionSettings{.rate_hz = nan},
          MotionSettings{.duration_s = -1}, MotionSettings{.duration_s = 1e9},
          MotionSettings{.speed_mm_s = 0}, MotionSettings{.speed_mm_s = INFINITY},
          MotionSettings{.depth_mm = -1}, MotionSettings{.depth_mm = nan}}) {
        EXPECT_THROW(sphere.motion("press", settings), std::invalid_argument);
    }
}

TEST(Tracks, a_journey_travels_its_length_smoothly_and_no_faster_than_asked) {
    for (const double length : {0.0, 0.01, 1.0, 5.0, 200.0}) {
        const Journey journey(length, 50);
        double before = 0, speed_before = 0;
        for (double t = 0; t < journey.duration() + 0.01; t += 1e-4) {
            const double now = journey.travelled(t);
            const double speed = (now - before) / 1e-4;
            ASSERT_GE(speed, -1e-6);
            ASSERT_LE(speed, 50 * (1 + 1e-6));
            ASSERT_LT(std::abs(speed - speed_before), 1.6 * 50 / 0.1 * 1e-4 + 1e-6);
            before = now;
            speed_before = speed;
        }
        EXPECT_EQ(before, length);
        EXPECT_NEAR(journey.there_and_back(1.5 * journey.duration()), length / 2, 1e-9);
    }
}

TEST(Tracks, rounding_stays_near_and_inside_the_corner) {
    const Track corner({Vec3(0, 0, 0), Vec3(10, 0, 0), Vec3(10, 10, 0)});
    const Track soft = rounded(corner, 1, false);
    EXPECT_EQ(soft.points().front(), Vec3(0, 0, 0));
    EXPECT_EQ(soft.points().back(), Vec3(10, 10, 0));
    double nearest = 1e9;
    for (const Vec3& p : soft.points()) {
        ASSERT_LE(p[0], 10 + 1e-9);
        ASSERT_GE(p[1], -1e-9);
        nearest = std::min(nearest, (p - Vec3(10, 0, 0)).norm());
    }
    EXPECT_GT(nearest, 0.2);
    EXPECT_LT(nearest, 1);
}
