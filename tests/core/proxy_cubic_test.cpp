// The proxy on the smooth field: its motion over crests, and the piece that it keeps for the next
// update. Its guarantees are in proxy_guarantees_test.cpp.
#include <gtest/gtest.h>

#include "proxy/kept_samples.hpp"
#include "support/cubic_guarantees.hpp"
#include "support/edits.hpp"
#include "support/fields.hpp"
#include "support/hand.hpp"

using namespace palpate;
using namespace palpate::support;

// With the hand near its centre, a ball hides the foot, and no motion towards the hand is long.
TEST(CubicProxy, passes_over_crests_in_few_motions) {
    constexpr double radius = 6;
    const Field field(scenes::ball(Index3::Constant(40)), Solid::above, std::nullopt,
                      Interpolation::cubic);
    const double isovalue = value_at(field, {radius, 0, 0});
    int pieces = 0;
    for (const double from_centre : {0.02, 0.05, 0.1, 0.2}) {
        for (const double angle : {0.3, 1.0, 2.0}) {
            Proxy proxy;
            ASSERT_TRUE(place(proxy, field, {0.1, 0.2, radius + 1}, isovalue));
            const auto hand_at = [&](double turned) {
                const double arm = from_centre * radius;
                return Vec3(arm * std::sin(turned), 0.01, arm * std::cos(turned));
            };
            update_exact(proxy, field, hand_at(0.1));
            CubicGuarantees checked(field);
            pieces += checked.update(proxy, hand_at(0.1 + angle)).tetrahedra;
        }
    }
    EXPECT_LT(pieces, 650);  // 924 where each motion ended on the surface
}

TEST(CubicProxy, what_an_update_keeps_for_the_next_changes_no_result) {
    const Geometry geometry = grid(cube(12), {1, 1, 1.5});
    const auto noise = [&](std::uint64_t seed) {
        return noise_of(SampleType::uint8, geometry, seed);
    };
    const auto sequence = std::make_shared<const Samples>(
        std::vector<Frame>{{0, noise(1)}, {1, noise(2)}, {2, noise(3)}});
    auto samples = std::make_shared<const Samples>(std::vector<Frame>{{0, noise(4)}});
    const auto field_of = [](const auto& of, Solid solid) {
        return Field(of, solid, std::nullopt, Interpolation::cubic);
    };
    Field field = field_of(samples, Solid::above);
    Proxy proxy, forgetful;
    proxy.isovalue = forgetful.isovalue = 128;
    Hand hand(geometry, 31, {.slide = 8, .sweep = 1, .jump = 1, .margin = -1});
    Random random(32);
    int reused = 0;
    const int count = scaled(40000);
    for (int i = 0; i < count; ++i) {
        SCOPED_TRACE(i);
        switch (random.below(40)) {
            case 0:
            case 1: {
                const Brush brush{.kind = BrushKind::paint, .value = random.uniform(0, 255)};
                const Vec3 at = proxy.scp_physical;
                samples = edited(samples, edit::Stroke{brush, at, at}).samples;
                if (field.samples().frames().size() == 1) field.use(samples);
                break;
            }
            case 2:
                field.set_time(random.uniform(0, 2));
                break;
            case 3:
                proxy.isovalue = forgetful.isovalue = random.uniform(100, 156);
                break;
            case 4:
                field.use(random.chance(0.5) ? sequence : samples);
                break;
            case 5:
                field = field_of(samples, random.chance(0.5) ? Solid::above : Solid::below);
                break;
            default:
                break;
        }
        const cubic::Piece before = Kept::piece(proxy.kept);
        forgetful.kept_samples = {};
        const Vec3 hip = hand.next();
        const ProxyUpdate a = update_exact(proxy, field, hip, {});
        const ProxyUpdate b = update_exact(forgetful, field, hip, {});
        ASSERT_EQ(a.scp, b.scp);
        ASSERT_EQ(a.density, b.density);
        ASSERT_EQ(a.status, b.status);
        ASSERT_EQ(a.tetrahedra, b.tetrahedra);
        reused += Kept::piece(proxy.kept).value == before.value &&
                  Kept::piece(proxy.kept).gradient == before.gradient;
    }
    EXPECT_GT(reused, count / 3);
    EXPECT_LT(reused, count - count / 20);
}
