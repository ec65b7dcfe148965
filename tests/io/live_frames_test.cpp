// Live sources: the file's layout, two processes, torn frames, damage, and writers that go.
#include "palpate/io/live_frames.hpp"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>

#include "io/volume_support.hpp"
#include "support/eventually.hpp"

extern char** environ;

namespace palpate::io::test {
namespace {

using support::comes_true;

Geometry grid(const Index3& size = {16, 16, 16}) {
    Geometry geometry;
    geometry.size = size;
    geometry.spacing = {0.5, 1, 2};
    geometry.origin = {-3, 4, 5};
    geometry.direction = Vec3(-1, 1, 1).asDiagonal();
    return geometry;
}

Volume filled(int value, const Geometry& geometry = grid()) {
    const auto count = static_cast<std::size_t>(sample_count(geometry));
    return Volume(geometry, std::vector<std::uint8_t>(count, static_cast<std::uint8_t>(value)));
}

std::vector<double> times_of(const Samples& samples) {
    std::vector<double> times;
    for (const Frame& frame : samples.frames()) times.push_back(frame.time);
    return times;
}

template <class T>
void overwrite(const std::filesystem::path& path, std::size_t at, T value) {
    std::fstream file(path, std::ios::binary | std::ios::in | std::ios::out);
    file.seekp(static_cast<std::streamoff>(at));
    file.write(reinterpret_cast<const char*>(&value), sizeof value);
}

/// The example as a process of its own.
class LiveSource {
  public:
    explicit LiveSource(const std::filesystem::path& file) {
        std::string program = PALPATE_LIVE_SOURCE, path = file.string();
        char* arguments[] = {program.data(), path.data(), nullptr};
        posix_spawn_file_actions_t actions;
        posix_spawn_file_actions_init(&actions);
        posix_spawn_file_actions_addopen(&actions, 1, "/dev/null", O_WRONLY, 0);
        const int error =
            posix_spawn(&process_, program.c_str(), &actions, nullptr, arguments, environ);
        posix_spawn_file_actions_destroy(&actions);
        if (error != 0) throw std::runtime_error("the example could not be started");
    }
    ~LiveSource() { end(SIGKILL); }
    void end(int signal) {
        if (process_ <= 0) return;
        kill(process_, signal);
        waitpid(process_, nullptr, 0);
        process_ = 0;
    }

  private:
    pid_t process_ = 0;
};

}  // namespace

TEST(LiveWindow, the_last_four_frames_are_kept) {
    LiveWindow window;
    EXPECT_EQ(times_of(*window.push(filled(0), 0.5)), std::vector<double>{0.5});
    for (int i = 1; i < 5; ++i) window.push(filled(i), 0.5 + i);
    const auto samples = window.push(filled(5), 7);
    EXPECT_EQ(times_of(*samples), (std::vector<double>{2.5, 3.5, 4.5, 7}));
    EXPECT_EQ(samples->frames().back().number, 5);
    EXPECT_EQ(samples->frames().back().volume.minimum(), 5);
    EXPECT_EQ(samples->period(), 0);
    EXPECT_THROW(window.push(filled(6), std::nan("")), std::invalid_argument);
    EXPECT_THROW(window.push(filled(6, grid({2, 2, 2})), 8), std::invalid_argument);
    EXPECT_EQ(times_of(*window.push(filled(6), 8)), (std::vector<double>{3.5, 4.5, 7, 8}));
    EXPECT_EQ(times_of(*window.push(filled(7), 8)), std::vector<double>{8});  // a new clock
    EXPECT_THROW(LiveWindow(0), std::invalid_argument);
}

TEST(LiveFile, its_layout_is_the_documented_one) {
    const ScratchFolder folder;
    const auto path = folder / "a";
    {
        LiveWriter writer(path, grid({3, 2, 1}), SampleType::int16, 0.02, 3);
        const std::int16_t samples[6] = {1, 2, 3, 4, 5, 600};
        for (int i = 0; i < 4; ++i) writer.push(std::as_bytes(std::span(samples)), 0.25 * i);
    }
    const std::string bytes = bytes_of(path);
    ASSERT_EQ(bytes.size(), 256U + 3 * 128);
    std::string head = "PALPLIVE" + little<std::uint32_t>(1) + little<std::uint32_t>(256) +
                       little<std::uint32_t>(1) + little<std::uint32_t>(3);
    for (const std::int32_t n : {3, 2, 1, 0}) head += little(n);
    for (const double x : {0.5, 1.0, 2.0, -3.0, 4.0, 5.0}) head += little(x);
    for (const double x : {-1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0}) head += little(x);
    head += little(0.02) + little<std::uint64_t>(256) + little<std::uint64_t>(128) +
            little<std::uint64_t>(4) + little<std::uint32_t>(1);
    head.resize(256);
    // +0.0 and -0.0 are the same number, not the same bytes: compare what is not a direction.
    EXPECT_EQ(bytes.substr(0, 88), head.substr(0, 88));
    EXPECT_EQ(bytes.substr(160, 96), head.substr(160));
    std::string slot = little<std::uint64_t>(8) + little(0.75);  // frame 3 lies where frame 0 did
    slot.resize(64);
    for (const std::int16_t s : {1, 2, 3, 4, 5, 600}) slot += little(s);
    EXPECT_EQ(bytes.substr(256, slot.size()), slot);
    const LiveReader reader(path);
    EXPECT_EQ(reader.header().geometry, grid({3, 2, 1}));
    EXPECT_EQ(reader.header().type, SampleType::int16);
    EXPECT_EQ(reader.header().interval, 0.02);
    EXPECT_EQ(folder.names(), std::vector<std::string>{"a"});
}

TEST(LiveFile, frames_come_in_order_and_missed_ones_are_counted) {
    const ScratchFolder folder;
    LiveWriter writer(folder / "a", grid(), SampleType::uint8, 0, 4);
    LiveReader reader(folder / "a");
    EXPECT_TRUE(reader.poll().empty());
    for (int i = 0; i < 10; ++i) writer.push(filled(i), i);
    const auto frames = reader.poll();
    ASSERT_EQ(frames.size(), 3U);  // of four slots one is the writer's
    for (int i = 0; i < 3; ++i) {
        EXPECT_EQ(frames[std::size_t(i)].number, 7 + i);
        EXPECT_EQ(frames[std::size_t(i)].time, 7 + i);
        EXPECT_TRUE(same_samples(frames[std::size_t(i)].volume, filled(7 + i)));
    }
    EXPECT_EQ(reader.missed(), 7U);
    EXPECT_TRUE(reader.poll().empty());
    writer.push(filled(99), 99);
    EXPECT_EQ(reader.poll().size(), 1U);
    EXPECT_FALSE(reader.ended());
}

TEST(LiveFile, a_torn_frame_is_never_seen) {
    const ScratchFolder folder;
    for (const int slots : {2, 4}) {
        LiveWriter writer(folder / "a", grid({40, 40, 40}), SampleType::uint8, 0, slots);
        LiveReader reader(folder / "a");
        std::atomic<bool> stop{false};
        std::thread fast([&] {
            std::vector<std::byte> samples(64000);
            for (std::uint64_t i = 0; !stop; ++i) {
                std::fill(samples.begin(), samples.end(), static_cast<std::byte>(i % 251));
                writer.push(samples, static_cast<double>(i));
            }
        });
        int seen = 0;
        double last = -1;
        while (seen < 500) {
            for (const Frame& frame : reader.poll()) {
                ++seen;
                ASSERT_GT(frame.time, last);
                last = frame.time;
                ASSERT_EQ(frame.volume.minimum(), frame.volume.maximum());
                ASSERT_EQ(frame.volume.minimum(), std::fmod(frame.time, 251));
            }
        }
        stop = true;
        fast.join();
        EXPECT_GT(reader.missed(), 0U);
    }
}

TEST(LiveFile, damaged_headers_are_refused_in_one_line) {
    const ScratchFolder folder;
    const auto path = folder / "a";
    const auto refused = [&](auto damage) {
        { LiveWriter writer(path, grid(), SampleType::uint8); }
        damage();
        const std::string message = message_of<InputError>([&] { LiveReader reader(path); });
        EXPECT_TRUE(one_line_about(message, path)) << message;
        return message;
    };
    const auto with = [&](std::size_t at, auto value) {
        return refused([&] { overwrite(path, at, value); });
    };
    EXPECT_TRUE(contains(with(0, 'X'), "PALPLIVE"));
    EXPECT_TRUE(contains(with(8, std::uint32_t{2}), "version 2"));
    EXPECT_TRUE(contains(with(16, std::uint32_t{4}), "sample type 4"));
    for (const std::uint32_t slots : {0U, 1U, 1025U, 0xffffffffU}) with(20, slots);
    for (const std::int32_t size : {0, -1, 17, 1 << 20, 0x7fffffff}) with(24, size);
    for (const double x : {0.0, -1.0, std::nan(""), double(INFINITY)}) with(40, x);
    with(64, std::nan(""));
    with(88, 2.0);
    for (const double x : {-1.0, std::nan("")}) with(160, x);
    for (const std::uint64_t at : {std::uint64_t{0}, std::uint64_t{255}, ~std::uint64_t{63}}) {
        with(168, at);
        with(176, at);
    }
    EXPECT_TRUE(contains(refused([&] { std::filesystem::resize_file(path, 5000); }), "too short"));
    refused([&] { std::filesystem::resize_file(path, 255); });
    refused([&] { std::filesystem::resize_file(path, 0); });
    std::filesystem::remove(path);
    EXPECT_TRUE(one_line_about(message_of<InputError>([&] { LiveReader reader(path); }), path));
    ASSERT_EQ(mkfifo(path.c_str(), 0600), 0);
    EXPECT_TRUE(one_line_about(message_of<InputError>([&] { LiveReader reader(path); }), path));
    EXPECT_THROW(LiveReader reader(folder.path()), InputError);
    EXPECT_THROW(LiveWriter(folder / "no/a", grid(), SampleType::uint8), OutputError);
    EXPECT_THROW(LiveWriter(path, grid(), SampleType::uint8, 0, 1), std::invalid_argument);
}

TEST(LiveFile, a_frame_that_makes_no_sense_is_told_and_the_next_one_comes) {
    const ScratchFolder folder;
    const Geometry geometry = grid({2, 2, 2});
    LiveWriter writer(folder / "a", geometry, SampleType::float32);
    LiveReader reader(folder / "a");
    std::vector<float> samples(8, 1);
    samples[3] = std::nanf("");
    writer.push(std::as_bytes(std::span(samples)), 1);
    EXPECT_TRUE(one_line_about(message_of<InputError>([&] { reader.poll(); }), folder / "a"));
    samples[3] = 2;
    writer.push(std::as_bytes(std::span(samples)), 2);
    const auto frames = reader.poll();
    ASSERT_EQ(frames.size(), 1U);
    EXPECT_EQ(frames[0].volume.maximum(), 2);
    EXPECT_THROW(writer.push(std::as_bytes(std::span(samples)), std::nan("")),
                 std::invalid_argument);
    EXPECT_THROW(writer.push(filled(1), 3), std::invalid_argument);
}

/// Live frames whose time the test moves on.
struct Followed {
    LiveFrames frames;
    std::chrono::steady_clock::time_point now = std::chrono::steady_clock::now();

    explicit Followed(const std::filesystem::path& path, LiveFrames::OnChange on_change = {})
        : frames(path, {}, std::move(on_change), Pace::by_steps) {}
    LiveStatus step(int milliseconds = 2) {
        now += std::chrono::milliseconds(milliseconds);
        frames.step(now);
        return status();
    }
    LiveStatus status() const { return frames.status(now); }
};

TEST(LiveFrames, a_file_that_is_cut_off_is_a_problem_not_a_crash) {
    const ScratchFolder folder;
    const auto path = folder / "a";
    auto writer = std::make_unique<LiveWriter>(path, grid(), SampleType::uint8);
    writer->push(filled(1), 1);
    Followed live(path);
    ASSERT_TRUE(live.frames.newest());  // what is there is there at once
    std::filesystem::resize_file(path, 100);
    EXPECT_TRUE(contains(live.step().problem, "shorter than its header"));
    EXPECT_EQ(live.frames.newest()->frames().back().time, 1);
    std::filesystem::resize_file(path, writer->header().file_bytes());
    // Started again, in another file of that name.
    writer = std::make_unique<LiveWriter>(path, grid(), SampleType::uint8);
    writer->push(filled(7), 70);
    constexpr int steps_until_suspicion = 60;
    for (int i = 0; i < steps_until_suspicion; ++i) live.step();
    EXPECT_EQ(live.frames.newest()->frames().back().time, 70);
    EXPECT_EQ(live.status().problem, "");
    LiveWriter other(path, grid({4, 4, 4}), SampleType::uint8);
    for (int i = 0; i < steps_until_suspicion; ++i) live.step();
    EXPECT_TRUE(contains(live.status().problem, "another grid"));
}

TEST(LiveFrames, versions_hold_the_last_four_frames_in_the_writers_times) {
    const ScratchFolder folder;
    LiveWriter writer(folder / "a", grid(), SampleType::uint8, 0.04, 8);
    int versions = 0;
    Followed live(folder / "a", [&](const std::shared_ptr<const Samples>& samples) {
        EXPECT_TRUE(samples);
        ++versions;
    });
    EXPECT_FALSE(live.frames.newest());
    EXPECT_EQ(live.frames.interval(), 0.04);
    for (int i = 0; i < 6; ++i) {
        writer.push(filled(i), 10 + 0.04 * i);
        EXPECT_EQ(live.step().frames, std::uint64_t(i) + 1);
        EXPECT_EQ(live.step().frames, std::uint64_t(i) + 1);
    }
    const auto samples = live.frames.newest();
    ASSERT_EQ(samples->frames().size(), 4U);
    EXPECT_EQ(samples->frames()[0].time, 10 + 0.04 * 2);
    EXPECT_EQ(samples->frames()[3].number, 5);
    EXPECT_EQ(samples->within(11), samples->frames()[3].time);
    EXPECT_EQ(versions, 6);
    EXPECT_EQ(live.status().missed, 0U);
    LiveSettings odd;
    odd.frames = 1;
    EXPECT_THROW(LiveFrames(folder / "a", odd), std::invalid_argument);
}

TEST(LiveFrames, their_age_is_the_time_since_the_last_one_and_an_end_is_told) {
    const ScratchFolder folder;
    auto writer = std::make_unique<LiveWriter>(folder / "a", grid(), SampleType::uint8);
    Followed live(folder / "a");
    writer->push(filled(1), 1);
    EXPECT_EQ(live.step().age, 0);
    EXPECT_NEAR(live.step(200).age, 0.2, 1e-9);
    EXPECT_NEAR(live.step(1900).age, 2.1, 1e-9);
    EXPECT_FALSE(live.status().ended);
    writer->push(filled(2), 2);
    EXPECT_EQ(live.step().age, 0);
    writer.reset();
    EXPECT_TRUE(live.step().ended);
}

TEST(PacedLiveFrames, another_process_gives_frames_dies_and_is_started_again) {
    const ScratchFolder folder;
    const auto path = folder / "ball";
    LiveSource source(path);
    ASSERT_TRUE(comes_true([&] { return std::filesystem::exists(path); }));
    LiveFrames frames(path);
    ASSERT_TRUE(frames.wait(120));
    EXPECT_EQ(frames.geometry().size, Index3(48, 48, 48));
    ASSERT_TRUE(comes_true([&] { return frames.status().frames > 20; }));
    const auto samples = frames.newest();
    ASSERT_GE(samples->frames().size(), 2U);
    EXPECT_FALSE(same_samples(samples->frames().front().volume, samples->frames().back().volume));
    for (const Frame& frame : samples->frames()) {
        EXPECT_NEAR(frame.time, 0.02 * frame.number, 1e-9);
        EXPECT_EQ(frame.volume.minimum(), 0);
        EXPECT_EQ(frame.volume.maximum(), 255);
    }
    source.end(SIGKILL);
    EXPECT_FALSE(frames.status().ended);  // it could not say so
    const auto count = frames.status().frames;
    LiveSource again(path);
    ASSERT_TRUE(comes_true([&] { return frames.status().frames > count + 8; }));
    again.end(SIGTERM);
    ASSERT_TRUE(comes_true([&] { return frames.status().ended; }));
    EXPECT_EQ(frames.status().problem, "");
}

}  // namespace palpate::io::test
