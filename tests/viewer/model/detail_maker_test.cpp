// Details with edits: the final picture, and the samples that change on the way.
#include <gtest/gtest.h>
#include <atomic>
#include <cstring>
#include <map>
#include <mutex>

#include "apps/viewer/model/detail.hpp"
#include "palpate/edit.hpp"
#include "stream/box_bytes.hpp"
#include "support/edits.hpp"
#include "support/eventually.hpp"
#include "support/fields.hpp"
#include "support/resident.hpp"

namespace palpate::viewer {
namespace {

using namespace palpate::support;

/// Level 0 of 96 x 80 x 64 samples, an overview of every fourth, and a box of either.
struct Store {
    Geometry geometry = grid({96, 80, 64}, {1, 1, 1}, {3, 4, 5}, oblique_direction());
    Volume level = noise_of(SampleType::uint8, geometry, 3);
    Volume overview = noise_of(SampleType::uint8, coarse(), 4);
    PatchChoice patch{0, {{16, 12, 8}, {60, 70, 50}}, {5, 4, 3}, {14, 16, 11}};

    Geometry coarse() const {
        Geometry all = geometry;
        all.size = {24, 20, 16};
        all.spacing *= 4;
        all.origin = physical_from_index(geometry, Vec3::Constant(1.5));
        return all;
    }
    /// A version of the box with noise of its own, as if more pieces had come.
    stream::Detail detail(const SampleBox& box, std::uint64_t seed) const {
        Geometry part = geometry;
        part.size = box.high - box.low + Index3::Ones();
        part.origin = physical_from_index(geometry, box.low.cast<double>());
        return {{0, box}, noise_of(SampleType::uint8, part, seed), 1, 0, whole_box(part)};
    }
};

Volume flat(const DetailField& made) {
    return flattened(made.field.samples());
}
bool same_bytes(const Volume& a, const Volume& b) {
    return a.geometry() == b.geometry() && std::memcmp(a.data(), b.data(), a.bytes()) == 0;
}

/// The last result of a maker for each viewer. Counts samples that changed without a report.
struct Shown {
    std::mutex mutex;
    std::map<int, std::shared_ptr<const DetailField>> last;
    std::atomic<int> made = 0, untold = 0;

    void take(int viewer, const std::shared_ptr<const DetailField>& now) {
        const std::scoped_lock lock(mutex);
        auto& before = last[viewer];
        if (before && before->of == now->of) count_untold(*before, *now);
        before = now;
        ++made;
    }

  private:
    void count_untold(const DetailField& before, const DetailField& now) {
        const Volume a = flat(before), b = flat(now);
        for_each_sample(b.geometry(), [&](const Index3& at) {
            const bool told = (at.array() >= now.changed.low.array()).all() &&
                              (at.array() <= now.changed.high.array()).all();
            untold += !told && a.sample(at) != b.sample(at);
        });
    }
};

Field overview_field(const Store& store) {
    return Field(store.overview, Solid::below, 7.0, Interpolation::cubic);
}

Volume expected_of(const Store& store, int viewer, const Volume& read, const Samples& edited) {
    const Volume with_edits = flattened(*ShownEdits(read).of(edited));
    if (viewer != DetailMaker::scene) return with_edits;
    Field overview = overview_field(store);
    overview.use(ShownEdits(store.overview).of(edited));
    return joined_samples(with_edits, overview, store.patch);
}

/// Versions with edits of a store, each of some version before.
struct Versions {
    const Store& store;
    Random random{5};
    std::vector<std::shared_ptr<const Samples>> all{PartOf(store.level).samples()};

    explicit Versions(const Store& of) : store(of) {}
    void add() {
        const Index3 low(random.below(90), random.below(70), random.below(60));
        const Index3 high = (low + Index3(random.below(40), random.below(9), random.below(9)))
                                .cwiseMin(store.geometry.size - Index3::Ones());
        const auto read = [&](const SampleBox& box, std::span<std::byte> out) {
            stream::copy_box(whole_box(store.geometry),
                             static_cast<const std::byte*>(store.level.data()), box, out.data(), 1);
        };
        all.push_back(edited(all[random.bits() % all.size()],
                             edit::Fill{{low, high}, random.uniform(0, 255)}, read)
                          .samples);
    }
};

TEST(DetailMaker, shows_the_last_samples_with_the_last_edits_and_tells_what_changes) {
    const Store store;
    const std::array<SampleBox, 2> boxes{store.patch.box, {{0, 0, 30}, {95, 79, 41}}};
    constexpr std::array<int, 2> viewers{DetailMaker::scene, 2};
    Shown shown;
    DetailMaker maker(overview_field(store), {store.geometry.size},
                      [&](int viewer, const auto& made) { shown.take(viewer, made); }, {});
    maker.want_patch(store.patch);
    Versions versions(store);
    Random& random = versions.random;
    std::array<std::optional<stream::Detail>, 2> read;
    for (int step = 0; step < 25; ++step) {
        const std::size_t which = random.bits() % 2;
        if (step < 2 || random.chance(0.4)) {
            read[which] = store.detail(boxes[which], random.bits());
            maker.show(viewers[which], *read[which]);
        }
        if (random.chance(0.7)) versions.add();
        const auto now = versions.all.back();
        maker.use_edits(*now);
        if (random.chance(0.5)) continue;  // the next one comes at once
        ASSERT_TRUE(comes_true([&] { return maker.idle(); }));
        const std::scoped_lock lock(shown.mutex);
        for (std::size_t i = 0; i < 2; ++i) {
            if (!read[i]) continue;
            const DetailField& made = *shown.last.at(viewers[i]);
            const Volume expected = expected_of(store, viewers[i], read[i]->volume, *now);
            ASSERT_TRUE(same_bytes(flat(made), expected)) << step << " " << i;
            EXPECT_EQ(made.field.background(), 7.0);
            EXPECT_EQ(made.field.interpolation(), Interpolation::cubic);
        }
    }
    EXPECT_EQ(shown.untold.load(), 0);
    EXPECT_GT(shown.made.load(), 15);
}

TEST(DetailMaker, makes_no_part_of_the_scene_that_is_not_wanted_any_more) {
    const Store store;
    std::atomic<int> made{0};
    DetailMaker maker(linear_field(store.overview), {store.geometry.size},
                      [&](int, const auto&) { ++made; }, {});
    maker.show(DetailMaker::scene, store.detail(store.patch.box, 1));
    ASSERT_TRUE(comes_true([&] { return maker.idle(); }));
    EXPECT_EQ(made, 0);
    maker.want_patch(store.patch);
    maker.show(DetailMaker::scene, store.detail(store.patch.box, 2));
    ASSERT_TRUE(comes_true([&] { return maker.idle(); }));
    EXPECT_EQ(made, 1);
    // Bricks that come are no edits.
    PartOf part(store.level);
    part.add_all();
    maker.use_edits(*part.samples());
    ASSERT_TRUE(comes_true([&] { return maker.idle(); }));
    EXPECT_EQ(made, 1);
}

}  // namespace
}  // namespace palpate::viewer
