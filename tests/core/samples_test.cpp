// Samples: a field reads versions with bricks correctly, cell by cell; versions share what did not
// change.
#include "palpate/samples.hpp"

#include <gtest/gtest.h>

#include <array>
#include <set>

#include "support/constants.hpp"
#include "support/edits.hpp"

using namespace palpate;
using namespace palpate::support;

namespace {

/// Calls `check(name, before, edit, after)` for chains of random edits on all types and grids.
template <class Check>
void over_random_edits(int each, Check&& check) {
    std::uint64_t seed = 1;
    for (const SampleType type : sample_types) {
        for (const Geometry& geometry : odd_grids()) {
            Random random(++seed);
            auto samples = samples_of(noise_of(type, geometry, seed));
            for (int i = 0; i < each; ++i) {
                const Edit edit = random_edit(random, geometry, type);
                const Edited after = edited(samples, edit);
                SCOPED_TRACE(std::string(name_of(type)) + " " + std::to_string(geometry.size[0]) +
                             " edit " + std::to_string(i));
                check(*samples, edit, after);
                if (testing::Test::HasFailure()) return;
                samples = after.samples;
            }
        }
    }
}

TEST(Samples, a_field_of_edited_bricks_is_the_field_of_the_same_samples_in_one_piece) {
    std::int64_t cells = 0, edited_cells = 0;
    over_random_edits(scaled(20) + 1, [&](const Samples&, const Edit&, const Edited& after) {
        constexpr double background = -7.25;
        const Field bricks = linear_field(after.samples, Solid::above, background);
        const Field plain = linear_field(flattened(*after.samples), Solid::above, background);
        Geometry padded = bricks.geometry();
        padded.size += Index3::Constant(4);
        for_each_sample(padded, [&](const Index3& at) {
            const Index3 cell = at - Index3::Constant(2);
            ASSERT_EQ(bricks.cell(cell), plain.cell(cell)) << cell.transpose();
            ASSERT_EQ(bricks.around(cell), plain.around(cell)) << cell.transpose();
            ++cells;
        });
        const Volume& first = after.samples->volume();
        for_each_sample(bricks.geometry(), [&](const Index3& at) {
            edited_cells += plain.volume().sample(at) != first.sample(at);
            ASSERT_EQ(after.samples->sample(at), plain.volume().sample(at));
        });
        EXPECT_LE(after.samples->minimum(), plain.volume().minimum());
        EXPECT_GE(after.samples->maximum(), plain.volume().maximum());
    });
    EXPECT_GT(edited_cells, cells / 100);
}

TEST(Samples, neighbouring_bricks_hold_the_samples_between_them_alike) {
    over_random_edits(scaled(20) + 1, [&](const Samples&, const Edit&, const Edited& after) {
        const Bricks* bricks = after.samples->bricks();
        if (!bricks) return;
        const Volume whole = flattened(*after.samples);
        const auto bytes = size_of(whole.type());
        const Index3& size = whole.geometry().size;
        bricks->for_each([&](const Index3& brick, const Brick& found) {
            const Index3 low = brick * Bricks::edge;
            for (int at = 0; at < int(Bricks::per_brick); ++at) {
                const Index3 sample = low + Index3(at % 17, at / 17 % 17, at / (17 * 17));
                const std::byte* held = found.samples.get() + static_cast<std::size_t>(at) * bytes;
                if ((sample.array() >= size.array()).any()) {
                    const std::byte nothing[4] = {};
                    ASSERT_EQ(std::memcmp(held, nothing, bytes), 0) << "beyond the grid";
                    continue;
                }
                const auto place =
                    (static_cast<std::size_t>(sample[2]) * size[1] + sample[1]) * size[0] +
                    sample[0];
                ASSERT_EQ(
                    std::memcmp(held, static_cast<const std::byte*>(whole.data()) + place * bytes,
                                bytes),
                    0)
                    << sample.transpose();
            }
        });
    });
}

TEST(Samples, the_version_before_an_edit_stays_bit_for_bit) {
    std::vector<std::pair<std::shared_ptr<const Samples>, Volume>> versions;
    std::uint64_t seed = 50;
    for (const SampleType type : sample_types) {
        for (const Geometry& geometry : odd_grids()) {
            Random random(++seed);
            auto samples = samples_of(noise_of(type, geometry, seed));
            for (int i = 0; i < scaled(20) + 1; ++i) {
                versions.emplace_back(samples, flattened(*samples));
                samples = edited(samples, random_edit(random, geometry, type)).samples;
            }
        }
    }
    for (const auto& [samples, copy] : versions) {
        ASSERT_TRUE(same_bits(flattened(*samples), copy));
    }
}

TEST(Samples, an_edit_makes_those_bricks_anew_that_hold_what_it_changed_and_shares_all_others) {
    std::int64_t shared = 0, fresh = 0;
    over_random_edits(scaled(40) + 1, [&](const Samples& before, const Edit&, const Edited& after) {
        EXPECT_EQ(after.samples->volume().data(), before.volume().data());
        if (after.changed.empty()) {
            EXPECT_EQ(after.samples.get(), &before);
            return;
        }
        std::set<std::array<int, 3>> touched;
        const Bricks& now = *after.samples->bricks();
        for_each_sample(before.geometry(), [&](const Index3& at) {
            if (before.sample(at) == after.samples->sample(at)) return;
            for (int side = 0; side < 8; ++side) {
                Index3 brick = at / 16;
                bool there = true;
                for (int a = 0; a < 3; ++a) {
                    if (!(side >> a & 1)) continue;
                    there = there && at[a] % 16 == 0 && at[a] > 0;
                    --brick[a];
                }
                if (there) touched.insert({brick[0], brick[1], brick[2]});
            }
        });
        const Bricks none(before.geometry().size);
        const Bricks& old = before.bricks() ? *before.bricks() : none;
        std::set<std::array<int, 3>> apart;
        now.for_each_apart(old, [&](const Index3& at, const auto& mine, const auto& theirs) {
            ASSERT_TRUE(now.at(at) && *now.at(at) == mine);
            ASSERT_TRUE(theirs == (old.at(at) ? *old.at(at) : Brick{}));
            apart.insert({at[0], at[1], at[2]});
        });
        ASSERT_EQ(apart, touched);
        fresh += static_cast<std::int64_t>(apart.size());
        std::size_t count = 0;
        now.for_each([&](const Index3& at, const auto&) {
            shared += !touched.contains({at[0], at[1], at[2]});
            ++count;
        });
        ASSERT_EQ(now.size(), count);
        EXPECT_EQ(bytes_apart(*after.samples, before),
                  touched.size() * Bricks::per_brick * size_of(before.type()));
    });
    EXPECT_GT(shared, fresh / 4);
    EXPECT_GT(fresh, 100);
}

TEST(Samples, flattened_without_edits_is_the_volume_itself) {
    const Volume volume = noise_volume<std::int16_t>(grid(cube(20)), 1, -5, 500);
    EXPECT_EQ(flattened(Samples(volume)).data(), volume.data());
}

TEST(Samples, bricks_that_do_not_fit_the_grid_are_refused) {
    const Volume volume = noise_volume<std::uint8_t>(grid(cube(33)), 1, 0, 256);
    EXPECT_NO_THROW((void)Samples(volume).with(Bricks(volume.geometry().size), 0, 255));
    EXPECT_THROW((void)Samples(volume).with(Bricks(cube(32)), 0, 255), std::invalid_argument);
    const Bricks::Change beyond{{3, 0, 0}, {}};
    EXPECT_THROW((void)Bricks(cube(33)).with({&beyond, 1}), std::out_of_range);
}

TEST(Samples, sequences_that_are_none_are_refused) {
    const Volume a = noise_volume<std::uint8_t>(grid(cube(4)), 1, 0, 256);
    const Volume wider = noise_volume<std::uint8_t>(grid({5, 4, 4}), 1, 0, 256);
    const Volume other = noise_volume<std::int16_t>(grid(cube(4)), 1, 0, 256);
    const auto refused = [](std::vector<Frame> frames, double period = 0) {
        EXPECT_THROW(Samples(std::move(frames), period), std::invalid_argument);
    };
    refused({});
    refused({{0, a}, {1, wider}});
    refused({{0, a}, {1, other}});
    refused({{0, a}, {0, a}});
    refused({{1, a}, {0, a}});
    refused({{0, a}, {std::nan(""), a}});
    refused({{std::numeric_limits<double>::infinity(), a}});
    refused({{0, a}, {1, a}}, 1);
    refused({{0, a}, {1, a}}, -1);
    refused({{0, a}, {1, a}}, std::nan(""));
    EXPECT_NO_THROW(Samples({{0, a}, {1, a}}, 1.5));
    EXPECT_NO_THROW(Samples({{-3, a}}));
}

}  // namespace
