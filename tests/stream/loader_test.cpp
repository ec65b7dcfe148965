// The loader: bricks are the store's samples, memory is bounded, failures are told and tried again.
#include "palpate/stream/loader.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cstring>
#include <functional>
#include <latch>
#include <utility>

#include "palpate/field.hpp"
#include "palpate/io/error.hpp"
#include "stream/box_bytes.hpp"
#include "stream/volumes_store.hpp"
#include "support/constants.hpp"
#include "support/edits.hpp"
#include "support/eventually.hpp"
#include "support/random.hpp"
#include "support/resident.hpp"

namespace palpate::stream {
namespace {

using namespace palpate::support;

constexpr std::uint64_t least_memory = 64 * ResidentBricks::per_brick * 4 / 3 + 1000;

/// Noise for a large grid, of which a sanitizer would take half a minute to make: a block, over and
/// over. Its length is prime, so that bricks differ.
Volume large_noise(const Index3& size, std::uint64_t seed) {
    constexpr std::size_t period = 1'000'003;
    const Volume noise = noise_of(SampleType::uint8, grid({period, 1, 1}), seed);
    const auto* const from = static_cast<const std::uint8_t*>(noise.data());
    const Geometry geometry = grid(size);
    std::vector<std::uint8_t> samples(static_cast<std::size_t>(sample_count(geometry)));
    for (std::size_t at = 0; at < samples.size(); at += period) {
        std::memcpy(samples.data() + at, from, std::min(period, samples.size() - at));
    }
    return {geometry, std::move(samples)};
}

TEST(BrickLoader, bricks_hold_the_samples_of_the_store) {
    for (const SampleType type : sample_types) {
        for (const Index3& chunk : {Index3(130, 1, 1), Index3(32, 48, 7), Index3(500, 500, 500)}) {
            const Volume volume = noise_of(type, grid({130, 66, 70}), 3);
            const auto store = store_in_pieces(volume, chunk);
            BrickLoader loader(store, overview_of(*store),
                               {.memory = least_memory * size_of(type), .threads = 1});
            for (const Index3& at : {Index3(0, 0, 0), Index3(1, 0, 1), Index3(2, 1, 1)}) {
                const Brick brick = loader.read(at, 0);
                const Brick expected = brick_of(volume, at, 0);
                ASSERT_EQ(std::memcmp(brick.samples.get(), expected.samples.get(),
                                      ResidentBricks::per_brick * size_of(type)),
                          0);
            }
        }
    }
}

TEST(BrickLoader, a_coarser_level_is_interpolated_where_it_lies_in_space) {
    // A ramp on both levels, whose samples lie between each other.
    const auto ramp = [](Geometry geometry) {
        std::vector<float> samples;
        for_each_sample(geometry, [&](const Index3& at) {
            const Vec3 p = physical_from_index(geometry, at.cast<double>());
            samples.push_back(float(3 * p[0] - 2 * p[1] + p[2]));
        });
        return Volume(geometry, std::move(samples));
    };
    const Geometry fine = grid({128, 64, 64}, {1, 1, 2}, {5, 5, 5});
    Geometry coarse = fine;
    coarse.size = {64, 32, 32};
    coarse.spacing *= 2;
    coarse.origin += 0.5 * fine.spacing;
    const auto store =
        std::make_shared<VolumesStore>(std::vector{ramp(fine), ramp(coarse)}, Index3(16, 16, 16));
    BrickLoader loader(store, overview_of(*store), {.memory = 4 * least_memory, .threads = 1});
    const Brick exact = loader.read({0, 0, 0}, 0), between = loader.read({0, 0, 0}, 1);
    EXPECT_EQ(exact.level, 0);
    EXPECT_EQ(between.level, 1);
    const auto* a = reinterpret_cast<const float*>(exact.samples.get());
    const auto* b = reinterpret_cast<const float*>(between.samples.get());
    // Inside the coarse grid; beyond its last sample it is continued.
    for (int k = 1; k < 63; ++k) {
        for (int j = 1; j < 63; ++j) {
            for (int i = 1; i < 64; ++i) {
                const auto at = ResidentBricks::place_of({i, j, k});
                ASSERT_NEAR(a[at], b[at], 1e-3) << i << " " << j << " " << k;
            }
        }
    }
}

TEST(BrickLoader, a_hand_that_is_too_fast_gets_coarser_bricks_and_finer_ones_when_it_rests) {
    const Geometry fine = grid({512, 128, 128});
    std::vector<Volume> levels;
    for (int level = 0; level < 4; ++level) {
        Geometry geometry = fine;
        geometry.size = fine.size / (1 << level);
        geometry.spacing *= 1 << level;
        levels.push_back(noise_of(SampleType::uint8, geometry, 5));
    }
    const auto store = std::make_shared<VolumesStore>(levels, Index3(16, 16, 16));
    store->before_read = [&](int, const SampleBox&, const std::stop_token&) {
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
    };
    BrickLoader loader(store, overview_of(*store, 1000),
                       {.memory = 4 * least_memory, .threads = 4, .coarse_first = true});
    Interest hand{Vec3(30, 60, 60), Vec3(30, 60, 60), Vec3::Zero()};
    std::shared_ptr<const Samples> newest;
    std::chrono::steady_clock::time_point now{};
    const auto level_at = [&](const Vec3& at) {
        loader.look({&hand, 1}, now += std::chrono::milliseconds(1));
        if (auto version = loader.take()) newest = std::move(version->samples);
        const Brick* brick = newest ? newest->resident()->of_sample(at.cast<int>()) : nullptr;
        return brick ? int(brick->level) : -1;
    };
    EXPECT_TRUE(comes_true([&] { return level_at(hand.hand) == 0; }));
    EXPECT_TRUE(comes_true([&] { return loader.status().missing == 0; }));
    // So fast that no brick of the finest level would come before it is gone, whatever the machine.
    hand.velocity = Vec3(1e6, 0, 0);
    for (int n = 0; n < 50; ++n) {  // what a hand does for a moment is smoothed
        loader.look({&hand, 1}, now += std::chrono::milliseconds(10));
    }
    hand.proxy = hand.hand = Vec3(450, 60, 60);
    loader.look({&hand, 1}, now);
    EXPECT_TRUE(comes_true([&] { return loader.status().missing == 0; }));
    EXPECT_GT(level_at(hand.hand), 0);
    hand.velocity = Vec3::Zero();
    EXPECT_TRUE(comes_true([&] { return level_at(hand.hand) == 0; }));
}

TEST(BrickLoader, memory_is_bounded_and_what_the_hand_needs_arrives_wherever_it_goes) {
    const Volume volume = large_noise({640, 320, 320}, 4);
    const auto store = store_in_pieces(volume, {64, 64, 64});
    BrickLoader loader(store, overview_of(*store, 1000), {.memory = least_memory, .threads = 2});
    Random random(6);
    Field field = linear_field(loader.empty());
    for (int n = 0; n < (is_slow_build ? 8 : 20); ++n) {
        const Vec3 at(random.uniform(0, 639), random.uniform(0, 319), random.uniform(0, 319));
        const Interest hand{at, at + 20 * random.direction(), 50 * random.direction()};
        loader.look({&hand, 1});
        const auto arrived = [&] {
            EXPECT_LE(loader.status().bytes, least_memory);
            if (const auto version = loader.take()) field.use(version->samples);
            return is_resident(field, at, 7) && loader.status().missing == 0;
        };
        ASSERT_TRUE(comes_true(arrived)) << n;
        const Index3 index = at.cast<int>();
        EXPECT_EQ(field.samples().sample(index), volume.sample(index));
    }
    const BrickLoaderStatus status = loader.status();
    EXPECT_LE(status.most_bytes, least_memory);
    EXPECT_GT(status.dropped, 0U);
    EXPECT_EQ(status.resident, field.samples().resident()->size());
    EXPECT_EQ(status.problem, "");
}

TEST(BrickLoader, a_hand_that_goes_through_a_store_reads_a_piece_for_each_brick) {
    const Volume volume = large_noise({1280, 192, 192}, 4);
    const auto store = store_in_pieces(volume, {64, 64, 64});
    // Room for 64 bricks.
    BrickLoader loader(store, overview_of(*store, 1000), {.memory = least_memory, .threads = 1});
    const std::uint64_t before = loader.status().traffic.requests;
    for (int x = 32; x < 1280; x += 16) {
        const Interest hand{Vec3(x, 96, 96), Vec3(x, 96, 96)};
        loader.look({&hand, 1});
        ASSERT_TRUE(comes_true([&] { return loader.status().missing == 0; }));
        const auto version = loader.take();
        if (!version) continue;
        const ResidentBricks& bricks = *version->samples->resident();
        for (const BrickEvent& event : version->events) {
            if (event.level < 0) continue;
            const Brick* const brick = bricks.at(event.brick);
            ASSERT_NE(brick, nullptr);
            ASSERT_EQ(
                std::memcmp(brick->samples.get(), brick_of(volume, event.brick, 0).samples.get(),
                            ResidentBricks::per_brick),
                0)
                << event.brick.transpose();
        }
    }
    const BrickLoaderStatus status = loader.status();
    EXPECT_GE(status.loaded, 20U * 9U);
    EXPECT_LE(status.traffic.requests - before, status.loaded);
}

TEST(BrickLoader, a_lone_brick_reads_only_the_pieces_that_its_own_samples_lie_in) {
    const Volume volume = large_noise(cube(192), 4);
    for (const auto& [edge, pieces] : {std::pair(32, 8U), {64, 1U}, {96, 8U}, {192, 1U}}) {
        const auto store = store_in_pieces(volume, cube(edge));
        BrickLoader loader(store, overview_of(*store, 1000), {.memory = 4 * least_memory});
        const std::uint64_t before = loader.status().traffic.requests;
        loader.wait_for({96, 96, 96}, 5);
        EXPECT_EQ(loader.status().resident, 1U);
        EXPECT_EQ(loader.status().traffic.requests - before, pieces) << edge;
    }
}

TEST(BrickLoader, an_edit_across_bricks_reads_what_is_in_memory_from_there) {
    const Volume volume = large_noise(cube(192), 4);
    const auto store = store_in_pieces(volume, {192, 1, 1});  // rows, of which no piece is kept
    BrickLoader loader(store, overview_of(*store, 1000), {.memory = least_memory});
    loader.wait_for({64, 64, 64}, 5);
    const std::uint64_t before = loader.status().traffic.requests;
    const SampleBox box{{60, 50, 58}, {70, 66, 74}};
    std::vector<std::byte> samples(palpate::stream::bytes_of(box, SampleType::uint8));
    loader.read(box, samples);
    EXPECT_EQ(loader.status().traffic.requests, before);
    std::size_t at = 0;
    for_each_index(box, [&](const Index3& place) {
        ASSERT_EQ(std::to_integer<int>(samples[at++]), volume.sample(place)) << place.transpose();
    });
}

TEST(BrickLoader, where_memory_is_that_of_the_process_bricks_take_what_the_rest_leaves) {
    const Geometry geometry = grid(cube(400));
    const Volume volume(geometry, std::vector<std::uint8_t>(std::size_t{400} * 400 * 400, 1));
    // More than the process has, so that there is room for the fewest bricks only, and for 104.
    for (const bool whole : {true, false}) {
        BrickLoaderSettings settings;
        settings.memory = std::uint64_t{40} << 20;
        settings.whole_process = whole;
        BrickLoader loader(store_in_pieces(volume), noise_of(SampleType::uint8, grid(cube(8)), 1),
                           settings);
        std::size_t most = 0;
        for (const double at : {100.0, 150.0, 200.0, 250.0, 300.0}) {
            const Interest hand{Vec3::Constant(at), Vec3::Constant(at), Vec3::Zero()};
            loader.look({&hand, 1});
            EXPECT_TRUE(comes_true([&] {
                loader.look({&hand, 1});
                most = std::max(most, loader.status().resident);
                return loader.status().missing == 0;
            }));
        }
        EXPECT_GT(loader.status().loaded, 104U);
        if (whole) {
            EXPECT_LE(most, 65U);
        } else {
            EXPECT_GT(most, 85U);
        }
    }
}

TEST(BrickLoader, events_lead_from_version_to_version) {
    const Volume volume = large_noise({640, 200, 200}, 5);
    const auto store = store_in_pieces(volume);
    BrickLoader loader(store, overview_of(*store, 1000), {.memory = least_memory, .threads = 2});
    std::map<std::array<int, 3>, int> present;
    for (int x = 0; x < 640; x += 60) {
        const Interest hand{Vec3(x, 100, 100), Vec3(x, 100, 100)};
        loader.look({&hand, 1});
        ASSERT_TRUE(comes_true([&] { return loader.status().missing == 0; }));
        const auto version = loader.take();
        if (!version) continue;
        for (const BrickEvent& event : version->events) {
            const std::array<int, 3> at{event.brick[0], event.brick[1], event.brick[2]};
            if (event.level < 0) {
                EXPECT_EQ(present.erase(at), 1U);
            } else {
                present[at] = event.level;
            }
        }
        EXPECT_EQ(present.size(), version->samples->resident()->size());
        for (const auto& [at, level] : present) {
            EXPECT_TRUE(version->samples->resident()->at({at[0], at[1], at[2]}));
        }
    }
}

TEST(BrickLoader, a_brick_that_cannot_be_had_is_told_and_tried_again) {
    const auto store = store_in_pieces(noise_of(SampleType::uint8, grid({100, 100, 100}), 7));
    std::atomic<bool> broken{true};
    store->before_read = [&](int, const SampleBox&, const std::stop_token&) {
        if (broken) throw io::InputError("volumes: gone; plug it in again");
    };
    broken = false;
    Volume overview = overview_of(*store);
    broken = true;
    BrickLoader loader(store, std::move(overview), {.memory = least_memory, .threads = 2});
    EXPECT_THROW(loader.wait_for({50, 50, 50}, 10), io::InputError);
    EXPECT_EQ(loader.status().problem, "volumes: gone; plug it in again");
    broken = false;
    loader.wait_for({50, 50, 50}, 10);
    EXPECT_EQ(loader.status().problem, "");
    EXPECT_GT(loader.take()->samples->resident()->size(), 0U);
}

TEST(BrickLoader, who_waits_is_not_told_of_a_read_that_began_and_failed_before) {
    const auto store =
        store_in_pieces(noise_of(SampleType::uint8, grid({64, 64, 64}), 7), {64, 64, 64});
    Volume overview = overview_of(*store);
    std::atomic<int> begun{0};
    std::latch end(1);
    store->before_read = [&](int, const SampleBox&, const std::stop_token&) {
        if (begun++ > 0) return;
        end.wait();
        throw io::InputError("volumes: gone; plug it in again");
    };
    BrickLoader loader(store, std::move(overview), {.memory = least_memory, .threads = 4});
    const Interest hand{Vec3(30, 30, 30), Vec3(30, 30, 30)};
    loader.look({&hand, 1});
    ASSERT_TRUE(comes_true([&] { return begun > 0; }));
    // All threads make a brick of the one piece now: one reads it, the others wait for it.
    loader.look({});
    ASSERT_EQ(loader.status().wanted, 0U);
    std::jthread waits([&] { EXPECT_NO_THROW(loader.wait_for({30, 30, 30}, 10)); });
    // Once it waits, what it needs is wanted.
    EXPECT_TRUE(comes_true([&] { return loader.status().wanted > 0; }));
    end.count_down();
}

TEST(BrickLoader, who_waits_gets_the_bricks_although_hands_look_elsewhere_and_others_wait) {
    const auto store =
        store_in_pieces(noise_of(SampleType::uint8, grid({400, 64, 64}), 7), {32, 64, 64});
    Volume overview = overview_of(*store);
    std::atomic<bool> may_read{false};
    store->before_read = [&](int, const SampleBox&, const std::stop_token& stop) {
        while (!may_read && !stop.stop_requested()) std::this_thread::yield();
    };
    BrickLoader loader(store, std::move(overview), {.memory = least_memory, .threads = 1});
    std::jthread one([&] { loader.wait_for({30, 30, 30}, 5); });
    ASSERT_TRUE(comes_true([&] { return loader.status().wanted > 0; }));
    const std::size_t wanted = loader.status().wanted;
    std::jthread other([&] { loader.wait_for({300, 30, 30}, 5); });
    ASSERT_TRUE(comes_true([&] { return loader.status().wanted > wanted; }));
    const Interest hand{Vec3(150, 30, 30), Vec3(150, 30, 30)};
    loader.look({&hand, 1});
    may_read = true;
    one.join();
    other.join();
    const Field field = linear_field(loader.take()->samples);
    EXPECT_TRUE(is_resident(field, {30, 30, 30}, 5));
    EXPECT_TRUE(is_resident(field, {300, 30, 30}, 5));
}

TEST(BrickLoader, who_waits_for_a_brick_that_cannot_be_had_is_told_although_others_begin_to_wait) {
    const auto store =
        store_in_pieces(noise_of(SampleType::uint8, grid({400, 64, 64}), 7), {32, 64, 64});
    Volume overview = overview_of(*store);
    std::atomic<bool> waits{false}, fails{false}, other_waits{false};
    store->before_read = [&](int, const SampleBox& box, const std::stop_token&) {
        if (waits && box.low[0] > 200) other_waits = true;
        if (!waits || box.low[0] > 0) return;
        fails = true;
        while (!other_waits) std::this_thread::yield();
        throw io::InputError("volumes: gone; plug it in again");
    };
    // More threads than bricks of the piece that fails, as those that read them wait for it.
    BrickLoader loader(store, std::move(overview), {.memory = least_memory, .threads = 8});
    waits = true;
    std::jthread other([&] {
        while (!fails) std::this_thread::yield();
        loader.wait_for({300, 10, 10}, 5);
    });
    EXPECT_THROW(loader.wait_for({5, 10, 10}, 3), io::InputError);
}

TEST(BrickLoader, waiting_ends_when_it_is_asked_to) {
    const auto store = store_in_pieces(noise_of(SampleType::uint8, grid({64, 64, 64}), 7));
    Volume overview = overview_of(*store);
    std::stop_source source;
    store->before_read = [&](int, const SampleBox&, const std::stop_token& stop) {
        source.request_stop();
        while (!stop.stop_requested()) std::this_thread::yield();
        throw Cancelled{};
    };
    BrickLoader loader(store, std::move(overview), {.memory = least_memory, .threads = 2});
    EXPECT_THROW(loader.wait_for({30, 30, 30}, 10, source.get_token()), Cancelled);
}

TEST(BrickLoader, a_read_stops_when_asked_to_although_another_thread_reads_the_same_piece) {
    const auto store = store_in_pieces(noise_of(SampleType::uint8, grid({64, 64, 64}), 7));
    Volume overview = overview_of(*store);
    std::atomic<int> reading{0};
    store->before_read = [&](int, const SampleBox&, const std::stop_token& stop) {
        ++reading;
        while (!stop.stop_requested()) std::this_thread::yield();
        throw Cancelled{};
    };
    BrickLoader loader(store, std::move(overview), {.memory = least_memory, .threads = 8});
    const Interest hand{Vec3(30, 30, 30), Vec3(30, 30, 30)};
    loader.look({&hand, 1});
    ASSERT_TRUE(comes_true([&] { return reading == 8; }));  // all eight pieces
    std::stop_source source;
    source.request_stop();
    std::vector<std::byte> out(1);
    EXPECT_THROW(loader.read({{1, 1, 1}, {1, 1, 1}}, out, source.get_token()), Cancelled);
}

TEST(BrickLoader, waits_for_all_that_an_update_may_look_at_and_refuses_what_does_not_fit) {
    const Volume volume = large_noise({1000, 400, 400}, 8);
    const auto store = store_in_pieces(volume, {64, 64, 64});
    BrickLoader loader(store, overview_of(*store, 1000), {.memory = least_memory, .threads = 2});
    loader.wait_for({500, 200, 200}, 40);
    const Field field = linear_field(loader.take()->samples);
    EXPECT_TRUE(is_resident(field, {500, 200, 200}, 40));
    EXPECT_FALSE(is_resident(field, {100, 200, 200}, 1));
    EXPECT_THROW(loader.wait_for({500, 200, 200}, 250), std::invalid_argument);
    loader.wait_for({-500, 200, 200}, 10);  // background
}

TEST(BrickLoader, ends_at_once_while_a_read_hangs) {
    const auto store = store_in_pieces(noise_of(SampleType::uint8, grid({100, 100, 100}), 9));
    Volume overview = overview_of(*store);
    std::atomic<bool> reading{false};
    store->before_read = [&](int, const SampleBox&, const std::stop_token& stop) {
        reading = true;
        while (!stop.stop_requested()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
        throw Cancelled{};
    };
    auto loader = std::make_unique<BrickLoader>(store, std::move(overview),
                                                BrickLoaderSettings{.memory = least_memory});
    const Interest hand{Vec3(50, 50, 50), Vec3(50, 50, 50)};
    loader->look({&hand, 1});
    ASSERT_TRUE(comes_true([&] { return reading.load(); }));
    loader.reset();
    EXPECT_TRUE(reading);
}

TEST(BrickLoader, refuses_levels_that_are_not_there_and_too_little_memory) {
    const auto store = store_in_pieces(noise_of(SampleType::uint8, grid({10, 10, 10}), 1));
    const Volume overview = overview_of(*store);
    EXPECT_THROW(BrickLoader(store, overview, {.level = 1}), std::invalid_argument);
    EXPECT_THROW(BrickLoader(store, overview, {.level = -1}), std::invalid_argument);
    EXPECT_THROW(BrickLoader(store, overview, {.memory = 1000000}), std::invalid_argument);
}

TEST(Overview, is_the_finest_level_that_is_small_enough_or_single_samples) {
    const Volume fine = noise_of(SampleType::uint16, grid({90, 80, 70}), 2);
    const Volume coarse = noise_of(SampleType::uint16, grid({9, 8, 7}, {10, 10, 10}), 3);
    const VolumesStore both({fine, coarse}, {16, 16, 16});
    EXPECT_TRUE(same_bits(overview_of(both), fine));
    EXPECT_TRUE(same_bits(overview_of(both, 1000), coarse));
    // Rows of single samples would take a million chunks.
    const std::pair<Index3, std::int64_t> chunks[] = {
        {{90, 1, 1}, 1000}, {{16, 16, 16}, 512}, {{1, 1, 1}, 512}};
    for (const auto& [chunk, most] : chunks) {
        const VolumesStore one({fine}, chunk);
        const Volume thin = overview_of(one, 1000);
        EXPECT_LE(sample_count(thin.geometry()), most);
        EXPECT_GT(sample_count(thin.geometry()), 200);
        for_each_sample(thin.geometry(), [&](const Index3& at) {
            const Vec3 place = physical_from_index(thin.geometry(), at.cast<double>());
            const Vec3 index = index_from_physical(fine.geometry(), place);
            ASSERT_EQ(thin.sample(at), fine.sample(index.array().round().cast<int>()));
        });
    }
}

}  // namespace
}  // namespace palpate::stream
