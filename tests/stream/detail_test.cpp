// Boxes for pictures: coarse first, the store's samples in the end, bounded, behind the hands.
#include "palpate/stream/detail.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <map>
#include <set>
#include <thread>

#include "palpate/io/error.hpp"
#include "palpate/stream/loader.hpp"
#include "stream/store_support.hpp"
#include "stream/volumes_store.hpp"
#include "support/constants.hpp"
#include "support/edits.hpp"
#include "support/eventually.hpp"

namespace palpate::stream {
namespace {

using namespace palpate::support;

/// The results of a reader, for each viewer.
class Seen {
  public:
    DetailReader::Made made() {
        return [this](int viewer, Detail detail) {
            const std::scoped_lock lock(mutex_);
            all_[viewer].push_back(std::move(detail));
        };
    }
    std::vector<Detail> of(int viewer) const {
        const std::scoped_lock lock(mutex_);
        const auto found = all_.find(viewer);
        return found == all_.end() ? std::vector<Detail>{} : found->second;
    }
    bool complete(int viewer) const {
        const auto all = of(viewer);
        return !all.empty() && all.back().missing == 0;
    }

  private:
    mutable std::mutex mutex_;
    std::map<int, std::vector<Detail>> all_;
};

std::vector<std::byte> bytes_of(const Volume& volume) {
    const auto* const first = static_cast<const std::byte*>(volume.data());
    return {first, first + volume.bytes()};
}

/// Samples that grow linearly through space, the same in a level of any spacing.
Volume ramp(const Geometry& geometry) {
    std::vector<float> samples;
    for (int k = 0; k < geometry.size[2]; ++k) {
        for (int j = 0; j < geometry.size[1]; ++j) {
            for (int i = 0; i < geometry.size[0]; ++i) {
                const Vec3 at = physical_from_index(geometry, Vec3(i, j, k));
                samples.push_back(static_cast<float>(at[0] + 2 * at[1] - 3 * at[2]));
            }
        }
    }
    return {geometry, std::move(samples)};
}

/// Levels of 96, 48, 24 and 12 samples along each axis.
std::vector<Volume> ramps() {
    std::vector<Volume> levels;
    for (int size = 96, step = 1; size >= 12; size /= 2, step *= 2) {
        levels.push_back(
            ramp(grid(cube(size), Vec3::Constant(step), Vec3::Constant(0.5 * (step - 1)))));
    }
    return levels;
}

constexpr std::chrono::milliseconds often{1};

/// So many read at a time.
DetailSettings settings_of(int for_eyes) {
    DetailSettings settings;
    settings.threads = 2 * for_eyes;
    return settings;
}

TEST(DetailReader, a_complete_box_has_the_samples_of_the_store) {
    Random random(7);
    for (const SampleType type : sample_types) {
        for (const Index3& chunk : {Index3(70, 1, 1), Index3(32, 16, 7), Index3(500, 500, 500)}) {
            const Volume volume = noise_of(type, grid({70, 66, 50}, {1, 2, 3}, {4, 5, 6}), 3);
            const auto store = store_in_pieces(volume, chunk);
            Seen seen;
            DetailReader reader(store, overview_of(*store, 4000), settings_of(2), seen.made());
            for (int round = 0; round < 3; ++round) {
                std::mt19937 engine(static_cast<unsigned>(random.below(1000)));
                const SampleBox box = test::random_box(engine, volume.geometry().size);
                const int viewer = round;
                reader.want(viewer, {{0, box}});
                ASSERT_TRUE(comes_true([&] { return seen.complete(viewer); }));
                const Detail made = seen.of(viewer).back();
                EXPECT_EQ(made.of, (DetailBox{0, box}));
                EXPECT_EQ(bytes_of(made.volume), test::box_of(volume, box));
                const Vec3 first = physical_from_index(made.volume.geometry(), Vec3::Zero());
                EXPECT_EQ(first, physical_from_index(volume.geometry(), box.low.cast<double>()));
            }
        }
    }
}

TEST(DetailReader, what_is_missing_is_interpolated_from_the_coarse_box_then_from_the_overview) {
    auto levels = ramps();
    const auto store = std::make_shared<VolumesStore>(levels, cube(16));
    std::atomic<bool> coarse_fails{false}, fine_fails{true};
    store->before_read = [&](int level, const SampleBox&, const std::stop_token&) {
        if (level == 0 ? fine_fails : coarse_fails) throw io::InputError("the network is away");
    };
    const Volume overview = levels.back();
    for (const bool only_overview : {false, true}) {
        coarse_fails = only_overview;
        fine_fails = true;
        Seen seen;
        DetailReader reader(store, overview, settings_of(2), seen.made());
        const SampleBox box{{10, 20, 30}, {69, 75, 66}};
        reader.want(0, {{2, {{2, 4, 7}, {18, 19, 17}}}, {0, box}}, often);
        ASSERT_TRUE(comes_true([&] { return !seen.of(0).empty(); }));
        const Detail first = seen.of(0).front();
        EXPECT_EQ(first.missing, first.pieces);
        // A ramp is the same at every level, except that it stops at the last samples.
        const auto samples = first.volume.samples<float>();
        const Volume exact = ramp(first.volume.geometry());
        const auto expected = exact.samples<float>();
        for (std::size_t i = 0; i < samples.size(); ++i) {
            ASSERT_NEAR(samples[i], expected[i], 1e-3) << i << ' ' << only_overview;
        }
        EXPECT_TRUE(comes_true([&] { return !reader.status().problem.empty(); }));
        fine_fails = false;
        ASSERT_TRUE(comes_true([&] { return seen.complete(0); })) << "they are tried again";
        EXPECT_EQ(bytes_of(seen.of(0).back().volume), test::box_of(levels[0], box));
        EXPECT_EQ(reader.status().missing, 0U);
        EXPECT_TRUE(reader.status().problem.empty());
    }
}

TEST(DetailReader, a_problem_is_told_until_what_failed_is_there) {
    const auto store = std::make_shared<VolumesStore>(ramps(), cube(16));
    DetailReader reader(store, ramps().back(), settings_of(2), [](int, const Detail&) {});
    int tries = 0;
    std::string problem;  // while it is tried again
    store->before_read = [&](int, const SampleBox&, const std::stop_token&) {
        if (++tries == 1) throw io::InputError("the network is away");
        problem = reader.status().problem;
    };
    reader.want(0, {{0, {{1, 1, 1}, {9, 9, 9}}}}, often);
    EXPECT_TRUE(comes_true([&] { return reader.status().missing == 0; }));
    EXPECT_EQ(tries, 2);
    EXPECT_FALSE(problem.empty());
    EXPECT_TRUE(reader.status().problem.empty());
}

TEST(DetailReader, versions_say_which_samples_have_changed) {
    auto levels = ramps();
    levels[0] = noise_of(SampleType::float32, levels[0].geometry(), 5);
    const auto store = std::make_shared<VolumesStore>(levels, cube(16));
    Seen seen;
    std::size_t pieces = 0;
    store->before_read = [&](int level, const SampleBox&, const std::stop_token&) {
        // One version for each of the first pieces.
        if (level != 0 || ++pieces > 5) return;
        EXPECT_TRUE(comes_true([&] { return seen.of(0).size() >= pieces; }));
    };
    DetailReader reader(store, levels.back(), settings_of(1), seen.made());
    reader.want(0, {{1, {{5, 5, 5}, {40, 40, 40}}}, {0, {{11, 12, 13}, {80, 79, 78}}}}, often);
    ASSERT_TRUE(comes_true([&] { return seen.complete(0); }));
    const auto all = seen.of(0);
    ASSERT_GT(all.size(), 3U);
    std::size_t different = 0;
    for (std::size_t v = 1; v < all.size(); ++v) {
        const auto before = all[v - 1].volume.samples<float>(),
                   now = all[v].volume.samples<float>();
        const Index3& size = all[v].volume.geometry().size;
        for (std::size_t i = 0; i < now.size(); ++i) {
            if (now[i] == before[i]) continue;
            const auto n = static_cast<int>(i);
            const Index3 at(n % size[0], n / size[0] % size[1], n / (size[0] * size[1]));
            ++different;
            ASSERT_TRUE((at.array() >= all[v].changed.low.array()).all() &&
                        (at.array() <= all[v].changed.high.array()).all());
        }
    }
    EXPECT_GT(different, 1000U);
}

TEST(DetailReader, what_is_no_longer_wanted_is_not_read_and_what_is_kept_is_not_read_again) {
    const auto store = std::make_shared<VolumesStore>(ramps(), cube(16));
    std::mutex mutex;
    std::multiset<std::array<int, 3>> read;
    std::atomic<bool> hold{true};
    store->before_read = [&](int level, const SampleBox& box, const std::stop_token&) {
        while (hold) std::this_thread::sleep_for(std::chrono::milliseconds(1));
        const std::scoped_lock lock(mutex);
        if (level == 0) read.insert({box.low[0], box.low[1], box.low[2]});
    };
    Seen seen;
    DetailReader reader(store, ramps().back(), settings_of(2), seen.made());
    const DetailBox first{0, {{0, 0, 0}, {31, 31, 31}}}, second{0, {{48, 48, 48}, {95, 79, 79}}};
    reader.want(0, {first});
    ASSERT_TRUE(comes_true([&] { return reader.status().coming == 2; }));
    reader.want(0, {second});
    hold = false;
    ASSERT_TRUE(comes_true([&] { return seen.complete(0); }));
    EXPECT_EQ(seen.of(0).back().of, second);
    const auto count = [&] {
        const std::scoped_lock lock(mutex);
        return read.size();
    };
    EXPECT_TRUE(comes_true([&] { return count() == 2 + 12U; })) << "two were under way";
    // The same again, and a part of it for another viewer: all of it is kept.
    reader.want(0, {first});
    ASSERT_TRUE(comes_true([&] { return seen.of(0).back().of == first && seen.complete(0); }));
    reader.want(1, {{1, {{0, 0, 0}, {15, 15, 15}}}, {0, {{4, 4, 4}, {27, 27, 27}}}},
                std::chrono::hours(1));
    ASSERT_TRUE(comes_true([&] { return seen.complete(1); }));
    EXPECT_EQ(count(), 8 + 12U);
    EXPECT_EQ(seen.of(1).size(), 1U) << "nothing coarse where all is kept";
}

TEST(DetailReader,
     the_thread_that_puts_pictures_together_reads_nothing_of_what_is_dropped_meanwhile) {
    // Large pieces, so that one is often dropped between being found and being copied.
    const Volume volume = noise_of(SampleType::float32, grid({256, 64, 128}), 9);
    const auto store = store_in_pieces(volume, cube(64));
    std::atomic<std::thread::id> composer{};
    std::atomic<int> read_there{0};
    store->before_read = [&](int, const SampleBox&, const std::stop_token&) {
        read_there += std::this_thread::get_id() == composer.load();
    };
    Seen seen;
    DetailSettings settings = settings_of(2);
    settings.memory = 4 * bytes_of(noise_of(SampleType::float32, grid(cube(64)), 1)).size();
    settings.begin_thread = [&] { composer = std::this_thread::get_id(); };
    DetailReader reader(store, overview_of(*store, 4000), settings, seen.made());
    const auto count = [&](int viewer) { return seen.of(viewer).size(); };
    for (int round = 0; round < 60; ++round) {
        const std::size_t before = count(0), others = count(1);
        const int x = 64 * (round % 4);
        reader.want(1, {{0, whole_box(volume.geometry())}}, std::chrono::hours(1));
        reader.want(0, {{0, {{x, 0, 0}, {x + 63, 63, 127}}}}, std::chrono::hours(1));
        ASSERT_TRUE(comes_true([&] { return count(0) > before && count(1) > others; }));
    }
    EXPECT_EQ(read_there, 0);
}

TEST(DetailReader, refuses_boxes_that_are_not_in_the_store) {
    const auto store = std::make_shared<VolumesStore>(ramps(), cube(16));
    DetailReader reader(store, ramps().back(), settings_of(1), [](int, const Detail&) {});
    const SampleBox good{{0, 0, 0}, {5, 5, 5}};
    EXPECT_THROW(reader.want(0, {}), std::invalid_argument);
    EXPECT_THROW(reader.want(0, {{4, good}}), std::invalid_argument);
    EXPECT_THROW(reader.want(0, {{-1, good}}), std::invalid_argument);
    EXPECT_THROW(reader.want(0, {{0, {{0, 0, 0}, {96, 5, 5}}}}), std::invalid_argument);
    EXPECT_THROW(reader.want(0, {{0, {{3, 0, 0}, {2, 5, 5}}}}), std::invalid_argument);
    EXPECT_EQ(reader.status().wanted, 0U);
}

TEST(DetailReader, ends_at_once_while_reads_wait) {
    const auto store = std::make_shared<VolumesStore>(ramps(), cube(16));
    store->before_read = [](int, const SampleBox&, const std::stop_token& stop) {
        while (!stop.stop_requested()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
        throw Cancelled{};
    };
    Seen seen;
    {
        DetailReader reader(store, ramps().back(), settings_of(4), seen.made());
        reader.want(0, {{0, {{0, 0, 0}, {63, 63, 63}}}});
        ASSERT_TRUE(comes_true([&] { return reader.status().coming == 4; }));
    }
    EXPECT_TRUE(seen.of(0).empty());
}

/// A store that notes how often each of its pieces is read.
class CountedStore {
  public:
    explicit CountedStore(Volume volume) : store_(store_in_pieces(std::move(volume))) {
        store_->before_read = [this](int, const SampleBox& box, const std::stop_token&) {
            const std::scoped_lock lock(mutex_);
            ++reads_[{box.low[0], box.low[1], box.low[2]}];
        };
    }
    std::shared_ptr<const Store> store() const { return store_; }
    void forget() {
        const std::scoped_lock lock(mutex_);
        reads_.clear();
    }
    int most() const {
        const std::scoped_lock lock(mutex_);
        int most = 0;
        for (const auto& [piece, reads] : reads_) most = std::max(most, reads);
        return most;
    }
    std::size_t pieces() const {
        const std::scoped_lock lock(mutex_);
        return reads_.size();
    }

  private:
    std::shared_ptr<VolumesStore> store_;
    mutable std::mutex mutex_;
    std::map<std::array<int, 3>, int> reads_;
};

constexpr std::uint64_t hand_memory = std::uint64_t{1} << 26;

TEST(SharedLoader, hands_and_eyes_together_read_each_piece_once) {
    const Volume volume = noise_of(SampleType::uint8, grid({200, 150, 130}), 5);
    for (int round = 0; round < 4; ++round) {
        CountedStore counted(volume);
        const Volume overview = overview_of(*counted.store(), 1000);
        counted.forget();
        const auto shared = shared_loader(6);
        BrickLoader loader(counted.store(), overview, {.memory = hand_memory, .shared = shared});
        Seen seen;
        DetailSettings settings;
        settings.shared = shared;
        DetailReader reader(counted.store(), overview, settings, seen.made());
        reader.want(0, {{0, whole_box(volume.geometry())}});
        const Interest hand{Vec3(100, 75, 65), Vec3(100, 75, 65)};
        loader.look({&hand, 1});
        loader.wait_for(hand.hand, 20);
        ASSERT_TRUE(comes_true([&] { return seen.complete(0); }));
        EXPECT_EQ(bytes_of(seen.of(0).back().volume), bytes_of(volume));
        EXPECT_EQ(counted.pieces(), 7U * 5 * 5);
        EXPECT_EQ(counted.most(), 1);
        std::vector<std::byte> felt(20 * 20 * 20);
        const SampleBox box{{90, 65, 55}, {109, 84, 74}};
        loader.read(box, felt);
        EXPECT_EQ(felt, test::box_of(volume, box));
    }
}

TEST(SharedLoader, eyes_do_not_drop_what_the_hand_uses_and_go_without_taking_it) {
    const Volume volume = noise_of(SampleType::uint8, grid({200, 150, 130}), 6);
    CountedStore counted(volume);
    const Volume overview = overview_of(*counted.store(), 1000);
    const auto shared = shared_loader(2);
    BrickLoader loader(counted.store(), overview, {.memory = hand_memory, .shared = shared});
    const SampleBox felt{{0, 0, 0}, {63, 63, 63}};
    const std::uint64_t hand_bytes = 64 * 64 * 64;
    std::vector<std::byte> samples(hand_bytes);
    {
        Seen seen;
        DetailSettings settings;
        settings.memory = 3 * hand_bytes / 2;
        settings.shared = shared;
        DetailReader reader(counted.store(), overview, settings, seen.made());
        reader.want(0, {{0, felt}});
        ASSERT_TRUE(comes_true([&] { return seen.complete(0); }));
        counted.forget();
        loader.read(felt, samples);  // takes over what the eyes have read
        EXPECT_EQ(counted.pieces(), 0U);
        EXPECT_EQ(loader.status().bytes, hand_bytes);
        EXPECT_EQ(reader.status().bytes, 0U);
        reader.want(1, {{0, whole_box(volume.geometry())}});
        ASSERT_TRUE(comes_true([&] { return seen.complete(1); }));
        EXPECT_LE(reader.status().bytes, settings.memory);
    }
    counted.forget();
    loader.read(felt, samples);
    EXPECT_EQ(counted.pieces(), 0U);
    EXPECT_EQ(samples, test::box_of(volume, felt));
}

TEST(SharedLoader, a_read_of_the_eyes_that_is_cancelled_is_begun_anew_for_the_hand) {
    const Volume volume = noise_of(SampleType::uint8, grid(cube(40)), 7);
    const auto store = store_in_pieces(volume);
    std::atomic<bool> eyes_read{false}, hangs{true};
    store->before_read = [&](int, const SampleBox&, const std::stop_token& stop) {
        eyes_read = true;
        while (hangs && !stop.stop_requested()) std::this_thread::yield();
        if (stop.stop_requested()) throw Cancelled{};
    };
    const Volume overview = noise_of(SampleType::uint8, grid(cube(8)), 1);
    const auto shared = shared_loader(3);
    BrickLoader loader(store, overview, {.memory = hand_memory, .shared = shared});
    Seen seen;
    DetailSettings settings;
    settings.shared = shared;
    auto reader = std::make_unique<DetailReader>(store, overview, settings, seen.made());
    reader->want(0, {{0, {{0, 0, 0}, {9, 9, 9}}}});
    ASSERT_TRUE(comes_true([&] { return eyes_read.load(); }));
    std::vector<std::byte> samples(10 * 10 * 10);
    std::jthread hand([&] { loader.read({{0, 0, 0}, {9, 9, 9}}, samples); });
    reader.reset();
    hangs = false;
    hand.join();
    EXPECT_EQ(samples, test::box_of(volume, {{0, 0, 0}, {9, 9, 9}}));
}

TEST(SharedLoader, a_fork_reads_with_threads_of_its_own) {
    const auto store = store_in_pieces(noise_of(SampleType::uint8, grid(cube(40)), 8));
    const Volume overview = noise_of(SampleType::uint8, grid(cube(8)), 1);
    const BrickLoaderSettings settings{.memory = hand_memory, .shared = shared_loader(3)};
    const Vec3 hand(20, 20, 20);
    BrickLoader loader(store, overview, settings);
    loader.wait_for(hand, 5);
    const pid_t fork = ::fork();
    if (fork == 0) {
        ::alarm(60);  // in place of waiting for ever
        BrickLoader own(store, overview, settings);
        own.wait_for(hand, 5);
        ::_exit(own.status().bytes > 0 ? 0 : 1);
    }
    int status = -1;
    ASSERT_EQ(::waitpid(fork, &status, 0), fork);
    EXPECT_EQ(status, 0);
}

/// A hand that feels all of level 0, 27 pieces, and eyes that see level 1.
struct HandAndEyes {
    explicit HandAndEyes(int threads) : shared(shared_loader(threads)) {
        settings.shared = shared;
        store->before_read = [this](int level, const SampleBox&, const std::stop_token& stop) {
            order.push(level);
            ++reads[static_cast<std::size_t>(level)];
            while (hold[static_cast<std::size_t>(level)] && !stop.stop_requested()) {
                std::this_thread::sleep_for(std::chrono::milliseconds(1));
            }
            if (stop.stop_requested()) throw Cancelled{};
        };
    }
    /// Levels as they were read.
    class Order {
      public:
        void push(int level) {
            const std::scoped_lock lock(mutex_);
            levels_.push_back(level);
        }
        std::vector<int> get() const {
            const std::scoped_lock lock(mutex_);
            return levels_;
        }

      private:
        mutable std::mutex mutex_;
        std::vector<int> levels_;
    };

    const std::shared_ptr<VolumesStore> store = std::make_shared<VolumesStore>(ramps(), cube(32));
    const std::shared_ptr<Loader> shared;
    std::array<std::atomic<bool>, 4> hold{};
    std::array<std::atomic<int>, 4> reads{};
    Order order;
    DetailSettings settings;
    const Interest hand{Vec3::Constant(48), Vec3::Constant(48)};
    static constexpr std::uint64_t memory = std::uint64_t{1} << 28;
};

TEST(SharedLoader, what_the_hand_needs_at_once_comes_before_what_the_eyes_asked_for_earlier) {
    HandAndEyes both(1);
    both.hold[1] = true;
    Seen seen;
    const Volume overview = ramps().back();
    BrickLoader loader(both.store, overview, {.memory = both.memory, .shared = both.shared});
    DetailReader reader(both.store, overview, both.settings, seen.made());
    reader.want(0, {{1, whole_box(both.store->info().levels[1].geometry)}});
    ASSERT_TRUE(comes_true([&] { return both.reads[1] == 1; }));
    loader.look({&both.hand, 1});
    both.hold[1] = false;
    ASSERT_TRUE(comes_true([&] { return seen.complete(0); }));
    std::vector<int> expected(27, 0);
    expected.insert(expected.begin(), 1);
    expected.insert(expected.end(), 7, 1);
    EXPECT_EQ(both.order.get(), expected);
}

TEST(SharedLoader, eyes_have_one_thread_while_the_hand_lacks_something_and_six_then) {
    HandAndEyes both(40);
    both.hold[0] = both.hold[1] = true;
    Seen seen;
    const Volume overview = ramps().back();
    BrickLoader loader(both.store, overview, {.memory = both.memory, .shared = both.shared});
    loader.look({&both.hand, 1});
    ASSERT_TRUE(comes_true([&] { return both.reads[0] == 27; }));
    DetailReader reader(both.store, overview, both.settings, seen.made());
    reader.want(0, {{1, whole_box(both.store->info().levels[1].geometry)}});
    ASSERT_TRUE(comes_true([&] { return both.reads[1] == 1; }));
    for (int i = 0; i < 100; ++i) {
        loader.look({&both.hand, 1});
        ASSERT_EQ(both.reads[1], 1);
    }
    both.hold[0] = false;
    ASSERT_TRUE(comes_true([&] { return reader.status().coming == 6; }));
    both.hold[1] = false;
    ASSERT_TRUE(comes_true([&] { return seen.complete(0); }));
    EXPECT_EQ(both.reads[1], 8);
}

}  // namespace
}  // namespace palpate::stream
