// The beating shell: smooth in space and time, two hollow chambers, a beat that comes round.
#include "palpate/scenes/beating.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "palpate/surface.hpp"
#include "scenes/hash.hpp"
#include "scenes/random.hpp"
#include "support/mesh_checks.hpp"

using namespace palpate;
using namespace palpate::scenes;

namespace {

Vec3 anywhere(Random& random) {
    return {100 * random.uniform() - 50, 100 * random.uniform() - 50, 100 * random.uniform() - 50};
}

/// [mm^3] of muscle: the enclosed volume of the closed isosurface.
double muscle(double phase) {
    const Scene scene = beating_frame({48, 48, 48}, phase);
    const SurfaceMesh mesh = extract_surface(linear_field(scene.volume), scene.isovalue);
    EXPECT_EQ(support::flaw_in_closed_mesh(mesh), "") << phase;
    return enclosed_volume(mesh);
}

/// Samples of the cavity that a point lies in: below half height and joined to it.
int cavity(const Volume& volume, const Index3& from) {
    const Index3 size = volume.geometry().size;
    std::vector<char> seen(static_cast<std::size_t>(sample_count(volume.geometry())));
    std::vector<Index3> open{from};
    int count = 0;
    while (!open.empty()) {
        const Index3 at = open.back();
        open.pop_back();
        if ((at.array() < 0).any() || (at.array() >= size.array()).any()) return -1;  // not closed
        auto& here = seen[static_cast<std::size_t>((at[2] * size[1] + at[1]) * size[0] + at[0])];
        if (here != 0 || volume.sample(at) > 127.5) continue;
        here = 1;
        ++count;
        for (int a = 0; a < 3; ++a) {
            for (const int step : {-1, 1}) open.push_back(at + step * Index3::Unit(a));
        }
    }
    return count;
}

}  // namespace

TEST(Beating, its_grid_is_ten_centimetres_round_the_origin) {
    const Scene scene = make_volume("synthetic:beating");
    EXPECT_EQ(scene.volume.geometry().size, Index3(64, 64, 64));
    EXPECT_EQ(scene.volume.geometry().spacing, Vec3::Constant(100.0 / 64));
    EXPECT_EQ(physical_centre(scene.volume.geometry()), Vec3(0, 0, 0));
    EXPECT_EQ(make_volume("beating:20x30x40").volume.geometry().spacing, Vec3::Constant(2.5));
    const Scene frame = beating_frame({64, 64, 64}, 0);
    EXPECT_EQ(hash_of(frame.volume.data(), frame.volume.bytes()),
              hash_of(scene.volume.data(), scene.volume.bytes()));
}

TEST(Beating, both_chambers_are_closed_and_empty_themselves) {
    int left = 0, right = 0, left_least = 1 << 30, right_least = 1 << 30;
    for (int i = 0; i < beating_frames; ++i) {
        const double phase = double(i) / beating_frames;
        const Volume volume = beating_frame({64, 64, 64}, phase).volume;
        const int in_left = cavity(volume, {40, 32, 32});
        const int in_right = cavity(volume, {18, 31, 34});
        EXPECT_GT(in_left, 500) << phase;
        EXPECT_GT(in_right, 500) << phase;
        if (i == 0) {
            left = in_left;
            right = in_right;
        }
        left_least = std::min(left_least, in_left);
        right_least = std::min(right_least, in_right);
    }
    EXPECT_LT(left_least, 0.6 * left);
    EXPECT_LT(right_least, 0.75 * right);
}

TEST(Beating, its_surface_is_closed_and_the_muscle_nearly_keeps_its_volume) {
    const double full = muscle(0);
    for (const double phase : {0.2, 0.4, 0.7}) EXPECT_NEAR(muscle(phase), full, 0.2 * full);
}

TEST(Beating, a_beat_comes_round) {
    Random random(1);
    for (int i = 0; i < 1000; ++i) {
        const Vec3 p = anywhere(random);
        const double phase = random.uniform();
        EXPECT_NEAR(beating_density(p, phase), beating_density(p, phase + 1), 1e-12);
        EXPECT_NEAR(beating_density(p, phase), beating_density(p, phase - 3), 1e-12);
    }
}

TEST(Beating, the_density_is_continuous_in_space_and_time_and_0_at_the_border) {
    Random random(2);
    double steepest = 0, fastest = 0;
    for (int i = 0; i < 200000; ++i) {
        const Vec3 p = anywhere(random), q = p + 1e-4 * Vec3(1, 1, 1);
        const double phase = random.uniform();
        const double here = beating_density(p, phase);
        EXPECT_TRUE(here >= 0 && here <= 1);
        steepest = std::max(steepest, std::abs(beating_density(q, phase) - here) / 1.732e-4);
        fastest = std::max(fastest, std::abs(beating_density(p, phase + 1e-6) - here) / 1e-6);
        Vec3 border = p;
        border[i % 3] = i % 2 == 0 ? 49 : -49;
        EXPECT_EQ(beating_density(border, phase), 0);
    }
    // Walls of 5 and 7 mm to each side; a surface that moves by at most 1 cm or so a beat.
    EXPECT_LT(steepest, 0.5);
    EXPECT_GT(steepest, 0.1);
    EXPECT_LT(fastest / beating_period / 0.14, 200);  // [mm/s]
    EXPECT_GT(fastest, 1);
}

TEST(Beating, its_largest_frames_and_thinnest_grids_are_made_or_refused) {
    EXPECT_NO_THROW(beating_frame({1, 1, 1}, 0.3));
    EXPECT_NO_THROW(beating_frame({16, 16, 1}, 0.3));
    EXPECT_THROW(beating_frame({4096, 4096, 4096}, 0), std::invalid_argument);
    EXPECT_EQ(beating_frame({8, 8, 8}, 0, SampleType::float32).isovalue, 0.5);
}
