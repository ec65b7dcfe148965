// Proxy: G5. Budgets are kept and an update out of budget is finished by later ones; bad input is
// refused; nothing is allocated; a copy is a second proxy.
#include <gtest/gtest.h>

#include <limits>

#include "palpate/baselines/methods.hpp"
#include "support/allocation_counter.hpp"
#include "support/constants.hpp"
#include "support/fields.hpp"
#include "support/guarantees.hpp"
#include "support/hand.hpp"
#include "support/proxy_state.hpp"

using namespace palpate;
using namespace palpate::support;

namespace {

constexpr double inf = std::numeric_limits<double>::infinity();

/// Both methods with all that they keep under any budget.
struct Method {
    const char* name;
    ProxyMethod update;
    Promises promises;
};
const std::array<Method, 2> methods{
    Method{"exact", update_exact, {}},
    Method{"paper", baselines::update_paper, {.locally_optimal = false, .never_farther = false}}};

ProxySettings with_budget(int budget) {
    ProxySettings settings;
    settings.step_budget = budget;
    return settings;
}

/// A proxy in contact on noise, pressed by a hand.
Proxy pressed(const TestField& test, Vec3& hip) {
    Proxy proxy;
    proxy.isovalue = test.isovalue;
    Hand hand(test.field.geometry(), 31);
    do {
        hip = hand.next();
        update_exact(proxy, test.field, hip);
    } while (proxy.mode != Mode::constrained);
    return proxy;
}

}  // namespace

TEST(Proxy, keeps_its_guarantees_under_small_budgets) {
    for (const Method& method : methods) {
        for (const int budget : {1, 2, 3, 7, 20}) {
            const TestField test = noise_field();
            Guarantees checked(test.field, method.update, with_budget(budget), method.promises);
            // With some seeds the paper's proxy sticks for good, and hardly ever needs its budget.
            Hand hand(test.field.geometry(), 39);
            Proxy proxy;
            ASSERT_TRUE(place(proxy, test.field, hand.next(), test.isovalue));
            for (int i = 0; i < scaled(20000) && !HasFailure(); ++i) {
                SCOPED_TRACE(method.name + std::string(" budget ") + std::to_string(budget) +
                             " seed 39 update " + std::to_string(i));
                checked.update(proxy, hand.next());
            }
            EXPECT_GT(checked.tally().out_of_budget, checked.tally().updates / 200);
            EXPECT_EQ(checked.tally().most_pieces, budget);
        }
    }
}

TEST(Proxy, out_of_budget_goes_on_in_later_updates_and_ends_where_a_large_budget_does) {
    const TestField test = noise_field();
    for (const int budget : {1, 3, 10}) {
        Hand hand(test.field.geometry(), 33, {.slide = 0, .sweep = 1, .jump = 3, .lattice = 0});
        Proxy proxy;
        ASSERT_TRUE(place(proxy, test.field, hand.next(), test.isovalue));
        int split = 0;
        int other_way = 0;
        for (int i = 0; i < scaled(20000); ++i) {
            const Vec3 hip = hand.next();
            Proxy whole = proxy;
            const ProxyUpdate expected = update_exact(whole, test.field, hip);
            ProxyUpdate part;
            int updates = 0;
            do {
                part = update_exact(proxy, test.field, hip, with_budget(budget));
                ASSERT_LT(++updates, 5000) << "budget " << budget << " update " << i;
            } while (part.status == UpdateStatus::out_of_budget);
            split += updates > 2;
            ASSERT_EQ(part.status, UpdateStatus::done);
            // Cut at other points, a path is rounded otherwise: where it meets a vertex it may then
            // take the other one of two paths that are both right.
            other_way += (part.scp - expected.scp).norm() > 1e-9 || part.mode != expected.mode;
            proxy = whole;
        }
        EXPECT_GT(split, scaled(20000) / 50);
        EXPECT_LE(other_way, 3 + scaled(20000) / 2000) << "budget " << budget;
    }
}

TEST(Proxy, what_takes_time_beside_steps_counts_as_work) {
    struct Spent {
        int pieces = 0, work = 0;
        std::uint64_t hash = 0;
    };
    const auto spent_on = [](const Field& field, double isovalue, const HandStyle& style) {
        Hand hand(field.geometry(), 38, style);
        Proxy proxy;
        proxy.isovalue = isovalue;
        Spent spent;
        Hash hash;
        for (int i = 0; i < scaled(2000); ++i) {
            const ProxyUpdate r = update_exact(proxy, field, hand.next());
            spent.pieces += r.tetrahedra;
            spent.work += r.work;
            hash.add(r.scp);
        }
        spent.hash = hash.value();
        return spent;
    };
    // On the box a hand on the lattice leads from vertex to vertex, where 48 tetrahedra meet.
    const TestField box = box_field(), noise = noise_field();
    const HandStyle on_lattice{.slide = 0, .sweep = 0, .jump = 0, .rest = 0, .lattice = 1};
    const Spent corners = spent_on(box.field, box.isovalue, on_lattice);
    EXPECT_GT(corners.work, 10 * corners.pieces);
    const Volume& volume = noise.field.volume();
    const Spent smooth_ones = spent_on(Field(volume), noise.isovalue, {});
    EXPECT_GT(smooth_ones.work, 1.5 * smooth_ones.pieces) << "each has a polynomial";
    const Spent gathered = spent_on(between_alike(volume), noise.isovalue, {});
    EXPECT_EQ(gathered.hash, smooth_ones.hash);
    EXPECT_GT(gathered.work, 1.05 * smooth_ones.work) << "their samples are gathered";
}

TEST(Proxy, changes_nothing_for_a_hip_that_is_not_finite_or_absurdly_far) {
    for (const TestField& test : {noise_field(), oblique_field(), anisotropic_field()}) {
        for (const Method& method : methods) {
            Vec3 hip;
            Proxy proxy = pressed(test, hip);
            Proxy unplaced;
            unplaced.isovalue = test.isovalue;
            const Proxy before = proxy;
            for (const double bad : {not_a_number, inf, -inf, 1e30, -1e30, 1e300, -1.7e308}) {
                for (int axes = 1; axes < 8; ++axes) {
                    Vec3 far = hip;
                    for (int a = 0; a < 3; ++a) {
                        if (axes >> a & 1) far[a] = bad;
                    }
                    const ProxyUpdate r = method.update(proxy, test.field, far, {}, {});
                    ASSERT_EQ(r.status, UpdateStatus::refused) << far.transpose();
                    ASSERT_EQ(hash_of(proxy), hash_of(before));
                    ASSERT_EQ(r.scp, before.scp_physical);
                    ASSERT_EQ(r.mode, before.mode);
                    ASSERT_EQ(r.isovalue, before.isovalue);
                    const std::uint64_t fresh = hash_of(unplaced);
                    method.update(unplaced, test.field, far, {}, {});
                    ASSERT_EQ(hash_of(unplaced), fresh);
                }
            }
            // It continues as if nothing had happened.
            Proxy other = before;
            method.update(proxy, test.field, hip, {}, {});
            method.update(other, test.field, hip, {}, {});
            EXPECT_EQ(hash_of(proxy), hash_of(other));
        }
    }
}

TEST(Proxy, is_never_not_a_number_whatever_the_isovalue) {
    const TestField test = noise_field();
    for (const double isovalue : {inf, -inf, not_a_number, 1e308, -1e308, 1e20, -1e20}) {
        Hand hand(test.field.geometry(), 34);
        Proxy proxy;
        proxy.isovalue = isovalue;
        for (int i = 0; i < 50; ++i) {
            const ProxyUpdate r = update_exact(proxy, test.field, hand.next());
            ASSERT_TRUE(r.scp.allFinite()) << isovalue;
            ASSERT_TRUE(proxy.scp.folded.allFinite()) << isovalue;
            ASSERT_TRUE(std::isfinite(r.density)) << isovalue;
            // All of space is solid at -inf.
            ASSERT_EQ(!(isovalue > -inf), r.status == UpdateStatus::refused) << isovalue;
        }
    }
}

TEST(Proxy, is_a_value_and_its_copy_goes_on_bit_for_bit_the_same) {
    const TestField test = noise_field();
    const ProxySettings settings{.friction = {0.3, 0.2}};
    Hand hand(test.field.geometry(), 36);
    Proxy proxy;
    proxy.isovalue = test.isovalue;
    for (int i = 0; i < 500; ++i) update_exact(proxy, test.field, hand.next(), settings);
    Proxy copy = proxy;
    const Field field_copy = test.field;
    Hand same_hand = hand;
    for (int i = 0; i < 500; ++i) update_exact(copy, field_copy, same_hand.next(), settings);
    EXPECT_NE(hash_of(copy), hash_of(proxy));
    for (int i = 0; i < 500; ++i) update_exact(proxy, test.field, hand.next(), settings);
    EXPECT_EQ(hash_of(copy), hash_of(proxy));
}

TEST(Proxy, allocates_nothing_in_a_hundred_thousand_updates) {
    for (const TestField& test : {noise_field(), oblique_field(), marschner_lobb_field()}) {
        for (const ProxyMethod method : {update_exact, baselines::update_paper}) {
            Hand hand(test.field.geometry(), 37);
            Proxy proxy;
            proxy.isovalue = test.isovalue;
            const std::int64_t before = allocation_count();
            for (int i = 0; i < scaled(100000); ++i) {
                // Every now and then the isovalue moves, so that recovery is among them.
                if (i % 100 == 0) {
                    const double off = i % 200 == 0 ? 0.05 : -0.05;
                    proxy.isovalue = test.isovalue + off * test.field.range();
                }
                const ProxySettings settings{.friction = {i % 2 * 0.4, i % 2 * 0.2}};
                method(proxy, test.field, hand.next(), settings, {});
            }
            ASSERT_EQ(allocation_count() - before, 0) << test.name;
        }
    }
    const std::int64_t before = allocation_count();
    ::operator delete(::operator new(8));
    EXPECT_EQ(allocation_count() - before, 1) << "the counter does not count";
}
