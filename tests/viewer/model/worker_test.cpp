// Tasks on threads: any, and those that make details with edits.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cstring>
#include <map>
#include <mutex>
#include <stdexcept>
#include <string>

#include "apps/viewer/model/detail_maker.hpp"
#include "apps/viewer/model/opening.hpp"
#include "apps/viewer/model/worker.hpp"
#include "palpate/edit.hpp"
#include "stream/box_bytes.hpp"
#include "support/edits.hpp"
#include "support/eventually.hpp"
#include "support/fields.hpp"
#include "support/resident.hpp"
#include "support/silent_server.hpp"

namespace palpate::viewer {
namespace {

using namespace std::chrono_literals;

void wait_for(const Worker& worker) {
    ASSERT_TRUE(support::comes_true([&] { return worker.ended(); }));
}

TEST(Worker, result_is_there_once_it_has_ended) {
    int result = 0;
    Worker worker([&](const io::Progress&) { result = 7; }, [] {});
    wait_for(worker);
    EXPECT_TRUE(worker.finish());
    EXPECT_EQ(result, 7);
}

TEST(Worker, what_the_task_throws_comes_out_of_finish) {
    Worker worker([](const io::Progress&) { throw std::runtime_error("no such file"); }, [] {});
    wait_for(worker);
    EXPECT_THROW((void)worker.finish(), std::runtime_error);
}

TEST(Worker, a_cancelled_task_stops_at_its_next_progress_and_is_not_done) {
    std::atomic<bool> begun{false};
    Worker worker(
        [&](const io::Progress& progress) {
            for (;;) {
                begun = true;
                progress(0.5);
                std::this_thread::sleep_for(1ms);
            }
        },
        [] {});
    ASSERT_TRUE(support::comes_true([&] { return begun.load(); }));
    worker.cancel();
    wait_for(worker);
    EXPECT_FALSE(worker.finish());
}

TEST(Worker, owner_is_woken_for_each_percent_at_most_and_at_the_end) {
    std::atomic<int> woken{0};
    Worker worker(
        [](const io::Progress& progress) {
            for (int i = 0; i <= 100'000; ++i) progress(i / 100'000.0);
        },
        [&] { ++woken; });
    wait_for(worker);
    EXPECT_EQ(worker.progress(), 1);
    // The last wake comes after ended() is seen.
    EXPECT_TRUE(support::comes_true([&] { return woken >= 50; }));
    EXPECT_LE(woken, 105);
}

TEST(Worker, destroying_it_cancels_the_task) {
    std::atomic<int> turns{0};
    std::atomic<bool> left{false};
    struct Leaves {
        std::atomic<bool>& left;
        ~Leaves() { left = true; }
    };
    {
        const Worker worker(
            [&](const io::Progress& progress) {
                const Leaves leaves{left};
                for (;; ++turns) {
                    progress(0);
                    std::this_thread::sleep_for(1ms);
                }
            },
            [] {});
        ASSERT_TRUE(support::comes_true([&] { return turns >= 3; }));
        EXPECT_FALSE(left);
    }
    EXPECT_TRUE(left);
}

TEST(NewestWorker, waits_for_no_earlier_task_that_notices_late_that_it_was_cancelled) {
    std::atomic<bool> hangs{true}, begun{false};
    std::atomic<int> ended{0};
    {
        NewestWorker worker;
        const auto hang = [&](const io::Progress&) {
            begun = true;
            while (hangs) std::this_thread::sleep_for(1ms);
            ++ended;
        };
        worker.start(hang, [] {});
        ASSERT_TRUE(support::comes_true([&] { return begun.load(); }));
        worker.start([](const io::Progress&) {}, [] {});
        EXPECT_TRUE(support::comes_true([&] { return worker.ended(); }));
        worker.start(hang, [] {});
        worker.cancel();
        EXPECT_FALSE(worker.ended());
        EXPECT_EQ(ended, 0);
        hangs = false;
    }
    EXPECT_GE(ended, 1) << "the first; the second may have been cancelled before it began";
}

TEST(Worker, one_that_opens_a_volume_of_a_silent_server_ends_when_it_is_cancelled) {
    const support::SilentServer server;
    const run::Source source = run::source_from({{"volume", server.address()}});
    Worker worker([&](const io::Progress& progress) { (void)open(source, progress); }, [] {});
    ASSERT_TRUE(support::comes_true([&] { return server.is_asked(); }));
    const auto begin = std::chrono::steady_clock::now();
    worker.cancel();
    wait_for(worker);
    EXPECT_LT(std::chrono::steady_clock::now() - begin, 10s) << "of 50; usually 0.03";
    EXPECT_FALSE(worker.finish());
}

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

/// What a maker has made last for each viewer; counts samples that changed without being told.
struct Shown {
    std::mutex mutex;
    std::map<int, std::shared_ptr<const DetailField>> last;
    std::atomic<int> made = 0, untold = 0;

    void take(int viewer, const std::shared_ptr<const DetailField>& now) {
        const std::scoped_lock lock(mutex);
        auto& before = last[viewer];
        if (before && before->box == now->box) count_untold(*before, *now);
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
