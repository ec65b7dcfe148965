// The proxy on the smooth field: the guarantees G1-G5 on difficult fields, judged by the reference.
#include <gtest/gtest.h>

#include "proxy/kept_samples.hpp"
#include "support/cubic_guarantees.hpp"
#include "support/edits.hpp"
#include "support/fields.hpp"
#include "support/hand.hpp"

using namespace palpate;
using namespace palpate::support;

namespace {

CubicTally run_smooth(const TestField& test, std::uint64_t seed, const HandStyle& style = {}) {
    const Field field = smooth(test.field);
    CubicGuarantees checked(field);
    Hand hand(field.geometry(), seed, style);
    Proxy proxy;
    proxy.isovalue = test.isovalue;
    const int count = scaled_or_asked(20000);
    for (int i = 0; i < count; ++i) {
        const Vec3 hip = hand.next();
        SCOPED_TRACE(test.name + " seed " + std::to_string(seed) + " update " + std::to_string(i));
        checked.update(proxy, hip);
        if (testing::Test::HasFailure()) break;
    }
    checked.print(test.name);
    return checked.tally();
}

void expect_much_contact(const CubicTally& t, double constrained = 0.2) {
    EXPECT_GT(double(t.constrained) / t.updates, constrained);
    EXPECT_GT(t.long_moves, t.updates / 12);
    EXPECT_EQ(t.out_of_budget, 0);
}

}  // namespace

TEST(CubicProxy, keeps_its_guarantees_on_random_noise) {
    expect_much_contact(run_smooth(noise_field(), 11));
}
TEST(CubicProxy, keeps_its_guarantees_on_salt) {
    expect_much_contact(run_smooth(salt_field(), 12), 0.1);
}
TEST(CubicProxy, keeps_its_guarantees_on_a_lace_thinner_than_a_voxel) {
    const HandStyle sweeps{.slide = 4, .sweep = 6, .margin = -2};
    run_smooth(shell_field(), 13, sweeps);
}
TEST(CubicProxy, keeps_its_guarantees_on_a_grid_aligned_box) {
    const HandStyle degenerate{.slide = 2, .sweep = 1, .jump = 1, .lattice = 6, .margin = -3};
    expect_much_contact(run_smooth(box_field(), 14, degenerate));
}
TEST(CubicProxy, keeps_its_guarantees_on_anisotropic_noise) {
    TestField test = anisotropic_field();
    test.isovalue = 1150;  // nearer the mean: the smooth field has lower peaks
    expect_much_contact(run_smooth(test, 15));
}
TEST(CubicProxy, keeps_its_guarantees_on_an_oblique_grid) {
    expect_much_contact(run_smooth(oblique_field(), 16));
}
TEST(CubicProxy, keeps_its_guarantees_on_marschner_lobb) {
    expect_much_contact(run_smooth(marschner_lobb_field(), 17));
}
TEST(CubicProxy, keeps_its_guarantees_where_the_solid_is_below) {
    expect_much_contact(run_smooth(noise_field(7, Solid::below), 18));
}
TEST(CubicProxy, keeps_its_guarantees_on_floats_far_from_zero) {
    expect_much_contact(run_smooth(offset_field(), 19), 0.1);
}
TEST(CubicProxy, keeps_its_guarantees_on_walls_of_one_sample) {
    TestField test = sheet_field();
    test.isovalue = 180;  // three quarters of a full wall's height are 191
    const HandStyle sweeps{.slide = 4, .sweep = 4, .jump = 1, .margin = -3};
    expect_much_contact(run_smooth(test, 21, sweeps), 0.1);
}
TEST(CubicProxy, keeps_its_guarantees_on_two_slices) {
    const Geometry geometry = grid({40, 30, 2}, {1, 1, 3});
    const TestField test{"two slices",
                         linear_field(noise_volume<std::uint8_t>(geometry, 9, 0, 256)), 80};
    expect_much_contact(run_smooth(test, 22), 0.1);
}
TEST(CubicProxy, keeps_its_guarantees_on_a_plateau_with_ripples_of_a_millionth) {
    Random random(10);
    const Volume volume = volume_of<float>(grid(cube(24)), [&](const Index3& i) {
        if (i == Index3(0, 0, 0)) return 2.0;
        return i[0] < 14 ? 1 + random.uniform(-1e-6, 1e-6) : 0.0;
    });
    const CubicTally t = run_smooth({"ripples", linear_field(volume), 1}, 23);
    EXPECT_GT(double(t.constrained) / t.updates, 0.1);
}
TEST(CubicProxy, keeps_its_guarantees_on_plateaus_at_the_isovalue) {
    expect_much_contact(run_smooth(terraces_field(), 20));
}

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
