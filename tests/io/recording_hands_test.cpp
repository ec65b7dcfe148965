// Recordings of several hands: each comes back as if it was recorded alone. And into a pipe that is
// not read: nobody waits for its reader longer than they want to.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/stat.h>

#include <array>

#include "io/process/helper_process.hpp"
#include "palpate/io/recording.hpp"
#include "support/eventually.hpp"
#include "support/press.hpp"
#include "support/random.hpp"
#include "support/scratch_folder.hpp"

using namespace palpate;
using namespace palpate::support;

namespace {

io::RecordingHead head_of_hand(int hand) {
    io::RecordingHead head;
    head.version = "1.2.3";
    head.volume = io::identify(ramp_field().volume(), {{"volume", "ramp.nrrd"}});
    head.device = "device " + std::to_string(hand);
    head.isovalue = 0.1 * hand;
    head.method = "exact";
    head.settings.force.rate_limit = 100.0 * hand;
    return head;
}

/// An edit with the shape of a tool. A recording numbers these bodies.
Command sweep(std::uint64_t version) {
    static const auto body = std::make_shared<const ToolBody>(
        std::make_shared<const Tool>(sphere_tool(2, 0.5)), 1.0, 1.0);
    const edit::Sweep edit{Brush{}, body, Pose{}, Pose{}};
    return command::Samples{nullptr, version,
                            std::make_shared<const Recipe>(EditOf{version - 1, edit})};
}

std::vector<SessionEvent> some_events(int count, int seed) {
    Random random(seed);
    std::vector<SessionEvent> events;
    std::uint64_t version = 0;
    for (int i = 0; i < count; ++i) {
        if (i % 50 == 10) {
            events.emplace_back(sweep(++version));
        } else if (random.below(5) == 0) {
            events.emplace_back(Command(command::Isovalue{random.uniform(-1, 1)}));
        } else {
            SessionTick tick;
            tick.tick.time = 1e-3 * i;
            tick.tick.force = random.point(-3, 3);
            tick.tick.proxy.scp = random.point(-9, 9);
            tick.device.position = random.point(-100, 100);
            tick.device.status = DeviceStatus::ready;
            events.emplace_back(tick);
        }
    }
    return events;
}

std::vector<SessionEvent> events_of(io::RecordingReader& reader) {
    std::vector<SessionEvent> events;
    while (const auto event = reader.next()) events.push_back(*event);
    return events;
}

std::string alone(int hand, const std::vector<SessionEvent>& events,
                  const std::filesystem::path& path) {
    io::RecordingWriter writer(path, head_of_hand(hand), Pace::by_steps);
    for (const SessionEvent& event : events) EXPECT_TRUE(writer.queue().push(event));
    writer.finish(7);
    return bytes_of(path);
}

/// Their lines come in blocks of different lengths.
std::string together(const std::array<std::vector<SessionEvent>, 2>& events,
                     const std::filesystem::path& path) {
    io::RecordingWriter writer(path, std::array{head_of_hand(1), head_of_hand(2)}, Pace::by_steps);
    writer.begin_with({Command(command::Isovalue{0.5})}, 2);
    for (std::size_t i = 0; i < events[0].size(); ++i) {
        EXPECT_TRUE(writer.queue(1).push(events[0][i]));
        EXPECT_TRUE(writer.queue(2).push(events[1][i]));
        if (i % 7 == 3) writer.step();
    }
    writer.finish(3, 1);
    EXPECT_FALSE(io::RecordingReader(bytes_of(path), "r.csv").complete());
    writer.finish(4, 2);
    return bytes_of(path);
}

TEST(RecordingOfHands, each_comes_back_bit_for_bit_as_if_it_was_recorded_alone) {
    const ScratchFolder folder;
    std::array events{some_events(1000, 1), some_events(1000, 2)};
    const std::string text = together(events, folder / "both.csv");
    EXPECT_TRUE(text.starts_with("# palpate recording 7\n"));
    events[1].insert(events[1].begin(), Command(command::Isovalue{0.5}));
    for (const int hand : {1, 2}) {
        io::RecordingReader reader(text, "both.csv", hand);
        EXPECT_EQ(reader.hands(), 2);
        EXPECT_EQ(reader.head().device, head_of_hand(hand).device);
        EXPECT_EQ(reader.head().isovalue, head_of_hand(hand).isovalue);
        EXPECT_EQ(reader.head().volume.crc32, head_of_hand(hand).volume.crc32);
        EXPECT_EQ(reader.head().settings.force.rate_limit, 100 * hand);
        const std::string name = std::to_string(hand) + ".csv";
        const std::string again = alone(hand, events_of(reader), folder / ("again" + name));
        EXPECT_EQ(again, alone(hand, events[hand - 1U], folder / ("alone" + name)));
        EXPECT_TRUE(again.starts_with("# palpate recording 6\n"));
        EXPECT_TRUE(reader.complete());
        EXPECT_EQ(reader.lost(), 7);
        EXPECT_EQ(reader.begin(), std::nullopt);
    }
    EXPECT_EQ(io::read_recording_head(folder / "both.csv").device, "device 1");
}

TEST(RecordingOfHands, says_how_far_apart_they_began_where_each_tells_it) {
    const ScratchFolder folder;
    const auto record = [&](const std::string& name, std::initializer_list<int> told) {
        const std::array heads{head_of_hand(1), head_of_hand(2)};
        io::RecordingWriter writer(folder / name, heads, Pace::by_steps);
        for (const int hand : told) writer.set_begin(7'000'000'000 - 500'000'000 * hand, hand);
        for (const int hand : {2, 1}) writer.finish(0, hand);
        return bytes_of(folder / name);
    };
    const auto begin_in = [](const std::string& text, int hand) {
        io::RecordingReader reader(text, "r.csv", hand);
        EXPECT_TRUE(events_of(reader).empty());
        return reader.begin();
    };
    const std::string both = record("both.csv", {1, 2});
    EXPECT_EQ(begin_in(both, 1), 0);
    EXPECT_EQ(begin_in(both, 2), -0.5);
    EXPECT_EQ(begin_in(record("one.csv", {2}), 2), std::nullopt);
    for (const char* wrong : {"[0.0]", "[0.0,null]", "3", "[0.0,\"a\"]"}) {
        std::string changed = both;
        changed.replace(changed.find("[0.0,-0.5]"), 10, wrong);
        EXPECT_THROW(begin_in(changed, 1), io::InputError) << wrong;
    }
}

TEST(RecordingOfHands, that_is_not_there_or_was_changed_is_refused) {
    const ScratchFolder folder;
    const std::string text =
        together({some_events(40, 1), some_events(40, 2)}, folder / "both.csv");
    const auto refusal = [](const std::string& changed, int hand) -> std::string {
        try {
            io::RecordingReader reader(changed, "r.csv", hand);
            events_of(reader);
        } catch (const io::InputError& e) {
            return e.what();
        }
        return "accepted";
    };
    EXPECT_EQ(refusal(text, 1), "accepted");
    EXPECT_EQ(refusal(text, 0), "r.csv: has no hand 0: there are 2");
    EXPECT_EQ(refusal(text, 3), "r.csv: has no hand 3: there are 2");
    EXPECT_EQ(refusal(alone(1, {}, folder / "one.csv"), 2), "r.csv: has no hand 2: there is one");
    const auto with = [&](const std::string& from, const std::string& to) {
        std::string changed = text;
        const auto at = changed.rfind(from);
        EXPECT_NE(at, std::string::npos) << from;
        return refusal(changed.replace(at, from.size(), to), 1);
    };
    // Of the second, although the first is read.
    EXPECT_TRUE(with(",2,0,", ",1,0,").find("is expected") != std::string::npos);
    EXPECT_TRUE(with(",2,0,", ",3,0,").find("hands are 1 to 2") != std::string::npos);
    EXPECT_TRUE(with("\"hand\":2}", "\"hand\":1}").find("checksum") != std::string::npos);
    EXPECT_TRUE(with("\"hand\":2}", "\"hand\":4294967297}").find("not valid") != std::string::npos);
    EXPECT_TRUE(with("\"hands\"", "\"bands\"").find("'hands' is missing") != std::string::npos);
    EXPECT_TRUE(with("recording 7", "recording 6").starts_with("r.csv: the head is not valid"));
}

/// A recording of two hands, of more ticks than a pipe has room for.
struct UnreadRecording {
    ScratchFolder folder;
    std::filesystem::path pipe = folder / "pipe";
    int made = ::mkfifo(pipe.c_str(), 0600);
    io::Descriptor reader{::open(pipe.c_str(), O_RDONLY | O_NONBLOCK)};
    io::Descriptor other{
        ::open(pipe.c_str(), O_WRONLY | O_NONBLOCK)};  // sees whether there is room
    std::array<io::RecordingHead, 2> heads{head_of_hand(1), head_of_hand(2)};
    io::RecordingWriter writer{pipe, heads};

    UnreadRecording() {
        SessionTick tick;
        for (int i = 0; i < 2000; ++i) {
            tick.tick.time = 1e-3 * i;
            for (const int hand : {1, 2}) EXPECT_TRUE(writer.queue(hand).push(tick));
        }
        EXPECT_TRUE(comes_true([&] {
            pollfd room{other.number(), POLLOUT, 0};
            return ::poll(&room, 1, 0) == 0;
        }));
    }
};

TEST(RecordingInPipe, that_is_not_read_ends_when_the_caller_has_waited_enough) {
    UnreadRecording p;
    struct Enough {};
    int calls = 0;
    const auto enough = [&](double) {
        if (++calls > 1) throw Enough{};
    };
    EXPECT_THROW(p.writer.finish(0, 1, enough), Enough);
    EXPECT_TRUE(contains(p.writer.problem(), "not waited for")) << p.writer.problem();
    const auto never = [](double) { FAIL() << "the reader is waited for again"; };
    EXPECT_THROW(p.writer.finish(0, 2, never), io::OutputError);
}

TEST(RecordingInPipe, that_is_not_read_ends_by_itself) {
    UnreadRecording p;
    EXPECT_THROW(p.writer.finish(0, 1), io::OutputError);
    EXPECT_TRUE(contains(p.writer.problem(), "not waited for")) << p.writer.problem();
}

TEST(RecordingInPipe, that_is_not_read_holds_up_nobody_who_leaves_it) {
    const UnreadRecording p;
}

}  // namespace
