// Live sessions from the command line: touch, record, devices, replay --validate. A simulated hand
// is the device. A session that does not need the clock runs without it (--unpaced).
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "apps/program.hpp"
#include "palpate/io/recording.hpp"
#include "support/recordings.hpp"

namespace palpate::app::test {
namespace {

using support::as_format_1;
using support::bytes_of;
using support::first_row;
using support::put_bytes;

const std::string sphere = "synthetic:sphere:32x32x32";
const std::string unpaced = sphere + " --unpaced";

struct Ticks {
    std::int64_t count = 0, felt = 0, commands = 0;
    double largest_force = 0;
    double last_way = 0, last_device_way = 0;  ///< [mm] of HIP and hand, the last where they moved
    SessionTick last;
};

Ticks ticks_of(const std::filesystem::path& path) {
    io::RecordingReader reader(path);
    Ticks ticks;
    while (const auto event = reader.next()) {
        if (const auto* tick = std::get_if<SessionTick>(&*event)) {
            ++ticks.count;
            ticks.felt += !tick->tick.force.isZero(0);
            ticks.largest_force = std::max(ticks.largest_force, tick->tick.force.norm());
            const double way = (tick->device.position - ticks.last.device.position).norm();
            if (ticks.count > 1 && way > 0.01 && !tick->frozen && !ticks.last.frozen) {
                ticks.last_device_way = way;
                ticks.last_way = (tick->tick.proxy.hip - ticks.last.tick.proxy.hip).norm();
            }
            ticks.last = *tick;
        } else {
            ++ticks.commands;
        }
    }
    EXPECT_TRUE(reader.complete());
    return ticks;
}

TEST(Touch, a_simulated_hand_feels_and_its_recording_replays_bit_for_bit) {
    const ScratchFolder folder;
    const Outcome done = succeeds(
        folder, "touch " + unpaced + " --device simulated:hand=press --seconds 1.5 --record r.csv");
    EXPECT_TRUE(contains(done.out, ", unpaced")) << done.out;
    const Ticks ticks = ticks_of(folder / "r.csv");
    EXPECT_GE(ticks.last.tick.time, 1.5);
    EXPECT_LT(ticks.last.tick.time, 1.51);
    EXPECT_EQ(ticks.count, std::llround(1000 * ticks.last.tick.time) + 1);
    EXPECT_GT(ticks.felt, 50);
    EXPECT_LE(ticks.largest_force, 3.3 + 1e-12);
    const Outcome valid = succeeds(folder, "replay r.csv --validate");
    EXPECT_TRUE(contains(valid.out, "bit for bit")) << valid.out;
    EXPECT_TRUE(contains(valid.out, std::to_string(ticks.count) + " ticks")) << valid.out;
}

TEST(Touch, without_the_clock_the_same_session_gives_the_same_ticks) {
    const ScratchFolder folder;
    put_bytes(folder / "c.txt", "0.1 isovalue 60%\n0.2 brush carve 4 50\n0.5 undo\n");
    for (const std::string file : {"a.csv", "b.csv"}) {
        succeeds(folder, "touch " + unpaced +
                             " --device simulated:hand=press --seconds 0.7 "
                             "--commands c.txt --record " +
                             file);
    }
    const auto table = [&](const std::string& file) {
        const std::string text = bytes_of(folder / file);
        return text.substr(first_row(text));
    };
    EXPECT_GT(table("a.csv").size(), 100'000U);
    EXPECT_TRUE(table("a.csv") == table("b.csv"));
    expect_failure(palpate(folder, "touch " + unpaced + " --device haply"), 2, "--unpaced is for");
}

TEST(PacedTouch, reports_what_the_servo_took_and_what_the_machine) {
    const ScratchFolder folder;
    const std::string line = "touch " + sphere + " --device simulated:hand=tap,seconds=0.5";
    const Outcome done = succeeds(folder, line);
    EXPECT_TRUE(contains(done.out, "compute time (ours)")) << done.out;
    EXPECT_TRUE(contains(done.out, "lateness (the machine)")) << done.out;
    EXPECT_TRUE(contains(done.err, "real-time priority")) << done.err;
    const Outcome quiet = succeeds(folder, line + " --json --quiet");
    EXPECT_EQ(quiet.err, "");
    const auto report = nlohmann::json::parse(quiet.out);
    EXPECT_GT(report["ticks"], 0);
    EXPECT_GE(report["seconds"], 0.45);
    EXPECT_GT(report["compute_ns"]["p50"], 0);
    EXPECT_TRUE(report["worst"]["cause"].is_string());
}

TEST(Touch, starts_when_the_force_is_small_and_bounds_its_work_by_the_rate) {
    const ScratchFolder folder;
    for (const auto& [rate, budget] : {std::pair{1000, 4096}, std::pair{8000, 512}}) {
        const std::string file = std::to_string(rate) + ".csv";
        succeeds(folder, "touch " + unpaced + " --seconds 0.05 --rate " + std::to_string(rate) +
                             " --record " + file);
        const io::RecordingReader reader(folder / file);
        EXPECT_EQ(reader.head().settings.force.start_below, 0.3);
        EXPECT_EQ(reader.head().settings.proxy.step_budget, budget);
        EXPECT_EQ(reader.head().rate, rate);
    }
}

TEST(Touch, says_in_a_line_that_wide_terraces_are_felt_unless_they_are_gone) {
    const ScratchFolder folder;
    const std::string line =
        "touch synthetic:cylinder:100x100x30 --type uint8 --headless "
        "--unpaced --seconds 0.05 --device simulated:hand=tap";
    const std::string said = "try --dequantize: rounding to levels of 1 makes terraces";
    const Outcome told = succeeds(folder, line);
    EXPECT_TRUE(contains(told.err, "palpate: note: synthetic:cylinder")) << told.err;
    EXPECT_TRUE(contains(told.err, said)) << told.err;
    for (const std::string other : {" --dequantize", " --smooth 1", " --quiet"}) {
        const Outcome silent = succeeds(folder, line + other);
        EXPECT_FALSE(contains(silent.err, said)) << silent.err;
    }
    EXPECT_FALSE(contains(palpate(folder, "touch " + unpaced + " --seconds 0.05").err, said));
}

TEST(Touch, ends_when_the_hand_has_finished) {
    const ScratchFolder folder;
    const Outcome done = succeeds(
        folder, "touch " + unpaced + " --device simulated:hand=tap,seconds=0.5 --json --quiet");
    EXPECT_EQ(done.err, "");
    const auto report = nlohmann::json::parse(done.out);
    EXPECT_GT(report["ticks"], 450);
    EXPECT_LT(report["ticks"], 650);
}

TEST(Touch, gives_no_force_to_a_hand_that_is_faster_than_is_plausible) {
    const ScratchFolder folder;
    const std::string press = "touch " + unpaced + " --device simulated:hand=press,seconds=0.5 -q";
    succeeds(folder, press + " --record usual.csv");
    const Outcome slow = succeeds(folder, press + " --record slow.csv --fastest-hand 0.001");
    io::RecordingReader reader(folder / "slow.csv");
    EXPECT_EQ(reader.head().session.fastest_hand, 0.001);
    EXPECT_GT(ticks_of(folder / "usual.csv").felt, 0);
    EXPECT_EQ(ticks_of(folder / "slow.csv").felt, 0);
}

TEST(Touch, carries_out_and_records_commands) {
    const ScratchFolder folder;
    put_bytes(folder / "commands.txt",
              "# what happens\n0.1 isovalue 60%\n0.2 penetrability threshold 0.4\n"
              "0.3 friction 0.4,0.2\n0.4 stiffness 0.25\n0.5 scale 1.5  # about the SCP\n"
              "0.6 freeze on\n0.7 freeze off\n0.75 lift\n0.8 forces off\n1.0 quit\n"
              "9 forces on\n");
    succeeds(folder, "touch " + unpaced + " --commands commands.txt --record r.csv");
    const Ticks ticks = ticks_of(folder / "r.csv");
    EXPECT_EQ(ticks.commands, 9);
    // The transform follows from the commands. The change of the scale follows from the ways of
    // hand and HIP.
    EXPECT_NEAR(ticks.last_way / ticks.last_device_way, 1.5, 1e-6);
    EXPECT_NE(ticks.last.tick.force_flags & force_off, 0);
    succeeds(folder, "replay r.csv --validate");
}

TEST(Touch, carries_out_in_order_all_commands_that_are_due_at_once) {
    const ScratchFolder folder;
    constexpr int count = 20'000;
    std::string text;
    for (int i = 0; i < count; ++i) text += "0.1 isovalue " + std::to_string(60 + i % 7) + "\n";
    put_bytes(folder / "commands.txt", text + "0.1 isovalue 61\n0.1 quit\n");
    const Outcome done = succeeds(folder, "touch " + unpaced +
                                              " --device simulated:hand=press,loop=yes --commands "
                                              "commands.txt --record r.csv");
    const Ticks ticks = ticks_of(folder / "r.csv");
    EXPECT_EQ(ticks.commands, count + 1);
    EXPECT_EQ(ticks.last.tick.proxy.isovalue, 61);
    const std::size_t told = done.err.find("commands are due");
    EXPECT_NE(told, std::string::npos) << done.err;
    EXPECT_EQ(told, done.err.rfind("commands are due")) << done.err;
    EXPECT_FALSE(contains(done.err, "left out")) << done.err;
}

TEST(Touch, counts_the_commands_that_the_end_left_no_time_for_in_one_line) {
    const ScratchFolder folder;
    std::string text;
    for (int i = 0; i < 300'000; ++i) text += "0.1 isovalue 60\n";
    put_bytes(folder / "commands.txt", text);
    const Outcome done = succeeds(
        folder, "touch " + unpaced + " --commands commands.txt --seconds 1 --record r.csv");
    const std::int64_t carried_out = ticks_of(folder / "r.csv").commands;
    EXPECT_GT(carried_out, 1000);
    EXPECT_TRUE(contains(done.err, std::to_string(300'000 - carried_out) +
                                       " commands were not carried out before the end"))
        << done.err;
    EXPECT_LT(std::ranges::count(done.err, '\n'), 10) << done.err;
}

TEST(Touch, takes_commands_with_a_byte_order_mark_and_the_line_ends_of_windows) {
    const ScratchFolder folder;
    put_bytes(folder / "c.txt",
              "\xEF\xBB\xBF"
              "0 freeze on\r\n0.1 quit\r\n");
    succeeds(folder, "touch " + unpaced + " --commands c.txt");
}

TEST(Touch, takes_names_with_blanks_in_quotes) {
    const ScratchFolder folder;
    put_bytes(folder / "c.txt",
              "0 carve 0,0,0 2\n0.1 save \"my #1 head.nrrd\"  # with a blank\n0.2 quit\n");
    succeeds(folder, "touch " + unpaced + " --commands c.txt");
    EXPECT_TRUE(std::filesystem::exists(folder / "my #1 head.nrrd"));
    put_bytes(folder / "c.txt", "0 save \"my head.nrrd\n");
    expect_failure(palpate(folder, "touch " + unpaced + " --commands c.txt"), 3,
                   "without another one after it");
}

TEST(Touch, refuses_commands_that_it_does_not_understand_before_anything_runs) {
    const ScratchFolder folder;
    const auto refused = [&](const std::string& text, const std::string& reason) {
        put_bytes(folder / "c.txt", text);
        expect_failure(palpate(folder, "touch " + sphere + " --commands c.txt --record r.csv"), 3,
                       reason);
        EXPECT_FALSE(std::filesystem::exists(folder / "r.csv"));
    };
    refused("0 dance\n", "c.txt, line 1: there is no command 'dance'");
    refused("\n1 freeze\n", "c.txt, line 2: expected: freeze on|off");
    refused("0 lift off\n", "c.txt, line 1: expected: lift, without a value");
    refused("0 carve nan,0,0 5\n", "c.txt, line 1: expected: carve X,Y,Z");
    refused("soon freeze on\n", "is no time");
    refused("2 freeze on\n1 freeze off\n", "the time goes back");
    refused("0 stiffness 1000\n", "to be rendered stably");
    refused("0 scale 0\n", "scale = 0: must be from 1e-30 to 1e30");
    refused("0 penetrability ranges 1 5:3\n", "low <= high");
    refused("0 isovalue much\n", "'much'");
}

TEST(Touch, lets_go_and_completes_the_recording_when_interrupted) {
    for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT}) {
        const ScratchFolder folder;
        Running running(words_of("record " + sphere + " -o r.csv"), folder.path());
        const auto begun = [&] {
            return std::filesystem::exists(folder / "r.csv") &&
                   bytes_of(folder / "r.csv").size() > 20'000;
        };
        EXPECT_TRUE(comes_true(begun));
        const Outcome stopped = running.finish(signal);
        EXPECT_EQ(stopped.status, 128 + signal) << stopped.err;
        EXPECT_TRUE(contains(stopped.err, "interrupted"));
        EXPECT_GT(ticks_of(folder / "r.csv").count, 10);
        EXPECT_FALSE(running.left_a_process());
    }
}

TEST(Touch, leaves_a_recording_that_replays_up_to_its_end_when_killed) {
    const ScratchFolder folder;
    Running running(words_of("record " + sphere + " -o r.csv"), folder.path());
    EXPECT_TRUE(comes_true([&] {
        return std::filesystem::exists(folder / "r.csv") &&
               bytes_of(folder / "r.csv").size() > 60'000;
    }));
    EXPECT_EQ(running.finish(SIGKILL).status, 1000 + SIGKILL);
    const Outcome valid = succeeds(folder, "replay r.csv --validate");
    EXPECT_TRUE(contains(valid.out, "cut off before its end")) << valid.out;
}

TEST(Touch, a_recording_serves_as_a_device) {
    const ScratchFolder folder;
    ASSERT_EQ(palpate(folder, "touch " + unpaced +
                                  " --device simulated:hand=press --seconds 1 --record r.csv")
                  .status,
              0);
    const Outcome again =
        succeeds(folder, "touch " + unpaced + " --device recorded:r.csv --record again.csv");
    EXPECT_GT(ticks_of(folder / "again.csv").felt, 20);
    succeeds(folder, "replay again.csv --validate");
    succeeds(folder, "replay " + sphere + " --trajectory r.csv -o t.csv");
}

TEST(Touch, refuses_options_that_make_no_sense) {
    const ScratchFolder folder;
    const auto wrong = [&](const std::string& options, const std::string& reason) {
        expect_failure(palpate(folder, "touch " + sphere + " " + options), 2, reason);
    };
    wrong("--device nothing", "use one of simulated");
    wrong("--device simulated:profile=magic", "magic");
    wrong("--device simulated:colour=red", "no option 'colour'");
    wrong("--rate 100", "250 to 8000 Hz");
    wrong("--facing up", "up");
    wrong("--clutch x", "--clutch: a button is a number from 1 to 32, none or auto, not 'x'");
    wrong("--dead-man 1", "the device has 0 buttons");
    wrong("--fastest-hand 0", "fastest hand [device mm/s] = 0: must be above 0");
    wrong("--overrun -1", "overrun [s] = -1: must be above 0");
    wrong("--seconds -1", "-1");
    wrong("--seconds nan", "'nan' is not a number");
    wrong("--seconds inf", "inf");
    wrong("--playback -NaN", "'-NaN' is not a number");
    wrong("--stiffness 90", "to be rendered stably");
    expect_failure(palpate(folder, "touch none.nrrd"), 3, "none.nrrd");
    expect_failure(palpate(folder, "touch " + sphere + " --commands none.txt"), 3, "none.txt");
    EXPECT_TRUE(folder.names().empty());
}

TEST(Touch, says_in_one_line_what_to_do_where_the_device_is_missing) {
    const ScratchFolder folder;
    expect_failure(palpate(folder, "touch " + sphere + " --device haply:port=1"), 4, ":1 ");
    expect_failure(palpate(folder, "touch " + sphere + " --device openhaptics:library=none.so"), 4,
                   "none.so");
    expect_failure(palpate(folder, "touch " + sphere + " --device spacenav:socket=none.sock"), 4,
                   "none.sock");
    expect_failure(palpate(folder, "touch " + sphere + " --device recorded:none.csv"), 3,
                   "none.csv");
}

TEST(Touch, a_recording_never_replaces_a_file) {
    const ScratchFolder folder;
    put_bytes(folder / "r.csv", "precious");
    expect_failure(palpate(folder, "touch " + sphere + " --record r.csv"), 5, "r.csv: exists");
    EXPECT_EQ(bytes_of(folder / "r.csv"), "precious");
}

TEST(Devices, lists_each_device_with_what_was_found_or_what_is_missing) {
    const ScratchFolder folder;
    const Outcome list = succeeds(folder, "devices --json");
    std::vector<std::string> names;
    for (const auto& device : nlohmann::json::parse(list.out)) {
        names.push_back(device["name"]);
        EXPECT_FALSE(device[device["found"] ? "what" : "missing"].get<std::string>().empty());
        EXPECT_FALSE(device["options"].get<std::string>().empty());
    }
    EXPECT_EQ(names,
              (std::vector<std::string>{"simulated", "recorded", "mouse", "haply", "openhaptics",
                                        "forcedimension", "falcon", "spacenav"}));
    const Outcome text = palpate(folder, "devices");
    for (const std::string& name : names) EXPECT_TRUE(contains(text.out, name));
}

/// A short recording, to be changed.
struct Recorded {
    ScratchFolder folder;
    std::string text;

    Recorded() {
        EXPECT_EQ(palpate(folder, "touch " + unpaced +
                                      " --device simulated:hand=press --seconds 0.6 --record r.csv")
                      .status,
                  0);
        text = bytes_of(folder / "r.csv");
    }
    Outcome validate_with(const std::string& from, const std::string& to, std::size_t after = 0) {
        std::string changed = text;
        const auto at = changed.find(from, after);
        EXPECT_NE(at, std::string::npos) << from;
        changed.replace(at, from.size(), to);
        put_bytes(folder / "changed.csv", changed);
        return palpate(folder, "replay changed.csv --validate");
    }
};

TEST(Validate, names_the_tick_that_differs) {
    Recorded recorded;
    const auto line = recorded.text.find("\n0.2");  // some tick after 0.2 s
    const auto stiffer = recorded.validate_with("\"stiffness\": 0.5", "\"stiffness\": 0.6");
    EXPECT_EQ(stiffer.status, 3);
    EXPECT_TRUE(is_one_line(stiffer.err)) << stiffer.err;
    EXPECT_TRUE(contains(stiffer.err, "differs: force")) << stiffer.err;
    const auto moved = recorded.validate_with(",free,", ",constrained,", line);
    EXPECT_EQ(moved.status, 3);
    EXPECT_TRUE(contains(moved.err, "since it was recorded")) << moved.err;
    recorded.text = as_format_1(recorded.text);
    const auto older = recorded.validate_with(",free,", ",constrained,", first_row(recorded.text));
    EXPECT_EQ(older.status, 3);
    EXPECT_TRUE(contains(older.err, "differs: mode")) << older.err;
    EXPECT_TRUE(contains(older.err, "tick ")) << older.err;
}

TEST(Validate, notices_each_tick_that_is_missing) {
    Recorded recorded;
    const std::string original = recorded.text;
    std::size_t row = first_row(original);
    for (int removed = 0; removed < 5; ++removed) {
        for (int i = 0; i < 100; ++i) row = original.find('\n', row) + 1;
        recorded.text = original;
        recorded.text.erase(row, original.find('\n', row) + 1 - row);
        const auto valid = recorded.validate_with("\"lost\":0", "\"lost\":0");
        EXPECT_EQ(valid.status, 3) << valid.out;
        EXPECT_TRUE(contains(valid.err, "is expected, there is tick")) << valid.err;
        EXPECT_TRUE(is_one_line(valid.err)) << valid.err;
    }
}

TEST(Validate, says_what_an_old_recording_and_one_that_was_cut_off_cannot_tell) {
    Recorded recorded;
    const std::string original = recorded.text;
    const auto whole = palpate(recorded.folder, "replay r.csv --validate");
    EXPECT_EQ(whole.status, 0);
    EXPECT_FALSE(contains(whole.out, "cut off"));
    EXPECT_FALSE(contains(whole.out, "cannot be known"));
    recorded.text = as_format_1(original);
    const auto old = recorded.validate_with("recording 1", "recording 1");
    EXPECT_EQ(old.status, 0) << old.err;
    EXPECT_TRUE(contains(old.out, "the same bit for bit"));
    EXPECT_TRUE(contains(old.out, "cannot be known")) << old.out;
    recorded.text = original.substr(0, original.size() / 2);
    const auto cut = recorded.validate_with("recording 6", "recording 6");
    EXPECT_EQ(cut.status, 0) << cut.err;
    EXPECT_TRUE(contains(cut.out, "cut off before its end")) << cut.out;
}

TEST(Validate, a_device_that_sent_implausible_readings_replays_bit_for_bit) {
    const ScratchFolder folder;
    put_bytes(folder / "device.csv",
              "t,device_x,device_y,device_z\n0,70,0,0\n0.2,20,0,0\n0.3,nan,0,inf\n0.4,20,0,0\n"
              "0.6,20,1,0\n");
    EXPECT_EQ(
        palpate(folder, "touch " + unpaced + " --device recorded:device.csv --record r.csv").status,
        0);
    EXPECT_TRUE(contains(bytes_of(folder / "r.csv"), "nan"));
    succeeds(folder, "replay r.csv --validate");
}

TEST(Validate, reports_events_that_the_recording_lost) {
    Recorded recorded;
    recorded.text.replace(recorded.text.find("\"lost\":0"), 8, "\"lost\":7");
    const auto differs = recorded.validate_with("\"stiffness\": 0.5", "\"stiffness\": 0.6");
    EXPECT_EQ(differs.status, 3);
    EXPECT_TRUE(contains(differs.err, "lost 7 events")) << differs.err;
    EXPECT_TRUE(is_one_line(differs.err)) << differs.err;
}

TEST(Validate, refuses_another_volume_and_accepts_the_right_one_from_elsewhere) {
    Recorded recorded;
    const Words words{"replay", "r.csv", "--validate", "--volume"};
    expect_failure(palpate(recorded.folder, words + Words{"synthetic:torus:32x32x32"}), 3,
                   "is not the volume of the recording");
    succeeds(recorded.folder, words + Words{sphere});
    expect_failure(recorded.validate_with(sphere, "gone.nrrd"), 3, "gone.nrrd");
    expect_failure(recorded.validate_with("\"exact\"", "\"magic\""), 3, "magic");
    expect_failure(recorded.validate_with("\"limit\": 3.3", "\"limit\": -1"), 3,
                   "cannot be rendered");
}

TEST(Validate, refuses_outputs_and_anything_but_recordings) {
    const MotionFolder folder;
    expect_failure(palpate(folder, "replay t.csv --validate"), 3, "is no recording");
    for (const std::string options : {"-o x.csv", "--json", "--stiffness 3", "--path p.csv"}) {
        expect_failure(palpate(folder, "replay t.csv --validate " + options), 2,
                       "does nothing with --validate");
    }
    expect_failure(palpate(folder, "replay " + sphere + " --trajectory t.csv -o x --volume v"), 2,
                   "--volume is for --validate");
    expect_failure(palpate(folder, "replay " + sphere + " -o x.csv"), 2, "--trajectory");
    expect_failure(palpate(folder, "replay " + sphere + " --trajectory t.csv"), 2, "--output");
}

}  // namespace
}  // namespace palpate::app::test
