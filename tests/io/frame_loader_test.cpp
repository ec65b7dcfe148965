// The frame loader: what it holds, how much, and what it hands out, with a player that lets old
// versions go as late as the servo does.
#include "palpate/io/frame_loader.hpp"

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <random>
#include <set>

#include "io/real_volumes.hpp"
#include "io/volume_support.hpp"
#include "support/eventually.hpp"

namespace palpate::io::test {
namespace {

using support::comes_true;

constexpr double interval = 0.1;
constexpr std::uint64_t frame_bytes = 16 * 16 * 16;

/// Bytes of the frames that exist, counted where they are made and freed.
struct Meter {
    std::atomic<std::int64_t> now{0}, most{0};
};

Volume metered(int number, const std::shared_ptr<Meter>& meter) {
    Geometry geometry;
    geometry.size = {16, 16, 16};
    auto* samples = new std::vector<std::uint8_t>(frame_bytes, static_cast<std::uint8_t>(number));
    const std::int64_t now = meter->now += static_cast<std::int64_t>(frame_bytes);
    for (std::int64_t most = meter->most;
         now > most && !meter->most.compare_exchange_weak(most, now);) {
    }
    const std::shared_ptr<const void> owned(samples->data(), [samples, meter](const void*) {
        delete samples;
        meter->now -= static_cast<std::int64_t>(frame_bytes);
    });
    return Volume(geometry, SampleType::uint8, owned, frame_bytes);
}

/// `count` frames; every sample of a frame is its number.
Sequence counted(int count, const std::shared_ptr<Meter>& meter = std::make_shared<Meter>()) {
    return made_sequence(count, interval,
                         [meter](int frame, const Progress&) { return metered(frame, meter); });
}

LoaderSettings room_for(int frames, bool loop = true) {
    return {static_cast<std::uint64_t>(frames) * frame_bytes, loop};
}

void look_and_settle(FrameLoader& loader, double time, double speed) {
    loader.look(time, speed);
    ASSERT_TRUE(comes_true([&] { return loader.status().settled; }));
}

std::vector<int> numbers_of(const Samples& samples) {
    std::vector<int> numbers;
    for (const Frame& frame : samples.frames()) {
        numbers.push_back(frame.number);
        EXPECT_EQ(frame.volume.minimum(), frame.number);
        EXPECT_EQ(frame.volume.maximum(), frame.number);
    }
    return numbers;
}

/// Holds a version until the one after the next comes, as the servo may.
struct Player {
    std::mutex mutex;
    std::vector<std::shared_ptr<const Samples>> held;

    FrameLoader::OnChange hook() {
        return [this](std::shared_ptr<const Samples> samples) {
            const std::lock_guard lock(mutex);
            held.push_back(std::move(samples));
            if (held.size() > 2) held.erase(held.begin());
        };
    }
};

}  // namespace

TEST(FrameLoader, a_sequence_that_fits_is_loaded_whole_and_goes_round) {
    FrameLoader loader(counted(8), room_for(8));
    look_and_settle(loader, 0, 1);
    const auto samples = loader.newest();
    ASSERT_TRUE(samples);
    EXPECT_EQ(numbers_of(*samples), (std::vector<int>{0, 1, 2, 3, 4, 5, 6, 7}));
    EXPECT_EQ(samples->period(), 8 * interval);
    EXPECT_EQ(samples->frames()[3].time, 3 * interval);
    EXPECT_EQ(loader.status().frames, 8);
    EXPECT_EQ(loader.status().bytes, 8 * frame_bytes);
    look_and_settle(loader, 12345.6, -1);
    EXPECT_EQ(loader.newest(), samples);  // nothing changes any more
    FrameLoader once(counted(8), room_for(8, false));
    look_and_settle(once, 0.3, 1);
    EXPECT_EQ(once.newest()->frames().size(), 8U);
    EXPECT_EQ(once.newest()->period(), 0);
}

TEST(FrameLoader, a_window_goes_ahead_in_the_direction_of_play) {
    FrameLoader loader(counted(20), room_for(6));
    look_and_settle(loader, 5.05 * interval, 1);
    EXPECT_EQ(numbers_of(*loader.newest()), (std::vector<int>{5, 6, 7, 8, 9}));
    look_and_settle(loader, 6.05 * interval, 0);  // paused: as it went before
    EXPECT_EQ(numbers_of(*loader.newest()), (std::vector<int>{6, 7, 8, 9, 10}));
    look_and_settle(loader, 6.05 * interval, -1);
    EXPECT_EQ(numbers_of(*loader.newest()), (std::vector<int>{3, 4, 5, 6, 7}));
    EXPECT_EQ(loader.newest()->period(), 0);
}

TEST(FrameLoader, times_go_on_over_the_seam_in_both_directions) {
    FrameLoader loader(counted(20), room_for(5));
    const double lap = 20 * interval;
    look_and_settle(loader, 3 * lap + 18.5 * interval, 1);
    EXPECT_EQ(numbers_of(*loader.newest()), (std::vector<int>{18, 19, 0, 1}));
    EXPECT_NEAR(loader.newest()->frames()[0].time, 3 * lap + 18 * interval, 1e-9);
    EXPECT_NEAR(loader.newest()->frames()[2].time, 4 * lap, 1e-9);
    look_and_settle(loader, -lap + 0.5 * interval, -2);
    EXPECT_EQ(numbers_of(*loader.newest()), (std::vector<int>{18, 19, 0, 1}));
    EXPECT_NEAR(loader.newest()->frames()[2].time, -lap, 1e-9);
    FrameLoader once(counted(20), room_for(5, false));
    look_and_settle(once, 19.5 * interval, 1);
    EXPECT_EQ(numbers_of(*once.newest()), (std::vector<int>{16, 17, 18, 19}));
    look_and_settle(once, -3, -1);
    EXPECT_EQ(numbers_of(*once.newest()), (std::vector<int>{0, 1, 2, 3}));
}

TEST(FrameLoader, where_play_is_has_its_frames_while_it_goes_on_for_laps) {
    for (const int room : {2, 3, 4, 7}) {
        for (const double speed : {1.0, -1.0}) {
            const auto meter = std::make_shared<Meter>();
            Sequence sequence = counted(9, meter);
            meter->most = 0;
            Player player;
            FrameLoader loader(std::move(sequence), room_for(room), player.hook());
            for (int i = 0; i < 60; ++i) {
                const double time = speed * 0.5 * interval * i + 0.25 * interval;
                look_and_settle(loader, time, speed);
                const auto samples = loader.newest();
                ASSERT_TRUE(samples);
                const Moment moment = samples->moment_at(time);
                ASSERT_EQ(samples->within(time), time) << room << " " << i;
                const int frame = static_cast<int>(std::floor(time / interval));
                const int expected = ((frame % 9) + 9) % 9;
                ASSERT_EQ(samples->frames()[moment.from].number, expected) << room << " " << i;
            }
            EXPECT_LE(meter->most, static_cast<std::int64_t>(room * frame_bytes)) << room;
        }
    }
}

TEST(FrameLoader, the_bound_holds_whoever_looks_wherever_and_keeps_versions) {
    std::mt19937 random(5);
    for (const int room : {2, 3, 5, 11}) {
        const auto meter = std::make_shared<Meter>();
        Sequence sequence = counted(16, meter);
        meter->most = 0;
        Player player;
        FrameLoader loader(std::move(sequence), room_for(room), player.hook());
        for (int i = 0; i < 300; ++i) {
            loader.look(uniform(random, -20, 20), uniform(random, -1, 1));
            if (random() % 4 == 0) std::this_thread::sleep_for(std::chrono::microseconds(300));
            ASSERT_LE(loader.status().bytes, room * frame_bytes);
        }
        look_and_settle(loader, 7.3 * interval, 1);
        EXPECT_EQ(loader.newest()->frames()[loader.newest()->moment_at(7.3 * interval).from].number,
                  7);
        EXPECT_LE(meter->most, static_cast<std::int64_t>(room * frame_bytes)) << room;
        EXPECT_GT(meter->most, static_cast<std::int64_t>(frame_bytes));
    }
}

TEST(FrameLoader, frames_that_somebody_still_holds_count) {
    const auto meter = std::make_shared<Meter>();
    FrameLoader loader(counted(20, meter), room_for(3));
    look_and_settle(loader, 0, 1);
    const auto kept = loader.newest();
    ASSERT_EQ(numbers_of(*kept), (std::vector<int>{0, 1, 2}));
    loader.look(10 * interval, 1);
    ASSERT_TRUE(comes_true([&] { return loader.newest() != kept; }));
    EXPECT_EQ(loader.newest()->frames().size(), 1U);  // no room for another one
    EXPECT_EQ(meter->now, static_cast<std::int64_t>(3 * frame_bytes));
    EXPECT_FALSE(loader.status().settled);
    std::weak_ptr<const Samples> gone = kept;
    const_cast<std::shared_ptr<const Samples>&>(kept).reset();
    EXPECT_TRUE(gone.expired());
    ASSERT_TRUE(comes_true([&] { return loader.status().settled; }));
    EXPECT_EQ(numbers_of(*loader.newest()), (std::vector<int>{10, 11, 12}));
}

TEST(FrameLoader, two_frames_must_fit) {
    EXPECT_THROW(FrameLoader(counted(2), room_for(1)), std::invalid_argument);
    EXPECT_THROW(FrameLoader(counted(2), LoaderSettings{0, true}), std::invalid_argument);
    FrameLoader one(counted(1), room_for(1));
    look_and_settle(one, 77, 1);
    EXPECT_EQ(numbers_of(*one.newest()), std::vector<int>{0});
    const std::string message =
        message_of<std::invalid_argument>([] { FrameLoader loader(counted(9), room_for(1)); });
    EXPECT_TRUE(contains(message, "2 frames take") && !contains(message, "\n")) << message;
}

TEST(FrameLoader, a_frame_that_cannot_be_read_is_told_and_passed_over_until_asked_again) {
    const auto broken = std::make_shared<std::atomic<bool>>(true);
    const auto reads = std::make_shared<std::atomic<int>>(0);
    Sequence sequence = counted(6);
    const auto reader = sequence.reader;
    sequence.reader = [=](int frame, const Progress& progress) {
        if (frame == 2) ++*reads;
        if (frame == 2 && *broken) throw InputError("heart_2.nrrd: is damaged");
        return reader(frame, progress);
    };
    FrameLoader loader(sequence, room_for(6));
    look_and_settle(loader, 0, 1);
    EXPECT_EQ(loader.problem(), "heart_2.nrrd: is damaged");
    EXPECT_EQ(numbers_of(*loader.newest()), (std::vector<int>{0, 1, 3, 4, 5}));
    EXPECT_EQ(loader.newest()->period(), 6 * interval);
    look_and_settle(loader, 0.2, 1);
    EXPECT_EQ(*reads, 1);
    *broken = false;
    loader.retry();
    ASSERT_TRUE(comes_true([&] { return loader.status().settled; }));
    EXPECT_EQ(loader.problem(), "");
    EXPECT_EQ(loader.newest()->frames().size(), 6U);
    *broken = true;
    FrameLoader window(sequence, room_for(4));
    look_and_settle(window, 1.5 * interval, 1);
    EXPECT_EQ(numbers_of(*window.newest()), (std::vector<int>{1, 3, 4}));
}

TEST(FrameLoader, damaged_frames_take_no_room_and_play_goes_over_them) {
    for (const std::set<int>& damaged : {std::set<int>{3}, {3, 4}, {0, 8}, {1, 3, 5, 7}}) {
        for (const int room : {2, 3, 4}) {
            for (const double speed : {1.0, -1.0}) {
                Sequence sequence = counted(9);
                const auto reader = sequence.reader;
                sequence.reader = [=](int frame, const Progress& progress) {
                    if (damaged.contains(frame)) throw InputError("damaged");
                    return reader(frame, progress);
                };
                FrameLoader loader(sequence, room_for(room));
                for (int i = 0; i < 60; ++i) {
                    const double time = speed * 0.5 * interval * i + 0.25 * interval;
                    look_and_settle(loader, time, speed);
                    const auto samples = loader.newest();
                    ASSERT_TRUE(samples);
                    ASSERT_EQ(samples->within(time), time)
                        << room << " " << i << ", damaged " << damaged.size();
                    ASSERT_LE(static_cast<int>(samples->frames().size()), room);
                }
            }
        }
    }
}

TEST(FrameLoader, files_that_vanish_are_a_problem_and_no_more) {
    const ScratchFolder folder;
    const auto meter = std::make_shared<Meter>();
    for (int i = 0; i < 4; ++i) {
        write_volume(metered(i, meter), folder / ("f" + std::to_string(i) + ".nrrd"));
    }
    const SequenceFile file = open_sequence(folder / "f%d.nrrd");
    std::filesystem::remove(folder / "f1.nrrd");
    put_bytes(folder / "f3.nrrd", "NRRD0004\nnothing of the kind\n\n");
    FrameLoader loader(file.sequence);
    look_and_settle(loader, 0, 1);
    EXPECT_EQ(numbers_of(*loader.newest()), (std::vector<int>{0, 2}));
    EXPECT_TRUE(one_line_about(loader.problem(), folder / "f3.nrrd")) << loader.problem();
}

TEST(FrameLoader, looking_never_waits_for_a_read_and_the_end_gives_a_read_up) {
    std::atomic<bool> reading{false};
    Sequence sequence = counted(4);
    const auto reader = sequence.reader;
    sequence.reader = [&](int frame, const Progress& progress) {
        if (frame == 0) return reader(frame, progress);
        reading = true;
        while (true) {  // for ever, unless it is given up
            progress(0.5);
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
    };
    FrameLoader loader(std::move(sequence), room_for(4));
    ASSERT_TRUE(comes_true([&] { return reading.load(); }));
    for (int i = 0; i < 100; ++i) loader.look(0.01 * i, 1);
    loader.look(std::nan(""), 1);
    loader.look(1e300, 1);
    loader.look(0.1, std::nan(""));
    EXPECT_FALSE(loader.status().settled);
    ASSERT_TRUE(loader.newest());
    EXPECT_EQ(numbers_of(*loader.newest()), std::vector<int>{0});
}

TEST(FrameLoader, the_turning_head_plays_round_in_half_of_its_memory) {
    const auto path = real_volume("fmri_headturn_4d.nrrd");
    if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not there";
    const SequenceFile file = open_sequence(path);
    const std::uint64_t bound = 3 * file.sequence.frame_bytes();
    Player player;
    FrameLoader loader(file.sequence, {bound, true}, player.hook());
    for (double time = 0.1; time < 40; time += 1.6) {
        look_and_settle(loader, time, 1);
        const auto samples = loader.newest();
        EXPECT_EQ(samples->within(time), time);
        EXPECT_EQ(samples->frames()[samples->moment_at(time).from].number,
                  static_cast<int>(time / 3.2) % 6);
        EXPECT_LE(loader.status().bytes, bound);
    }
    EXPECT_EQ(loader.problem(), "");
}

}  // namespace palpate::io::test
