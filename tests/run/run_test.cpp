// Live runs: commands, recordings, other devices and fields, several runs on the same data.
#include "palpate/run/run.hpp"

#include <sys/resource.h>

#include <csignal>
#include <functional>

#include "run/run_support.hpp"
#include "support/scratch_folder.hpp"

namespace palpate::run {
namespace {

using support::ScratchFolder;
using test::steps_until;

std::shared_ptr<Data> ball() {
    return test::stepped_data(test::loaded("synthetic:sphere:32x32x32"));
}

/// A hand that presses from the first moment.
const std::string pressing = "simulated:hand=hold,depth=5,seconds=60";

struct BallRun {
    Run live;

    explicit BallRun(const std::string& device = "mouse", std::shared_ptr<Data> data = ball())
        : live(std::move(data), test::with_device(device)) {
        live.start();
    }
};

/// So many ticks from now on; false where the device fails.
bool ticks_go_on(Run& live, int count = 20) {
    test::step(live, count);
    EXPECT_EQ(live.device_problem(), "");
    return live.device_failure() == DeviceFailure::none;
}

TEST(Run, commands_show_in_settings_and_snapshots) {
    BallRun s;
    ASSERT_NE(s.live.mouse(), nullptr);
    ForceSettings force = s.live.settings().force;
    force.stiffness = 0.25;
    s.live.send(force);
    s.live.send(command::Isovalue{60});
    s.live.send(command::Forces{false});
    s.live.send(command::Freeze{true});
    EXPECT_EQ(s.live.settings().force.stiffness, 0.25);
    EXPECT_EQ(s.live.isovalue(), 60);
    EXPECT_FALSE(s.live.settings().forces_on);
    EXPECT_TRUE(s.live.frozen());
    EXPECT_TRUE(steps_until(s.live, [&] {
        const auto now = s.live.snapshot();
        return now && now->stiffness == 0.25 && now->session.tick.proxy.isovalue == 60 &&
               !now->forces_on && now->session.frozen;
    }));
}

TEST(Run, a_command_that_cannot_be_carried_out_changes_nothing) {
    BallRun s;
    ForceSettings force = s.live.settings().force;
    const double before = force.stiffness;
    force.stiffness = 1e6;
    EXPECT_THROW(s.live.send(force), std::invalid_argument);
    EXPECT_THROW(s.live.send(command::Isovalue{std::nan("")}), std::invalid_argument);
    EXPECT_EQ(s.live.settings().force.stiffness, before);
    EXPECT_TRUE(std::isfinite(s.live.isovalue()));
    EXPECT_TRUE(ticks_go_on(s.live));
}

TEST(Run, what_only_a_point_feels_and_a_tool_exclude_each_other_and_recordings_go_on) {
    ScratchFolder scratch;
    BallRun s;
    const auto tool = std::make_shared<const Tool>(sphere_tool(2, 0.5));
    const Penetrability soft = penetrability_threshold(1, 30, s.live.field().solid());
    s.live.send(soft);
    EXPECT_THROW(s.live.send(command::UseTool{tool}), std::invalid_argument);
    s.live.send(no_penetrability());
    s.live.send(command::UseTool{tool});
    EXPECT_THROW(s.live.send(soft), std::invalid_argument);
    EXPECT_EQ(s.live.settings().tool, tool);
    s.live.record(scratch / "tool.rec");  // with the settings of the moment
    EXPECT_TRUE(ticks_go_on(s.live));
    EXPECT_GT(s.live.stop_recording(), 0);
    s.live.send(command::UseTool{nullptr});
    EXPECT_NO_THROW(s.live.send(soft));
    EXPECT_TRUE(ticks_go_on(s.live));
}

TEST(Run, the_mouse_moves_the_hand) {
    BallRun s;
    s.live.mouse()->aim({10, 20, 30});
    EXPECT_TRUE(steps_until(s.live, [&] {
        const auto now = s.live.snapshot();
        return now && (now->session.device.position - Vec3(10, 20, 30)).norm() < 0.1;
    }));
}

/// Renders a recording again and counts its ticks; a failure where one differs.
struct Again {
    std::int64_t ticks = 0, commands = 0, pressed = 0;
    bool complete = false;
    std::vector<SessionTick> all;

    explicit Again(const std::filesystem::path& path) {
        io::RecordingReader reader(path);
        const auto loaded = load(recorded_source(reader.head(), path));
        Session session = recorded_session(reader.head(), loaded, path.string());
        while (const auto event = reader.next()) {
            if (const auto* command = std::get_if<Command>(&*event)) {
                apply(session, *command);
                ++commands;
                continue;
            }
            const auto& recorded = std::get<SessionTick>(*event);
            const SessionTick again = repeat(session, recorded);
            EXPECT_EQ(again.tick.force, recorded.tick.force) << "tick " << ticks;
            EXPECT_EQ(again.tick.proxy.scp, recorded.tick.proxy.scp) << "tick " << ticks;
            EXPECT_EQ(again.tick.proxy.isovalue, recorded.tick.proxy.isovalue);
            if (recorded.tick.force.norm() > 0.05) ++pressed;
            all.push_back(recorded);
            ++ticks;
        }
        complete = reader.complete();
    }
};

TEST(Run, a_recording_with_commands_comes_out_the_same_bit_for_bit) {
    const ScratchFolder folder;
    BallRun s(pressing);
    s.live.record(folder / "a.csv");
    ASSERT_TRUE(ticks_go_on(s.live, 300));
    s.live.send(command::Isovalue{70});
    s.live.send(penetrability_threshold(0.5, 50));
    ASSERT_TRUE(ticks_go_on(s.live, 100));
    const std::int64_t ticks = s.live.stop_recording();
    EXPECT_EQ(s.live.recording(), nullptr);
    const Again again(folder / "a.csv");
    EXPECT_TRUE(again.complete);
    EXPECT_EQ(again.ticks, ticks);
    EXPECT_GE(again.ticks, 400);
    EXPECT_EQ(again.commands, 6);  // with the four of the start
    EXPECT_GT(again.pressed, 10);
    EXPECT_TRUE(ticks_go_on(s.live));
}

TEST(Run, what_was_asked_for_just_before_a_restart_is_not_lost) {
    const ScratchFolder folder;
    BallRun s;
    ASSERT_TRUE(ticks_go_on(s.live));
    DeviceTransform moved = s.live.settings().transform;
    for (int i = 0; i < 10; ++i) {
        const double level = 60 + 0.1 * i;
        moved.translation = Vec3(i, 2 * i, 0);
        s.live.send(command::Isovalue{level});
        s.live.send(moved);
        if (i % 2 == 0) {
            s.live.record(folder / (std::to_string(i) + ".csv"));
            EXPECT_EQ(Again(folder / (std::to_string(i) + ".csv")).commands, 0);
        } else {
            s.live.use_field(i % 4 == 1 ? Solid::below : Solid::above,
                             i % 8 < 4 ? Interpolation::cubic : Interpolation::linear);
        }
        EXPECT_EQ(s.live.isovalue(), level);
        EXPECT_EQ(s.live.settings().transform.translation, moved.translation);
        ASSERT_TRUE(ticks_go_on(s.live, 3));
        EXPECT_EQ(s.live.snapshot()->session.tick.proxy.isovalue, level);
        EXPECT_EQ(s.live.snapshot()->session.transform.translation, moved.translation);
    }
}

TEST(Run, a_level_that_was_pressed_to_stays_at_a_restart) {
    BallRun s(pressing);
    s.live.send(penetrability_threshold(0.2, s.live.isovalue()));
    ASSERT_TRUE(steps_until(s.live, [&] {
        const auto now = s.live.snapshot();
        return now && now->session.tick.proxy.isovalue > s.live.isovalue() + 2;
    }));
    s.live.send(no_penetrability());
    ASSERT_TRUE(ticks_go_on(s.live));
    const double felt = s.live.snapshot()->session.tick.proxy.isovalue;
    s.live.use_field(Solid::above, Interpolation::linear);
    EXPECT_EQ(s.live.isovalue(), felt);
}

TEST(Run, a_recording_is_complete_when_the_session_ends) {
    const ScratchFolder folder;
    {
        BallRun s(pressing);
        s.live.record(folder / "a.csv");
        ASSERT_TRUE(ticks_go_on(s.live, 50));
    }
    const Again again(folder / "a.csv");
    EXPECT_TRUE(again.complete);
    EXPECT_GE(again.ticks, 50);
}

TEST(Run, recording_to_a_file_that_is_there_changes_nothing) {
    const ScratchFolder folder;
    support::put_bytes(folder / "mine.csv", "mine");
    BallRun s;
    s.live.record(folder / "a.csv");
    ASSERT_TRUE(ticks_go_on(s.live, 20));
    const std::int64_t before = s.live.snapshot()->number;
    EXPECT_THROW(s.live.record(folder / "mine.csv"), io::OutputError);
    EXPECT_THROW(s.live.record(folder / "a.csv"), io::OutputError);
    EXPECT_THROW(s.live.record("/dev/full"), io::OutputError);
    EXPECT_THROW(s.live.record(folder / "no" / "folder.csv"), io::OutputError);
    EXPECT_EQ(support::bytes_of(folder / "mine.csv"), "mine");
    ASSERT_NE(s.live.recording(), nullptr);
    ASSERT_TRUE(ticks_go_on(s.live));
    EXPECT_GT(s.live.snapshot()->number, before);  // not started anew
    s.live.record(folder / "b.csv");
    EXPECT_TRUE(Again(folder / "a.csv").complete);
    EXPECT_EQ(folder.names(), (std::vector<std::string>{"a.csv", "b.csv", "mine.csv"}));
}

/// No file of this process may grow beyond so many bytes.
class SmallDisk {
  public:
    explicit SmallDisk(rlim_t bytes) {
        handler_ = std::signal(SIGXFSZ, SIG_IGN);
        getrlimit(RLIMIT_FSIZE, &before_);
        const rlimit small{bytes, before_.rlim_max};
        setrlimit(RLIMIT_FSIZE, &small);
    }
    ~SmallDisk() {
        setrlimit(RLIMIT_FSIZE, &before_);
        std::signal(SIGXFSZ, handler_);
    }

  private:
    rlimit before_{};
    void (*handler_)(int) = nullptr;
};

TEST(Run, when_the_disk_is_full_the_session_goes_on_and_says_so_at_the_end) {
    const ScratchFolder folder;
    BallRun s(pressing);
    std::string problem;
    {
        const SmallDisk disk(30'000);
        s.live.record(folder / "a.csv");
        ASSERT_TRUE(steps_until(s.live, [&] { return !s.live.recording()->problem().empty(); }));
        EXPECT_TRUE(ticks_go_on(s.live));
        problem = support::message_of<io::OutputError>([&] { s.live.stop_recording(); });
    }
    EXPECT_TRUE(support::contains(problem, "a.csv")) << problem;
    EXPECT_EQ(s.live.recording(), nullptr);
    EXPECT_TRUE(ticks_go_on(s.live));
    const Again again(folder / "a.csv");
    EXPECT_FALSE(again.complete);
    EXPECT_GT(again.ticks, 5);
}

TEST(Run, another_device_goes_on_with_what_was_asked_for) {
    BallRun s("mouse");
    ForceSettings force = s.live.settings().force;
    force.stiffness = 0.2;
    force.viscosity = 1e-4;
    s.live.send(force);
    s.live.send(command::Isovalue{65.5});
    s.live.send(Friction{0.4, 0.3});
    s.live.use_device(devices::parse_device(pressing));
    EXPECT_EQ(s.live.mouse(), nullptr);
    EXPECT_EQ(s.live.device().name, "simulated");
    const auto as_asked = [&] {
        EXPECT_EQ(s.live.isovalue(), 65.5);
        EXPECT_EQ(s.live.settings().force.stiffness, 0.2);
        EXPECT_EQ(s.live.settings().force.viscosity, 1e-4);
        EXPECT_EQ(s.live.settings().proxy.friction.static_coefficient, 0.4);
    };
    as_asked();
    EXPECT_TRUE(steps_until(s.live, [&] {
        const auto now = s.live.snapshot();
        return now && now->session.tick.proxy.mode == Mode::constrained &&
               now->session.tick.proxy.isovalue == 65.5;
    }));
    s.live.use_device(devices::parse_device("mouse"));
    EXPECT_NE(s.live.mouse(), nullptr);
    EXPECT_EQ(s.live.setup().device.name, "mouse");
    as_asked();
    EXPECT_TRUE(ticks_go_on(s.live));
}

TEST(Run, who_stops_the_change_to_another_device_keeps_the_one_there_is) {
    struct Stopped {};
    const OnProgress stop = [](double) { throw Stopped{}; };
    BallRun s("mouse");
    EXPECT_THROW(s.live.use_device(devices::parse_device("simulated"), stop), Stopped);
    EXPECT_NE(s.live.mouse(), nullptr);
    EXPECT_TRUE(ticks_go_on(s.live));
    EXPECT_THROW(run::Run(s.live.shared_data(), s.live.setup(), stop), Stopped);
}

TEST(Run, a_force_limit_that_was_lowered_stays_low_with_another_device) {
    BallRun s("mouse");
    ForceSettings force = s.live.settings().force;
    force.limit = 0.7;
    s.live.send(force);
    s.live.use_device(devices::parse_device("simulated"));
    EXPECT_EQ(s.live.settings().force.limit, 0.7);
    force.limit = s.live.device().limits.maximum_force;
    s.live.send(force);
    s.live.use_device(devices::parse_device("simulated:profile=omega3"));
    EXPECT_EQ(s.live.settings().force.limit, s.live.device().limits.maximum_force);
    EXPECT_GT(s.live.settings().force.limit, force.limit);
}

TEST(Run, a_device_that_is_refused_leaves_the_old_one_running) {
    const ScratchFolder folder;
    BallRun s("mouse");
    s.live.record(folder / "a.csv");
    ASSERT_TRUE(ticks_go_on(s.live));
    const std::int64_t before = s.live.snapshot()->number;
    EXPECT_THROW(s.live.use_device(devices::parse_device("gloves")), std::invalid_argument);
    EXPECT_THROW(s.live.use_device(devices::parse_device("simulated:grip=iron")),
                 std::invalid_argument);
    EXPECT_ANY_THROW(s.live.use_device(
        devices::parse_device("recorded:file=" + (folder / "none.csv").string())));
    EXPECT_NE(s.live.mouse(), nullptr);
    EXPECT_EQ(s.live.setup().device.name, "mouse");
    EXPECT_NE(s.live.recording(), nullptr);
    ASSERT_TRUE(ticks_go_on(s.live));
    EXPECT_GT(s.live.snapshot()->number, before);
}

TEST(Run, the_other_side_is_solid_when_that_is_asked_for_and_a_hand_by_itself_finds_it) {
    BallRun s(pressing);
    s.live.send(penetrability_threshold(1, s.live.isovalue()));
    s.live.use_field(Solid::below, Interpolation::linear, 200);
    EXPECT_EQ(s.live.field().solid(), Solid::below);
    EXPECT_EQ(s.live.field().background(), 200);
    EXPECT_FALSE(s.live.settings().penetrability.on);
    s.live.use_device(devices::parse_device(pressing));
    EXPECT_EQ(s.live.field().solid(), Solid::below);
    const Field& field = s.live.field();
    ASSERT_TRUE(steps_until(s.live, [&] {
        const auto now = s.live.snapshot();
        return now && now->session.tick.proxy.mode == Mode::constrained;
    }));
    const ProxyUpdate proxy = s.live.snapshot()->session.tick.proxy;
    EXPECT_LE(field.sign() * (value_at(field, proxy.scp) - proxy.isovalue), 1e-6);
}

TEST(Run, a_background_that_is_none_changes_nothing) {
    BallRun s;
    ASSERT_TRUE(ticks_go_on(s.live));
    const std::int64_t before = s.live.snapshot()->number;
    EXPECT_THROW(s.live.use_field(Solid::below, Interpolation::linear, std::nan("")),
                 std::invalid_argument);
    EXPECT_EQ(s.live.field().solid(), Solid::above);
    EXPECT_EQ(s.live.field().interpolation(), Interpolation::cubic);
    ASSERT_TRUE(ticks_go_on(s.live));
    EXPECT_GT(s.live.snapshot()->number, before);
}

TEST(Run, the_end_of_a_recording_does_not_interrupt_the_force) {
    const ScratchFolder folder;
    BallRun s(pressing);
    s.live.record(folder / "a.csv");
    ASSERT_TRUE(steps_until(s.live, [&] {
        const auto now = s.live.snapshot();
        return now && now->session.tick.force.norm() > 0.1;
    }));
    const Snapshot before = *s.live.snapshot();
    EXPECT_EQ(s.live.stop_recording(), before.number + 1);
    s.live.step();
    const Snapshot after = *s.live.snapshot();
    EXPECT_EQ(after.number, before.number + 1);
    EXPECT_GT(after.session.tick.force.norm(), 0.1);
    EXPECT_TRUE(Again(folder / "a.csv").complete);
}

TEST(Run, every_restart_begins_without_force_and_keeps_to_the_limits) {
    BallRun s(pressing);
    ForceSettings force = s.live.settings().force;
    force.limit = 0.8;
    force.start_below = std::numeric_limits<double>::infinity();  // the ramp alone must do it
    s.live.send(force);
    const auto pressed = [&] {
        return steps_until(s.live, [&] {
            const auto now = s.live.snapshot();
            return now && now->session.tick.force.norm() > 0.1;
        });
    };
    for (const Interpolation field : {Interpolation::linear, Interpolation::cubic}) {
        ASSERT_TRUE(pressed());  // so the next begins inside the solid
        s.live.use_field(Solid::above, field);
        Vec3 last = Vec3::Zero();
        double time = -1e-3, most = 0;
        for (int i = 0; i < 250; ++i) {
            s.live.step();
            const SessionTick tick = s.live.snapshot()->session;
            const double dt = tick.tick.time - time;
            const Vec3& now = tick.tick.force;
            EXPECT_LE(now.norm(), 0.8 + 1e-9);
            const bool dropped = now.isZero();
            EXPECT_TRUE(dropped || (now - last).norm() <= force.rate_limit * dt + 1e-9);
            EXPECT_TRUE(i > 0 || dropped);
            most = std::max(most, now.norm());
            last = now;
            time = tick.tick.time;
        }
        EXPECT_GT(most, 0.05);
    }
}

/// The version that a run feels within some ticks.
bool feels(Run& run, std::uint64_t version) {
    return steps_until(run, [&] {
        const auto now = run.snapshot();
        return now && now->session.version == version;
    });
}

TEST(Run, two_runs_on_the_same_data_feel_each_others_edits_and_undo) {
    const auto data = ball();
    BallRun a(pressing, data), b(pressing, data);
    ASSERT_TRUE(ticks_go_on(a.live));
    ASSERT_TRUE(ticks_go_on(b.live));
    a.live.data().editor().apply(edit::Fill{{{5, 5, 5}, {20, 20, 20}}, 0});
    EXPECT_TRUE(feels(a.live, 1));
    EXPECT_TRUE(feels(b.live, 1));
    b.live.data().editor().apply(edit::Fill{{{5, 5, 5}, {9, 9, 9}}, 200});
    EXPECT_TRUE(feels(a.live, 2));
    EXPECT_TRUE(feels(b.live, 2));
    EXPECT_TRUE(b.live.data().editor().undo());
    EXPECT_TRUE(feels(a.live, 1));
    EXPECT_TRUE(feels(b.live, 1));
    EXPECT_EQ(a.live.field_now().shared_samples(), b.live.field_now().shared_samples());
}

TEST(Run, an_edit_reaches_every_run_within_some_ticks) {
    const auto data = ball();
    BallRun a("mouse", data), b("mouse", data);
    ASSERT_TRUE(ticks_go_on(a.live));
    ASSERT_TRUE(ticks_go_on(b.live));
    const ScratchFolder folder;
    a.live.record(folder / "a.csv");
    b.live.record(folder / "b.csv");
    ASSERT_TRUE(ticks_go_on(a.live));
    ASSERT_TRUE(ticks_go_on(b.live));
    data->editor().apply(edit::Fill{{{5, 5, 5}, {20, 20, 20}}, 0});
    const std::int64_t a_sent = a.live.snapshot()->number, b_sent = b.live.snapshot()->number;
    ASSERT_TRUE(ticks_go_on(a.live, 3));
    ASSERT_TRUE(ticks_go_on(b.live, 3));
    (void)a.live.stop_recording();
    (void)b.live.stop_recording();
    // apply() has returned, so the command was in both queues before tick a_sent + 1.
    for (const auto& [name, sent] : {std::pair{"a.csv", a_sent}, std::pair{"b.csv", b_sent}}) {
        io::RecordingReader reader(folder / name);
        std::int64_t number = 0;
        std::optional<std::int64_t> felt;
        while (const auto event = reader.next()) {
            const auto* tick = std::get_if<SessionTick>(&*event);
            if (!tick) continue;
            if (tick->version == 1 && !felt) felt = number;
            ++number;
        }
        ASSERT_TRUE(felt) << name;
        EXPECT_LE(*felt, sent + 2) << name;
    }
}

TEST(Run, a_run_that_starts_on_edited_data_begins_with_the_edits_and_so_does_its_recording) {
    const ScratchFolder folder;
    const auto data = ball();
    BallRun a("mouse", data);
    data->editor().apply(edit::Fill{{{5, 5, 5}, {20, 20, 20}}, 0});
    {
        run::Run b(data, test::with_device(pressing));
        b.record(folder / "b.csv");
        b.start();
        EXPECT_TRUE(feels(b, 1));
        data->editor().apply(edit::Fill{{{5, 5, 5}, {9, 9, 9}}, 200});
        EXPECT_TRUE(feels(b, 2));
    }
    io::RecordingReader reader(folder / "b.csv");
    Replay replay(reader, data->loaded(), "b.csv");
    EXPECT_GT(test::expect_same_again(replay), 0);
    EXPECT_GE(replay.commands(), 2);
    // The run that stays is kept up to date.
    data->editor().undo();
    EXPECT_TRUE(feels(a.live, 1));
}

}  // namespace
}  // namespace palpate::run
