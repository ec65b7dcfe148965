// The baselines must be what the literature says they are: weak in the published ways, no weaker.
#include "baselines/gradient.hpp"
#include "palpate/baselines/methods.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "palpate/scenes/volumes.hpp"

using namespace palpate;

namespace {

struct Drift {
    double worst = 0;  // |density - isovalue| / range at the SCP
    int constrained = 0;
};

/// The paper's Fig. 10: round the cylinder again and again, 1 mm below its surface.
Drift round_the_cylinder(ProxyMethod method, int turns) {
    const scenes::Scene scene = scenes::make_volume("cylinder");
    const Field field = linear_field(scene.volume);
    Proxy proxy;
    proxy.isovalue = scene.volume.minimum() + 0.53 * scene.volume.range();
    const Vec3 centre = physical_centre(field.geometry());
    method(proxy, field, centre + Vec3(60, 0, 0), {}, {});
    Drift drift;
    constexpr int ticks_a_turn = 2000;
    for (int i = 0; i < turns * ticks_a_turn; ++i) {
        const double angle = 2 * std::numbers::pi * i / ticks_a_turn;
        const Vec3 hip = centre + 22.5 * Vec3(std::cos(angle), std::sin(angle), 0);
        const ProxyUpdate update = method(proxy, field, hip, {}, {});
        drift.constrained += update.mode == Mode::constrained;
        drift.worst =
            std::max(drift.worst, std::abs(update.density - update.isovalue) / field.range());
    }
    return drift;
}

}  // namespace

TEST(Gradient, loses_the_isosurface_where_exact_and_paper_hold_it) {
    const Drift exact = round_the_cylinder(&update_exact, 3);
    const Drift paper = round_the_cylinder(&baselines::update_paper, 3);
    const Drift gradient = round_the_cylinder(&baselines::update_gradient, 3);
    const Drift improved = round_the_cylinder(&baselines::update_gradient_improved, 3);
    EXPECT_EQ(exact.constrained, 6000);
    EXPECT_LE(exact.worst, 1e-9);
    EXPECT_LE(paper.worst, 1e-9);
    EXPECT_GT(gradient.worst, 1e-4);
    EXPECT_LT(improved.worst, gradient.worst / 10);
}

TEST(Gradient, misses_a_thin_wall_that_exact_holds) {
    Geometry geometry;
    geometry.size = {21, 9, 9};
    std::vector<std::uint8_t> samples(21 * 9 * 9, 0);
    for (int i = 0; i < 81; ++i) samples[i * 21 + 10] = 255;  // one sample thick, across x
    const Field field = linear_field(Volume(geometry, samples));
    const auto end_of_crossing = [&](ProxyMethod method) {
        Proxy proxy;
        proxy.isovalue = 200;
        Vec3 scp;
        for (double x = 2.1; x < 19; x += 3) scp = method(proxy, field, {x, 4, 4}, {}, {}).scp;
        return scp[0];
    };
    EXPECT_LT(end_of_crossing(&update_exact), 10);
    EXPECT_GT(end_of_crossing(&baselines::update_gradient), 11);
    EXPECT_GT(end_of_crossing(&baselines::update_gradient_improved), 11);
}

TEST(Gradient, is_free_where_the_hand_is_free_and_refuses_what_is_not_a_position) {
    const scenes::Scene scene = scenes::make_volume("sphere");
    const Field field = linear_field(scene.volume);
    for (const ProxyMethod method :
         {&baselines::update_gradient, &baselines::update_gradient_improved}) {
        Proxy proxy;
        proxy.isovalue = scene.isovalue;
        const Vec3 far = physical_centre(field.geometry()) + Vec3(1000, 0, 0);
        EXPECT_EQ(method(proxy, field, far, {}, {}).scp, far);
        const ProxyUpdate refused = method(proxy, field, {std::nan(""), 0, 0}, {}, {});
        EXPECT_EQ(refused.status, UpdateStatus::refused);
        EXPECT_EQ(refused.scp, far);
    }
}
