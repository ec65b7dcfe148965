// Proxy: the domain in which the guarantees hold. At its border they hold, beyond it the proxy
// refuses, and data far from zero keep them by an offset.
#include <gtest/gtest.h>

#include <cmath>

#include "palpate/baselines/methods.hpp"
#include "palpate/session.hpp"
#include "support/constants.hpp"
#include "support/fields.hpp"
#include "support/guarantees.hpp"
#include "support/hand.hpp"
#include "support/layer.hpp"
#include "support/press.hpp"
#include "support/proxy_state.hpp"
#include "support/scripted_device.hpp"

using namespace palpate;
using namespace palpate::support;

namespace {

/// A hand that is thrown to the border of the domain, and back, in more than half of its updates:
/// along an axis, a diagonal or anything between them.
class ThrownHand {
  public:
    ThrownHand(const Geometry& geometry, std::uint64_t seed)
        : geometry_(geometry), near_(geometry, seed), random_(seed) {}

    Vec3 next() {
        const Vec3 hip = near_.next();
        if (!random_.chance(0.6)) return hip;
        Vec3 index = index_from_physical(geometry_, hip);
        const bool corner = random_.chance(0.3);
        const double part = random_.chance(0.5) ? 1 : random_.uniform(0.01, 1);
        for (int a = 0; a < 3; ++a) {
            if (!corner && random_.chance(0.5)) continue;
            // Just within it: the way through millimetres and back rounds.
            const double out = part * farthest_hip * (1 - 1e-12);
            index[a] = random_.chance(0.5) ? -out : geometry_.size[a] + out;
        }
        return physical_from_index(geometry_, index);
    }

  private:
    Geometry geometry_;
    Hand near_;
    Random random_;
};

void expect_guarantees_at_the_border(const TestField& test, std::uint64_t seed, int count) {
    Guarantees checked(test.field, update_exact, {}, {.samples_per_voxel = 1});
    ThrownHand hand(test.field.geometry(), seed);
    Proxy proxy;
    proxy.isovalue = test.isovalue;
    int accepted = 0;
    for (int i = 0; i < count && !testing::Test::HasFailure(); ++i) {
        SCOPED_TRACE(test.name + " update " + std::to_string(i));
        accepted += checked.update(proxy, hand.next()).status == UpdateStatus::done;
    }
    checked.print(test.name);
    EXPECT_EQ(accepted, checked.tally().updates);
    EXPECT_GT(checked.tally().constrained, count / 100);
}

TEST(ProxyDomain, guarantees_hold_for_hands_100_000_voxels_outside_the_grid) {
    constexpr int updates = scaled(10000);
    expect_guarantees_at_the_border(noise_field(), 1, updates);
    expect_guarantees_at_the_border(salt_field(), 2, updates);
    expect_guarantees_at_the_border(box_field(), 3, updates);
    expect_guarantees_at_the_border(sheet_field(), 6, updates);
    expect_guarantees_at_the_border(anisotropic_field(), 4, updates);
    expect_guarantees_at_the_border(oblique_field(), 5, updates);
}

TEST(ProxyDomain, hands_farther_outside_are_refused_and_leave_the_proxy_as_it_is) {
    const TestField test = box_field();
    const Vec3 centre = Vec3::Constant(11.5);
    for (const ProxyMethod method : {&update_exact, &baselines::update_paper}) {
        for (int face = 0; face < 6; ++face) {
            Proxy proxy;
            proxy.isovalue = test.isovalue;
            method(proxy, test.field, Vec3::Constant(-2), {}, {});
            Vec3 hip = centre;
            const int axis = face / 2;
            const double border = face % 2 ? -farthest_hip : 24 + farthest_hip;
            hip[axis] = border * (1 + 1e-9);
            const std::uint64_t before = hash_of(proxy);
            EXPECT_EQ(method(proxy, test.field, hip, {}, {}).status, UpdateStatus::refused);
            EXPECT_EQ(hash_of(proxy), before);
            hip[axis] = border;
            EXPECT_EQ(method(proxy, test.field, hip, {}, {}).status, UpdateStatus::done);
        }
    }
}

/// A field far from zero, and the same less its offset, where doubles have digits to spare. All
/// numbers are chosen so that the difference is exact.
struct Pair {
    TestField far;
    Field near;
    double near_isovalue;
};

/// `levels` multiples of `step` at random.
Volume steps(double base, double step, int levels) {
    Random random(4);
    return volume_of<float>(grid(cube(24)),
                            [&](const Index3&) { return base + step * random.below(levels); });
}

Pair noise_at(const std::string& name, double base, double step, double isovalue) {
    return {{name, linear_field(steps(base, step, 3)), base + isovalue},
            linear_field(steps(0, step, 3)),
            (base + isovalue) - base};
}

/// A constant block in a background that is `depth` away.
Pair block_at(const std::string& name, double base, Solid solid, double depth, double isovalue) {
    const double background = base + depth;
    return {{name, linear_field(steps(base, 0, 1), solid, background), base + isovalue},
            linear_field(steps(0, 0, 1), solid, background - base),
            (base + isovalue) - base};
}

/// The worst G1 and G2 as the near field tells them, as parts of its range.
struct Worst {
    double g1 = 0, g2 = 0;
    int constrained = 0;
};
Worst worst_of(const Pair& pair, ProxyMethod method) {
    Hand hand(pair.far.field.geometry(), 7);
    Proxy proxy;
    proxy.isovalue = pair.far.isovalue;
    Worst worst;
    for (int i = 0; i < scaled(20000); ++i) {
        const ProxyUpdate update = method(proxy, pair.far.field, hand.next(), {}, {});
        const double excess = pair.near.sign() *
                              (value_at(pair.near, proxy.scp) - pair.near_isovalue) /
                              pair.near.range();
        worst.g1 = std::max(worst.g1, excess);
        if (update.mode == Mode::free) continue;
        ++worst.constrained;
        worst.g2 = std::max(worst.g2, std::abs(excess));
    }
    return worst;
}

TEST(ProxyDomain, guarantees_hold_for_data_however_far_from_zero) {
    const double huge = 1e37F;
    const double digit = std::nextafter(1e37F, 2e37F) - huge;
    const std::vector<Pair> pairs{
        noise_at("100 million and the next floats", 1e8, 8, 7.7),
        noise_at("1e37 and the next floats", huge, digit, 0.7 * digit),
        noise_at("last without an offset", (1 << 20) - 2, 1, 1.7),
        noise_at("first with an offset", 1 << 20, 1, 1.7),
        block_at("1e8 +- 0.3", 1e8, Solid::above, -0.6, -0.1),
        block_at("-1e8 +- 0.3, solid below", -1e8, Solid::below, 0.6, 0.2)};
    for (const Pair& pair : pairs) {
        for (const ProxyMethod method : {&update_exact, &baselines::update_paper}) {
            const Worst worst = worst_of(pair, method);
            EXPECT_LE(worst.g1, 1e-9) << pair.far.name;
            EXPECT_LE(worst.g2, 1e-9) << pair.far.name;
            EXPECT_GT(worst.constrained, scaled(20000) / 20) << pair.far.name;
        }
    }
    EXPECT_EQ(pairs[2].far.field.offset(), 0);
    EXPECT_EQ(pairs[3].far.field.offset(), 1 << 20);
}

TEST(ProxyDomain, constant_data_however_large_are_solid_or_free_throughout) {
    const double huge = 1e37F;
    const Field field = linear_field(steps(huge, 0, 1));
    EXPECT_EQ(value_at(field, Vec3::Constant(3.3)), huge);
    for (const double isovalue : {huge, std::nextafter(huge, infinity), 2 * huge}) {
        Hand hand(field.geometry(), 3);
        Proxy proxy;
        proxy.isovalue = isovalue;
        for (int i = 0; i < 1000; ++i) {
            const Vec3 hip = hand.next();
            EXPECT_EQ(update_exact(proxy, field, hip, {}, {}).scp, hip);
        }
    }
    Proxy proxy;
    proxy.isovalue = std::nextafter(huge, 0.0);
    EXPECT_EQ(update_exact(proxy, field, Vec3::Constant(3.3), {}, {}).status,
              UpdateStatus::recovering);
}

TEST(ProxyDomain, an_offset_is_seen_by_nobody_who_asks_for_densities) {
    const Pair pair = noise_at("", 1e8, 8, 7.7);
    const Field& far = pair.far.field;
    EXPECT_EQ(far.offset(), 1e8);
    Random random(5);
    for (int i = 0; i < 1000; ++i) {
        const Vec3 p = random.point(-2, 25);
        EXPECT_EQ(value_at(far, p), 1e8 + value_at(pair.near, p));
        EXPECT_EQ(gradient_at(far, p), gradient_at(pair.near, p));
    }
    Proxy proxy;
    ASSERT_TRUE(place(proxy, far, Vec3::Constant(-2), pair.far.isovalue));
    Hand hand(far.geometry(), 9);
    for (int i = 0; i < 1000; ++i) {
        const ProxyUpdate update = update_exact(proxy, far, hand.next(), {}, {});
        EXPECT_EQ(update.isovalue, pair.far.isovalue);
        EXPECT_EQ(update.density, value_at(far, proxy.scp));
        if (update.mode == Mode::constrained) {
            EXPECT_EQ(update.density, update.isovalue);
        }
    }
}

TEST(ProxyDomain, inverted_data_far_from_zero_give_the_same_bits) {
    const Volume data = noise_volume<float>(grid(cube(24)), 5, 9999997, 10000003);
    const Volume inverted =
        volume_of<float>(grid(cube(24)), [&](const Index3& i) { return -data.sample(i); });
    for (const Interpolation how : {Interpolation::linear, Interpolation::cubic}) {
        const Field above(data, Solid::above, std::nullopt, how);
        const Field below(inverted, Solid::below, std::nullopt, how);
        ASSERT_NE(above.offset(), 0);
        Proxy one, other;
        one.isovalue = 10000000.137;
        other.isovalue = -one.isovalue;
        Hand hand(data.geometry(), 10);
        for (int i = 0; i < scaled(5000); ++i) {
            const Vec3 hip = hand.next();
            const ProxyUpdate a = update_exact(one, above, hip),
                              b = update_exact(other, below, hip);
            ASSERT_EQ(a.scp, b.scp) << i;
            ASSERT_EQ(a.density, -b.density) << i;
        }
    }
}

/// A hand in noise with all lengths of the scene in units of so many millimetres: forces, and the
/// work of each tick.
enum class With { point, layers, tool };
std::pair<std::vector<Vec3>, std::vector<int>> felt_in_units_of(double unit, With with,
                                                                Interpolation interpolation) {
    const Index3 size(16, 14, 12);
    const Geometry geometry =
        grid(size, unit * Vec3(1, 0.5, 1.75), unit * Vec3(-3, 4, 5), oblique_direction());
    const Field field(noise_volume<std::uint8_t>(geometry, 5, 0, 256), Solid::above, 0,
                      interpolation);
    RendererSettings settings = at_once();
    settings.transform.scale = unit;
    settings.device.maximum_torque = 100;
    settings.proxy.friction = {0.3, 0.2};
    if (with == With::layers) {
        auto layers = std::make_shared<Layers>();
        for (int i = 0; i < 3; ++i) {
            layers->layers.push_back(
                layer_of(std::to_string(i), 100 + 25 * i, 0.3 + 0.2 * i, i == 2 ? infinity : 0.4));
            layers->layers.back()[HapticProperty::drag] = 0.01 / unit;
        }
        layers->closing = unit;
        layers->needle = Needle{};
        settings.layers = layers;
    }
    if (with == With::tool) {
        const Tool box = box_tool({2, 1, 1.5}, 0.5);
        std::vector<Vec3> points;
        for (const Vec3& point : box.points()) points.push_back(unit * point);
        settings.tool = std::make_shared<const Tool>(points);
    }
    Session session{make_renderer(field, 150, settings), {.fastest_hand = infinity}};
    Hand hand(grid(size), 5);
    std::pair<std::vector<Vec3>, std::vector<int>> felt;
    for (int i = 0; i < 600; ++i) {
        DeviceReading reading = ready_at(hand.next());
        reading.orientation =
            turned(Quaternion::Identity(), 0.01 * i * Vec3(1, 2, 3)).toRotationMatrix();
        const Tick tick = advance(session, (i + 1) * period, reading).tick;
        felt.first.push_back(tick.force);
        felt.second.push_back(tick.proxy.work);
    }
    return felt;
}

/// Powers of two change no digit.
TEST(ProxyDomain, a_scene_in_another_unit_of_length_feels_the_same) {
    for (const Interpolation interpolation : {Interpolation::linear, Interpolation::cubic}) {
        for (const With with : {With::point, With::layers, With::tool}) {
            if (with == With::tool && interpolation == Interpolation::linear) continue;
            const auto usual = felt_in_units_of(1, with, interpolation);
            const int most = with == With::tool ? 14 : 97;  // tools are at least 1e-6 mm large
            for (const int power : {-most, -most / 2, most / 2, most}) {
                const auto other = felt_in_units_of(std::ldexp(1.0, power), with, interpolation);
                EXPECT_EQ(usual.first, other.first) << "2^" << power << " mm";
                EXPECT_EQ(usual.second, other.second) << "2^" << power << " mm";
            }
        }
    }
}

}  // namespace
