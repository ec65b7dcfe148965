// Recordings: all events come back bit for bit, whatever ends the writing.
#include "palpate/io/recording.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <fstream>
#include <limits>
#include <sstream>
#include <string>

#include "support/eventually.hpp"
#include "support/press.hpp"
#include "support/random.hpp"
#include "support/recordings.hpp"
#include "support/scratch_folder.hpp"

using namespace palpate;
using namespace palpate::support;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

io::RecordingHead some_head() {
    const Field field = ramp_field();
    io::RecordingHead head;
    head.version = "1.2.3";
    head.begun = "2026-01-02T03:04:05Z";
    head.volume = io::identify(field.volume(), {{"volume", "a \"b\".raw"}, {"dims", "9x9x101"}});
    head.solid = Solid::below;
    head.interpolation = Interpolation::cubic;
    head.background = -infinity;
    head.isovalue = 0.1 + 0.2;
    head.device = "simulated omni";
    head.rate = 1000;
    head.method = "exact";
    head.settings.proxy.friction = {0.3, 1.0 / 3};
    head.settings.proxy.step_budget = 777;
    const std::array<DensityRange, 2> ranges{DensityRange{1, 2}, DensityRange{3, infinity}};
    head.settings.penetrability = penetrability_ranges(0.7, ranges);
    head.settings.force.rate_limit = infinity;
    head.settings.force.start_below = 0.3;
    head.settings.force.magnet = {1, 0.25};
    head.settings.device.maximum_force = 7.9;
    head.settings.transform = {oblique_direction(), Vec3(0.1, 0.2, 0.3), 1.7};
    head.settings.forces_on = false;
    head.session = {.clutch_buttons = 5, .deadman_buttons = 2, .fastest_hand = 1, .overrun = 3};
    return head;
}

SessionTick random_tick(Random& random, double time) {
    SessionTick tick;
    tick.tick.time = time;
    tick.tick.proxy.status = static_cast<UpdateStatus>(random.below(4));
    tick.tick.proxy.mode = static_cast<Mode>(random.below(2));
    tick.tick.proxy.hip = random.point(-100, 100);
    tick.tick.proxy.scp = random.point(-1e-300, 1e300);
    tick.tick.proxy.density = random.uniform(-1, 1);
    tick.tick.proxy.isovalue = random.below(9) == 0 ? infinity : random.uniform(0, 1);
    tick.tick.proxy.tetrahedra = random.below(1000);
    tick.tick.force = random.point(-3, 3);
    tick.tick.torque = random.point(-300, 300);
    tick.tick.tool = {random.orientation(), random.orientation(), random.below(30)};
    tick.tick.force_flags = static_cast<std::uint16_t>(random.below(512));
    tick.tick.update_ns = random.below(100000);
    tick.device.status = static_cast<DeviceStatus>(random.below(7));
    tick.device.position = random.point(-100, 100);
    tick.device.buttons = 0x80000001U;
    tick.device.opening = 0.1;
    tick.device.age = random.uniform(0, 0.1);
    tick.device.orientation = oblique_direction() * random.uniform(0, 1);
    tick.frozen = random.below(2) == 0;
    tick.clutched = random.below(2) == 0;
    return tick;
}

std::shared_ptr<const Tool> random_tool(Random& random) {
    std::vector<Vec3> points;
    for (int i = 0; i < 5; ++i) points.push_back(random.point(-3, 3));
    return std::make_shared<const Tool>(points, random.uniform(1, 9), random.below(2) == 0);
}

Command random_command(Random& random) {
    switch (random.below(12)) {
        case 0:
            return command::Isovalue{random.uniform(-1, 1)};
        case 1:
            return command::Freeze{random.below(2) == 0};
        case 2:
            return command::Clutch{random.below(2) == 0};
        case 3:
            return command::Forces{random.below(2) == 0};
        case 4:
            return command::Scale{random.uniform(0.1, 9)};
        case 5: {
            ForceSettings force;
            force.stiffness = random.uniform(0, 1);
            force.rotational_stiffness = random.uniform(0, 100);
            force.limit = infinity;
            return force;
        }
        case 6:
            return Friction{random.uniform(0.5, 1), random.uniform(0, 0.5)};
        case 7:
            return penetrability_threshold(random.uniform(0, 3), random.uniform(0, 1));
        case 8:
            return DeviceLimits{random.uniform(1, 20), 250, random.uniform(1e-3, 1e-2),
                                random.uniform(0, 400), random.uniform(0.1, 2)};
        case 9:
            return command::UseTool{random.below(3) == 0 ? nullptr : random_tool(random)};
        case 10:
            return command::Lift{};
        default:
            return DeviceTransform{oblique_direction(), random.point(-1, 1), 2};
    }
}

std::vector<SessionEvent> random_events(int count) {
    Random random(9);
    std::vector<SessionEvent> events;
    for (int i = 0; i < count; ++i) {
        if (random.below(5) == 0) {
            events.emplace_back(random_command(random));
        } else {
            events.emplace_back(random_tick(random, i * 1e-3));
        }
    }
    return events;
}

/// As a recording would have it; text compares every bit that is written.
std::string written(const std::vector<SessionEvent>& events, const std::filesystem::path& path) {
    io::RecordingWriter writer(path, some_head(), Pace::by_steps);
    for (const SessionEvent& event : events) {
        while (!writer.queue().push(event)) writer.step();
    }
    writer.finish(0);
    return bytes_of(path);
}

std::vector<SessionEvent> read_all(io::RecordingReader& reader) {
    std::vector<SessionEvent> events;
    while (const auto event = reader.next()) events.push_back(*event);
    return events;
}

TEST(Recording, every_event_and_the_head_come_back_bit_for_bit) {
    const ScratchFolder folder;
    const std::string first = written(random_events(3000), folder / "first.csv");
    io::RecordingReader reader(folder / "first.csv");
    const std::vector<SessionEvent> events = read_all(reader);
    EXPECT_EQ(events.size(), 3000U);
    EXPECT_TRUE(reader.complete());
    EXPECT_EQ(reader.lost(), 0);
    EXPECT_EQ(written(events, folder / "second.csv"), first);

    const io::RecordingHead head = reader.head();
    const io::RecordingHead expected = some_head();
    EXPECT_EQ(head.volume.options, expected.volume.options);
    EXPECT_EQ(head.volume.crc32, expected.volume.crc32);
    EXPECT_EQ(head.volume.size, expected.volume.size);
    EXPECT_EQ(head.isovalue, expected.isovalue);
    EXPECT_EQ(head.background, -infinity);
    EXPECT_EQ(head.solid, Solid::below);
    EXPECT_EQ(head.interpolation, Interpolation::cubic);
    EXPECT_EQ(head.settings.transform.rotation, expected.settings.transform.rotation);
    EXPECT_EQ(head.settings.penetrability.ranges[1].high, infinity);
    EXPECT_EQ(head.settings.penetrability.range_count, 2);
    EXPECT_EQ(head.settings.force.rate_limit, infinity);
    EXPECT_EQ(head.session.clutch_buttons, 5U);
}

TEST(Recording, ticks_hold_what_was_put_in) {
    const ScratchFolder folder;
    Random random(4);
    const SessionTick tick = random_tick(random, 0.25);
    written({tick}, folder / "r.csv");
    io::RecordingReader reader(folder / "r.csv");
    const auto back = std::get<SessionTick>(*reader.next());
    EXPECT_EQ(back.tick.time, 0.25);
    EXPECT_EQ(back.tick.proxy.scp, tick.tick.proxy.scp);
    EXPECT_EQ(back.tick.proxy.status, tick.tick.proxy.status);
    EXPECT_EQ(back.tick.force, tick.tick.force);
    EXPECT_EQ(back.tick.torque, tick.tick.torque);
    EXPECT_EQ(back.tick.tool.hand.coeffs(), tick.tick.tool.hand.coeffs());
    EXPECT_EQ(back.tick.tool.proxy.coeffs(), tick.tick.tool.proxy.coeffs());
    EXPECT_EQ(back.tick.tool.contacts, tick.tick.tool.contacts);
    EXPECT_EQ(back.tick.force_flags, tick.tick.force_flags);
    EXPECT_EQ(back.device.orientation, tick.device.orientation);
    EXPECT_EQ(back.device.buttons, tick.device.buttons);
    EXPECT_EQ(back.device.opening, tick.device.opening);
    EXPECT_EQ(back.device.age, tick.device.age);
    EXPECT_EQ(back.frozen, tick.frozen);
    EXPECT_FALSE(reader.next());
}

TEST(Recording, cut_off_anywhere_it_gives_the_whole_lines_before) {
    const ScratchFolder folder;
    const std::string text = written(random_events(60), folder / "r.csv");
    const std::size_t table = text.find("\nt,hip_x");
    Random random(2);
    for (int i = 0; i < 200; ++i) {
        const auto first = static_cast<int>(text.find('\n', table + 1)) + 1;
        const auto cut =
            static_cast<std::size_t>(first + random.below(static_cast<int>(text.size()) - first));
        io::RecordingReader reader(text.substr(0, cut), "cut.csv");
        const std::string rest = text.substr(0, cut);
        const auto lines = std::ranges::count(rest.substr(static_cast<std::size_t>(first)), '\n');
        EXPECT_EQ(read_all(reader).size(), static_cast<std::size_t>(lines));
        EXPECT_EQ(reader.complete(), cut + 1 == text.size());
    }
}

TEST(Recording, without_the_end_of_its_last_line_is_complete) {
    const ScratchFolder folder;
    const std::string text = written(random_events(20), folder / "r.csv");
    for (const std::size_t less : {1, 2, 9}) {
        io::RecordingReader reader(text.substr(0, text.size() - less), "r.csv");
        EXPECT_EQ(read_all(reader).size(), 20U);
        EXPECT_EQ(reader.complete(), less == 1);
    }
}

TEST(Recording, a_damaged_one_is_an_input_error_that_names_the_file) {
    const ScratchFolder folder;
    const std::string text = written(random_events(20), folder / "r.csv");
    const auto refusal = [&](std::string damaged) -> std::string {
        try {
            io::RecordingReader reader(std::move(damaged), "bad.csv");
            read_all(reader);
        } catch (const io::InputError& e) {
            return e.what();
        }
        return "accepted";
    };
    const auto with = [&](const std::string& from, const std::string& to) {
        std::string changed = text;
        const auto at = changed.find(from);
        EXPECT_NE(at, std::string::npos) << from;
        return changed.replace(at, from.size(), to);
    };
    const auto expect = [&](const std::string& message, const std::string& part) {
        EXPECT_TRUE(message.starts_with("bad.csv")) << message;
        EXPECT_NE(message.find(part), std::string::npos) << message;
        EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    };
    expect(refusal(""), "is no recording");
    expect(refusal("t,x,y,z\n0,1,2,3\n"), "is no recording");
    expect(refusal(with("recording 6", "recording 8")), "later version");
    expect(refusal(with("\"version\": ", "\"version\" ")), "not valid JSON");
    expect(refusal(with("\"version\"", "\"edition\"")), "'version' is missing");
    expect(refusal(with("\"stiffness\": 0.5", "\"stiffness\": \"hard\"")), "'force.stiffness'");
    expect(refusal(with("\"range_count\": 2", "\"range_count\": 1000")), "range_count");
    expect(refusal(with("\"float32\"", "\"int5\"")), "sample type");
    expect(refusal(with("# command {", "# command [")), "is not valid");
    expect(refusal(with("device_status", "device_state")), "device_status");
}

std::vector<std::string> lines_from(const std::string& text, std::size_t begin) {
    std::vector<std::string> lines;
    std::istringstream rest(text.substr(begin));
    for (std::string line; std::getline(rest, line);) lines.push_back(line + '\n');
    return lines;
}

std::string joined(const std::string& head, const std::vector<std::string>& lines) {
    std::string text = head;
    for (const std::string& line : lines) text += line;
    return text;
}

/// The message of a refusal; empty if all of it is read.
std::string why_refused(const std::string& text) {
    try {
        io::RecordingReader reader(text, "r.csv");
        read_all(reader);
    } catch (const io::InputError& e) {
        return e.what();
    }
    return {};
}

TEST(Recording, without_one_of_its_ticks_or_commands_it_is_refused) {
    const ScratchFolder folder;
    const std::string text = written(random_events(200), folder / "r.csv");
    const std::size_t begin = first_row(text);
    const std::string head = text.substr(0, begin);
    const std::vector<std::string> lines = lines_from(text, begin);
    ASSERT_EQ(lines.size(), 201U);
    EXPECT_EQ(why_refused(text), "");
    for (std::size_t i = 0; i + 1 < lines.size(); ++i) {
        std::vector<std::string> fewer = lines;
        fewer.erase(fewer.begin() + static_cast<std::ptrdiff_t>(i));
        EXPECT_TRUE(contains(why_refused(joined(head, fewer)), "since it was recorded"))
            << lines[i];
        // As if it was cut off as well. A command that nothing follows has left no trace.
        fewer.pop_back();
        const bool last = std::ranges::all_of(
            fewer.begin() + static_cast<std::ptrdiff_t>(i), fewer.end(),
            [](const std::string& line) { return line.starts_with("# command"); });
        EXPECT_EQ(contains(why_refused(joined(head, fewer)), "since it was recorded"), !last)
            << lines[i];
    }
}

TEST(Recording, with_events_moved_repeated_or_changed_in_one_digit_it_is_refused) {
    const ScratchFolder folder;
    const std::string text = written(random_events(100), folder / "r.csv");
    const std::size_t begin = first_row(text);
    const std::string head = text.substr(0, begin);
    const std::vector<std::string> lines = lines_from(text, begin);
    for (std::size_t i = 0; i + 2 < lines.size(); ++i) {
        std::vector<std::string> other = lines;
        std::swap(other[i], other[i + 1]);
        EXPECT_EQ(why_refused(joined(head, other)).empty(), other == lines) << lines[i];
        other = lines;
        other.insert(other.begin() + static_cast<std::ptrdiff_t>(i), lines[i]);
        EXPECT_NE(why_refused(joined(head, other)), "") << lines[i];
    }
    Random random(8);
    int digits = 0;
    for (int i = 0; i < 2000; ++i) {
        const auto end = static_cast<int>(text.find("# end ") - begin);
        const std::size_t at = begin + static_cast<std::size_t>(random.below(end));
        if (text[at] < '0' || text[at] > '9') continue;
        std::string other = text;
        other[at] = text[at] == '9' ? '0' : static_cast<char>(text[at] + 1);
        EXPECT_NE(why_refused(other), "") << text.substr(at - 9, 20);
        ++digits;
    }
    EXPECT_GT(digits, 1000);
    EXPECT_NE(why_refused(text + lines[1]), "") << "goes on after its end";
}

TEST(Recording, with_a_misspelt_column_it_is_refused) {
    const ScratchFolder folder;
    const std::string text = written(random_events(20), folder / "r.csv");
    const std::size_t header = text.find("\nt,") + 1;
    for (std::size_t at = header; text[at] != '\n'; ++at) {
        std::string other = text;
        other[at] ^= 1;
        EXPECT_NE(why_refused(other), "") << other.substr(header, at - header + 1);
    }
}

TEST(Recording, with_other_notes_and_line_ends_of_another_system_it_is_whole) {
    const ScratchFolder folder;
    const std::string text = written(random_events(40), folder / "r.csv");
    std::string noted = text;
    noted.insert(first_row(text), "# a note\n\n");
    EXPECT_EQ(why_refused(noted), "");
    std::string windows;
    for (const char c : text) windows += c == '\n' ? std::string("\r\n") : std::string(1, c);
    EXPECT_EQ(why_refused(windows), "");
}

TEST(Recording, one_of_format_1_is_read_and_says_that_it_has_no_checksums) {
    const ScratchFolder folder;
    const std::string text = written(random_events(100), folder / "r.csv");
    const std::string old = as_format_1(text);
    io::RecordingReader now(text, "r.csv");
    EXPECT_TRUE(now.has_checksums());
    io::RecordingReader reader(old, "old.csv");
    EXPECT_FALSE(reader.has_checksums());
    EXPECT_EQ(read_all(reader).size(), 100U);
    EXPECT_TRUE(reader.complete());
    // The count in its last line is all that tells.
    const std::size_t row = old.find("\n0.", first_row(old)) + 1;
    std::string fewer = old;
    fewer.erase(row, old.find('\n', row) + 1 - row);
    EXPECT_TRUE(contains(why_refused(fewer), "ticks were recorded, there are"));
    fewer.erase(fewer.find("# end "));
    EXPECT_EQ(why_refused(fewer), "");
}

TEST(Recording, of_a_budget_that_counted_tetrahedra_each_of_them_may_take_as_much_work_as_it_did) {
    const ScratchFolder folder;
    std::string text = as_format_1(written(random_events(3), folder / "r.csv"));
    EXPECT_EQ(io::RecordingReader(text, "now.csv").head().settings.proxy.step_budget, 777);
    const std::string counted = "#  \"budget\": \"work\",\n";
    ASSERT_TRUE(contains(text, counted));
    text.erase(text.find(counted), counted.size());
    EXPECT_EQ(io::RecordingReader(text, "old.csv").head().settings.proxy.step_budget, 64 * 777);
}

TEST(Recording, never_replaces_a_file) {
    const ScratchFolder folder;
    std::ofstream(folder / "precious.csv") << "data";
    EXPECT_THROW(io::RecordingWriter(folder / "precious.csv", some_head()), io::OutputError);
    EXPECT_EQ(bytes_of(folder / "precious.csv"), "data");
    EXPECT_THROW(io::RecordingWriter(folder / "no" / "such" / "folder.csv", some_head()),
                 io::OutputError);
}

TEST(Recording, a_full_device_stops_it_with_a_reason_and_holds_nobody_up) {
    EXPECT_THROW(io::RecordingWriter("/dev/full", some_head()), io::OutputError);
}

// The thread sanitizer does not follow a fork into new threads.
#ifndef __SANITIZE_THREAD__
/// Runs in a child process and waits for its end.
template <class F>
int in_child(F&& work) {
    const pid_t child = ::fork();
    if (child == 0) {
        work();
        ::_exit(0);
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    return status;
}

TEST(Recording, when_the_disk_is_full_what_was_recorded_stays_in_whole_lines) {
    const ScratchFolder folder;
    const int status = in_child([&] {
        std::signal(SIGXFSZ, SIG_IGN);
        const rlimit most{100'000, 100'000};
        ::setrlimit(RLIMIT_FSIZE, &most);
        io::RecordingWriter writer(folder / "r.csv", some_head(), Pace::by_steps);
        Random random(1);
        for (int i = 0; i < 2000; ++i) {
            EXPECT_TRUE(writer.queue().push(random_tick(random, i * 1e-3)));
            if (i % 100 == 0) writer.step();
        }
        try {
            writer.finish(0);
        } catch (const io::OutputError& e) {
            ::_exit(std::string(e.what()).find("recording stopped") != std::string::npos ? 7 : 8);
        }
    });
    ASSERT_TRUE(WIFEXITED(status));
    ASSERT_EQ(WEXITSTATUS(status), 7);
    const std::string text = bytes_of(folder / "r.csv");
    EXPECT_GT(text.size(), 20'000U);
    EXPECT_EQ(text.back(), '\n');
    io::RecordingReader reader(folder / "r.csv");
    EXPECT_GT(read_all(reader).size(), 30U);
    EXPECT_FALSE(reader.complete());
}

TEST(Recording, killed_in_the_middle_it_has_all_up_to_the_last_step) {
    const ScratchFolder folder;
    const int status = in_child([&] {
        io::RecordingWriter writer(folder / "r.csv", some_head(), Pace::by_steps);
        Random random(1);
        for (int i = 0; i < 1000; ++i) writer.queue().push(random_tick(random, i * 1e-3));
        writer.step();
        for (int i = 1000; i < 1500; ++i) writer.queue().push(random_tick(random, i * 1e-3));
        ::kill(::getpid(), SIGKILL);
    });
    ASSERT_TRUE(WIFSIGNALED(status));
    io::RecordingReader reader(folder / "r.csv");
    EXPECT_EQ(read_all(reader).size(), 1000U);
    EXPECT_FALSE(reader.complete());
}

TEST(PacedRecording, is_written_by_itself_while_nobody_asks) {
    const ScratchFolder folder;
    const int status = in_child([&] {
        io::RecordingWriter writer(folder / "r.csv", some_head());
        Random random(1);
        const auto lines = [&] { return std::ranges::count(bytes_of(folder / "r.csv"), '\n'); };
        const auto head = lines();
        for (int i = 0; i < 1000; ++i) writer.queue().push(random_tick(random, i * 1e-3));
        if (!support::comes_true([&] { return lines() >= head + 1000; })) ::_exit(9);
        ::kill(::getpid(), SIGKILL);
    });
    ASSERT_TRUE(WIFSIGNALED(status));
    io::RecordingReader reader(folder / "r.csv");
    EXPECT_EQ(read_all(reader).size(), 1000U);
}
#endif

}  // namespace
