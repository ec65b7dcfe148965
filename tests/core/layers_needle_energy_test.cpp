// A needle gives back no more energy than the hand put in, whatever it goes through.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

#include "palpate/renderer.hpp"
#include "support/cubic_guarantees.hpp"
#include "support/fields.hpp"
#include "support/layer_order.hpp"
#include "support/press.hpp"

using namespace palpate;
using namespace palpate::support;
using enum HapticProperty;

namespace {

constexpr double no_limit = 1e6;  // [N]

struct NeedleBalance {
    double most_gained = -1e300;  ///< of all loops [J]
    double lost = 0;
    int inserted = 0, limited = 0, punctures = 0, withdrawn = 0;  ///< ticks, ticks, surfaces, loops
};

/// A closed path through these points, in straight ways of these many ticks, at rest between them.
NeedleBalance go_round(const Renderer& begin, const std::vector<Vec3>& corners, int ticks,
                       const Vec3& pointing) {
    Renderer renderer = begin;
    NeedleBalance balance;
    double work = 0, time = 0;
    Vec3 from = corners.front(), last_force = Vec3::Zero();
    const auto step = [&](const Vec3& to) {
        const Tick tick =
            render(renderer, {.time = time += 0.001, .position = to, .pointing = pointing});
        work += 0.5 * (last_force + tick.force).dot(to - from);
        last_force = tick.force;
        from = to;
        balance.inserted += renderer.layers.needle.inserted;
        balance.limited += renderer.layers.needle.inserted && tick.force_flags & force_limited;
        balance.punctures += tick.layers.punctured;
    };
    step(from);
    // Half of it in a spring, at most all of it in one that is limited.
    const double part = renderer.settings.force.limit < no_limit ? 1 : 0.5;
    const double stored = part * last_force.dot(renderer.proxy.scp_physical - from);
    work = 0;
    for (std::size_t i = 1; i <= corners.size(); ++i) {
        const Vec3 a = corners[i - 1], b = corners[i % corners.size()];
        for (int k = 1; k <= ticks; ++k) step(a + (double(k) / ticks) * (b - a));
        for (int k = 0; k < 20; ++k) step(b);
    }
    balance.withdrawn = balance.punctures > 0 && !renderer.layers.needle.inserted;
    balance.most_gained = (work - stored) / 1000;
    balance.lost = -balance.most_gained;
    return balance;
}

void never_gains(const TestField& test, LayerPlan plan, double drag_force, std::uint64_t seed,
                 double limit = no_limit) {
    Layers layers = planned_layers(test, plan);
    for (Layer& l : layers.layers) l[drag] = drag_force;
    layers.needle = Needle{};
    RendererSettings settings = at_once();
    settings.layers = std::make_shared<Layers>(layers);
    settings.force.limit = settings.device.maximum_force = limit;
    settings.device.physical_damping = 1;
    const Renderer begin = make_renderer(test.field, test.isovalue, settings);
    Random random(seed);
    NeedleBalance all;
    const Geometry& geometry = test.field.geometry();
    const int loops = scaled_or_asked(300);
    for (int i = 0; i < loops; ++i) {
        std::vector<Vec3> corners;
        for (int c = 0; c < 5; ++c) {
            Vec3 index;
            for (int a = 0; a < 3; ++a) index[a] = random.uniform(-2, geometry.size[a] + 1);
            corners.push_back(physical_from_index(geometry, index));
        }
        const bool points = random.chance(0.7);
        const NeedleBalance one =
            go_round(begin, corners, 1000, points ? random.direction() : Vec3(Vec3::Zero()));
        EXPECT_LE(one.most_gained, 1e-6) << "loop " << i;
        all.most_gained = std::max(all.most_gained, one.most_gained);
        all.lost += one.lost;
        all.inserted += one.inserted;
        all.limited += one.limited;
        all.punctures += one.punctures;
        all.withdrawn += one.withdrawn;
    }
    std::printf(
        "[ evidence ] %-14s loops %d  ticks with a needle %d  at the limit %d  punctures %d  "
        "withdrawn %d  most "
        "gained %.2e J  lost %.2e J\n",
        test.name.c_str(), loops, all.inserted, all.limited, all.punctures, all.withdrawn,
        all.most_gained, all.lost);
    EXPECT_GT(all.inserted, 200 * loops);
    EXPECT_GT(all.punctures, loops);
    EXPECT_EQ(all.limited > 200 * loops, limit < 1e6);
}

TestField on_smooth(const TestField& test) {
    return {test.name, smooth(test.field), test.isovalue};
}

}  // namespace

TEST(NeedleEnergy, is_not_made_in_waves) {
    never_gains(on_smooth(marschner_lobb_field()),
                {{-0.15, -0.05, 0.05, 0.15}, {0.3, 0.6, 0.4, 0.8}, {0.4, 1.5, 0.3, 0.8}}, 0.03, 91);
}
TEST(NeedleEnergy, is_not_made_on_linear_noise) {
    never_gains(noise_field(), {{-0.2, -0.1, 0.1, 0.2}, {0.3, 0.6, 0.4, 0.8}, {0.4, 1.5, 0.3, 0.8}},
                0.03, 92);
}
TEST(NeedleEnergy, is_not_made_where_a_soft_surface_lets_in_a_needle_that_points_aside) {
    never_gains(on_smooth(marschner_lobb_field()), {{-0.15, 0.1}, {0.2, 0.1}, {0.05, 0.1}}, 0, 93);
}
TEST(NeedleEnergy, is_not_made_by_much_drag_behind_a_soft_surface) {
    never_gains(on_smooth(marschner_lobb_field()), {{-0.15, 0.1}, {0.2, 0.1}, {0.05, 0.1}}, 1, 94);
}
TEST(NeedleEnergy, is_not_made_on_bone_at_the_limit) {
    never_gains(on_smooth(marschner_lobb_field()), {{-0.15, 0.1}, {0.2, 1e6}, {0.3, 1.5}}, 0, 95,
                1);
}
TEST(NeedleEnergy, is_not_made_by_drag_at_the_limit) {
    never_gains(on_smooth(marschner_lobb_field()), {{-0.15, 0.1}, {0.2, 1e6}, {0.3, 1.5}}, 0.1, 96,
                1);
}
