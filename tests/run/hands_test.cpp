// Several hands in one session: runs on the same data, and one recording of all of them.
#include <array>
#include <chrono>
#include <thread>

#include "palpate/io/volume_file.hpp"
#include "palpate/scenes/volumes.hpp"
#include "run/run_support.hpp"
#include "support/recordings.hpp"
#include "support/scratch_folder.hpp"

namespace palpate::run {
namespace {

using support::ScratchFolder;
using test::steps_until;

std::shared_ptr<Data> shared_ball() {
    return test::stepped_data(test::loaded("synthetic:sphere:32x32x32"));
}

/// Hands that press at once, in different ways.
const std::string holding = "simulated:hand=hold,depth=5,seconds=60";
const std::string circling = "simulated:omega6,hand=circle,depth=3,seconds=60";

std::vector<SessionTick> ticks_of(const std::filesystem::path& path, int hand = 1) {
    io::RecordingReader reader(path, hand);
    std::vector<SessionTick> ticks;
    while (const auto event = reader.next()) {
        if (const auto* tick = std::get_if<SessionTick>(&*event)) ticks.push_back(*tick);
    }
    EXPECT_TRUE(reader.complete());
    return ticks;
}

std::int64_t with_force(const std::vector<SessionTick>& ticks) {
    return std::ranges::count_if(ticks,
                                 [](const auto& tick) { return tick.tick.force.norm() > 0.05; });
}

void expect_the_same(const std::vector<SessionTick>& ticks, const std::vector<SessionTick>& alone) {
    ASSERT_GE(alone.size(), ticks.size());
    for (std::size_t i = 0; i < ticks.size(); ++i) {
        const auto differs = difference(alone[i], ticks[i]);
        ASSERT_FALSE(differs) << "tick " << i << ": " << differs->part << ": " << differs->recorded
                              << ", " << differs->again;
    }
}

/// The ticks of a hand alone.
std::vector<SessionTick> alone(const std::string& device, int ticks,
                               const std::filesystem::path& path) {
    run::Run run(shared_ball(), test::with_device(device));
    run.record(path);
    run.start();
    test::step(run, ticks);
    EXPECT_EQ(run.stop_recording(), ticks);
    return ticks_of(path);
}

void expect_replays(const std::filesystem::path& path, const Data& data, int hand) {
    io::RecordingReader reader(path, hand);
    Replay replay(reader, data.loaded(), path.string());
    EXPECT_GT(test::expect_same_again(replay), 0) << "hand " << hand;
}

TEST(Hands, each_feels_bit_for_bit_what_it_feels_alone_and_one_recording_has_both) {
    const ScratchFolder folder;
    const auto first = alone(holding, 600, folder / "first.csv");
    const auto second = alone(circling, 600, folder / "second.csv");
    EXPECT_GT(with_force(first), 100);
    EXPECT_GT(with_force(second), 100);

    const auto data = shared_ball();
    run::Run a(data, test::with_device(holding)), b(data, test::with_device(circling));
    run::Run::record_together(std::array{&a, &b}, folder / "both.csv");
    a.start();
    b.start();
    for (int i = 0; i < 600; ++i) {
        a.step();
        if (i % 2 == 0) test::step(b, 2);  // in any order
    }
    EXPECT_EQ(a.stop_recording(), 600);
    a.step();  // is not recorded any more
    EXPECT_EQ(b.stop_recording(), 600);
    expect_the_same(ticks_of(folder / "both.csv", 1), first);
    expect_the_same(ticks_of(folder / "both.csv", 2), second);
    expect_replays(folder / "both.csv", *data, 1);
    expect_replays(folder / "both.csv", *data, 2);
}

TEST(Hands, that_were_recorded_play_again_together_as_each_alone) {
    const ScratchFolder folder;
    {
        const auto data = shared_ball();
        run::Run a(data, test::with_device(holding)), b(data, test::with_device(circling));
        run::Run::record_together(std::array{&a, &b}, folder / "both.csv");
        a.start();
        b.start();
        test::step(a, 600);
        test::step(b, 600);
    }
    const std::string both = "recorded:" + (folder / "both.csv").string();
    const auto first = alone(both, 600, folder / "first.csv");
    const auto second = alone(both + ",hand=2", 600, folder / "second.csv");
    EXPECT_NE(first.back().device.position, second.back().device.position);
    EXPECT_GT(with_force(first), 100);
    EXPECT_GT(with_force(second), 100);

    const auto data = shared_ball();
    run::Run a(data, test::with_device(both)), b(data, test::with_device(both + ",hand=2"));
    run::Run::record_together(std::array{&a, &b}, folder / "again.csv");
    a.start();
    b.start();
    test::step(b, 600);
    test::step(a, 600);
    a.stop_recording();
    b.stop_recording();
    expect_the_same(ticks_of(folder / "again.csv", 1), first);
    expect_the_same(ticks_of(folder / "again.csv", 2), second);
    EXPECT_THROW(run::Run(data, test::with_device(both + ",hand=3")), io::InputError);
}

TEST(Hands, play_their_sequence_together_by_a_command_to_one_of_them) {
    const auto data = test::stepped_data(test::loaded("synthetic:beating:24x24x24"));
    run::Run first(data, test::with_device(holding)), second(data, test::with_device(circling));
    first.start();
    second.start();
    const auto both_reach = [&](auto&& holds) {
        const auto step = [&] {
            first.step();
            second.step();
        };
        return steps_until(
            step, [&] { return data->is_settled(); },
            [&] {
                const auto now = first.snapshot(), other = second.snapshot();
                return now && other && holds(*now) && holds(*other);
            });
    };
    first.send(command::Speed{-2});
    EXPECT_EQ(data->player().state().speed, -2);
    EXPECT_TRUE(both_reach([](const Snapshot& now) { return now.speed == -2; }));
    first.send(command::Speed{0});
    first.send(command::Moment{0.25});
    EXPECT_TRUE(both_reach([&](const Snapshot& now) {
        return now.session.moment == 0.25 && data->player().state().time == 0.25;
    }));
}

TEST(Hands, on_a_volume_refuse_commands_for_a_sequence) {
    run::Run run(shared_ball(), test::with_device(holding));
    run.start();
    EXPECT_THROW(run.send(command::Speed{1}), std::invalid_argument);
    EXPECT_THROW(run.send(command::Moment{1}), std::invalid_argument);
}

TEST(Hands, one_whose_device_fails_ends_alone) {
    const ScratchFolder folder;
    const auto undisturbed = alone(circling, 900, folder / "alone.csv");
    const auto data = shared_ball();
    bool fails = false;
    run::Run a(data, test::with_failing(holding, fails)), b(data, test::with_device(circling));
    run::Run::record_together(std::array{&a, &b}, folder / "both.csv");
    a.start();
    b.start();
    test::step(a, 500);
    test::step(b, 500);
    EXPECT_GT(a.snapshot()->session.tick.force.norm(), 0.05);
    fails = true;
    test::step(a, 1);
    EXPECT_EQ(a.device_failure(), DeviceFailure::threw);
    EXPECT_EQ(a.snapshot()->session.tick.force, Vec3(0, 0, 0));
    EXPECT_NE(a.device_problem(), "");
    test::step(b, 400);
    EXPECT_EQ(b.device_problem(), "");
    EXPECT_EQ(a.stop_recording(), 500);
    EXPECT_EQ(b.stop_recording(), 900);
    expect_the_same(ticks_of(folder / "both.csv", 2), undisturbed);
    expect_replays(folder / "both.csv", *data, 1);
}

TEST(Hands, that_go_on_are_edited_and_recorded_although_another_one_failed) {
    const ScratchFolder folder;
    const auto data = shared_ball();
    bool fails = false;
    run::Run a(data, test::with_failing(holding, fails)), b(data, test::with_device(holding));
    a.start();
    b.start();
    test::step(a, 5);
    fails = true;
    test::step(a, 1);
    // More than there is room for in a servo that carries out nothing.
    for (int i = 0; i < 1500; ++i) {
        data->editor().apply(edit::Fill{{{5, 5, 5}, {6, 6, 6}}, double(i % 2)});
        if (i % 10 == 0) test::step(b, 1);
    }
    test::step(b, 3);
    EXPECT_EQ(b.snapshot()->session.version, data->editor().state().version);
    run::Run::record_together(std::array{&a, &b}, folder / "both.csv");
    test::step(b, 100);
    EXPECT_EQ(a.stop_recording(), 0);
    EXPECT_EQ(b.stop_recording(), 100);
    expect_replays(folder / "both.csv", *data, 2);
}

TEST(Hands, feel_what_the_brush_of_the_other_carves_and_their_recording_replays) {
    const ScratchFolder folder;
    const auto data = shared_ball();
    run::Run a(data, test::with_device(holding)), b(data, test::with_device(circling));
    run::Run::record_together(std::array{&a, &b}, folder / "both.csv");
    a.start();
    b.start();
    data->editor().set_brush(HandBrush{.radius = 3});
    for (int i = 0; i < 1500; ++i) {
        a.step();
        b.step();
    }
    EXPECT_GT(a.snapshot()->session.version, 10U);
    a.stop_recording();
    b.stop_recording();
    for (int hand = 1; hand <= 2; ++hand) {
        EXPECT_GT(ticks_of(folder / "both.csv", hand).back().version, 10U);
        expect_replays(folder / "both.csv", *data, hand);
    }
}

TEST(Hands, on_a_store_touch_where_each_reads_feel_one_brush_and_their_recording_replays) {
    const ScratchFolder folder;
    const auto file = folder / "ball.nrrd", recording = folder / "both.csv";
    const Volume ball = scenes::make_volume("sphere:128x126x125").volume;
    io::write_volume(ball, file);
    Source source = source_from({{"volume", file.string()}, {"level", "0"}});
    std::get<StoreSource>(source.from).loader.memory = std::uint64_t{200} << 20;
    const auto data = test::stepped_data(load(source));
    ASSERT_TRUE(data->is_streamed());
    run::Run a(data, test::with_device("simulated:hand=explore,seconds=60"));
    run::Run b(data, test::with_device("simulated:omega6,hand=explore,seed=7,seconds=60"));
    run::Run::record_together(std::array{&a, &b}, recording);
    a.start();
    b.start();
    const auto step = [&] {
        a.step();
        b.step();
    };
    const auto is_settled = [&] { return data->is_settled(); };
    const auto touches = [](const run::Run& run) {
        const auto now = run.snapshot();
        return now && now->session.tick.proxy.mode == Mode::constrained &&
               now->session.tick.proxy.status == UpdateStatus::done;
    };
    int contacts[2] = {};
    EXPECT_TRUE(steps_until(step, is_settled, [&] {
        contacts[0] += touches(a);
        contacts[1] += touches(b);
        return contacts[0] > 20 && contacts[1] > 20;
    }));
    data->editor().set_brush(usual_brush(ball.geometry()));
    EXPECT_TRUE(
        steps_until(step, is_settled, [&] { return data->editor().state().undo_steps > 1; }));
    data->editor().set_brush(std::nullopt);
    const std::uint64_t version = data->editor().state().version;
    EXPECT_TRUE(steps_until(step, is_settled, [&] {
        return a.snapshot()->session.version >= version && b.snapshot()->session.version >= version;
    }));
    for (int i = 0; i < 150; ++i) step();
    // One ends, and the other goes on.
    a.stop();
    const std::int64_t before = b.snapshot()->number;
    test::step(b, 150);
    EXPECT_EQ(b.snapshot()->number, before + 150);
    a.stop_recording();
    b.stop_recording();
    for (const int hand : {1, 2}) expect_replays(recording, *data, hand);
}

TEST(Hands, are_recorded_from_now_on_without_a_change_of_their_forces) {
    const ScratchFolder folder;
    const auto undisturbed = alone(circling, 500, folder / "alone.csv");
    const auto data = shared_ball();
    run::Run a(data, test::with_device(holding)), b(data, test::with_device(circling));
    a.start();
    b.start();
    test::step(a, 300);
    test::step(b, 300);
    run::Run::record_together(std::array{&a, &b}, folder / "both.csv");
    test::step(a, 200);
    test::step(b, 200);
    a.record(folder / "one.csv");  // leaves the recording of both
    test::step(a, 50);
    EXPECT_EQ(a.stop_recording(), 50);
    EXPECT_EQ(b.stop_recording(), 200);
    const auto ticks = ticks_of(folder / "both.csv", 2);
    expect_the_same(ticks, {undisturbed.begin() + 300, undisturbed.end()});
    for (int hand = 1; hand <= 2; ++hand) expect_replays(folder / "both.csv", *data, hand);
    expect_replays(folder / "one.csv", *data, 1);
}

/// The servos of both, the editor and the recorder have threads of their own.
TEST(PacedHands, feel_and_are_recorded_while_one_thread_edits_and_another_looks_on) {
    const ScratchFolder folder;
    const auto data = std::make_shared<Data>(test::loaded("synthetic:sphere:32x32x32"));
    run::Run a(data, test::with_device(holding)), b(data, test::with_device(circling));
    run::Run::record_together(std::array{&a, &b}, folder / "both.csv");
    constexpr auto pause = std::chrono::milliseconds(20);
    a.start();
    std::this_thread::sleep_for(pause);
    b.start();
    std::jthread edits([&](const std::stop_token& stop) {
        data->editor().set_brush(HandBrush{.radius = 3});
        for (int i = 0; !stop.stop_requested(); ++i) {
            data->editor().apply(edit::Fill{{{5, 5, 5}, {6, 6, 6}}, double(i % 2)});
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
    });
    std::array<bool, 2> presses{}, edited{};
    bool lasts = false;
    EXPECT_TRUE(test::comes_true([&] {
        for (const std::size_t hand : {0, 1}) {
            run::Run& run = hand == 0 ? a : b;
            if (run.waiting() == 0) run.send(command::Isovalue{run.isovalue() + 0.001});
            const auto now = run.snapshot();
            presses[hand] |= now && now->session.tick.force.norm() > 0.05;
            edited[hand] |= now && now->session.version > 20;
            lasts |= hand == 0 && now && now->number > 200;
        }
        return lasts && presses[0] && presses[1] && edited[0] && edited[1];
    }));
    edits = {};
    b.use_device(devices::parse_device("mouse"));
    EXPECT_GT(a.stop_recording(), 100);
    double begins[2] = {};
    for (const int hand : {1, 2}) {
        expect_replays(folder / "both.csv", *data, hand);
        io::RecordingReader reader(folder / "both.csv", hand);
        while (reader.next()) continue;
        EXPECT_TRUE(reader.complete());
        begins[hand - 1] = reader.begin().value_or(-1);
    }
    EXPECT_GE(begins[1] - begins[0], std::chrono::duration<double>(pause).count());
}

TEST(Hands, on_different_data_or_twice_are_not_recorded_together) {
    const ScratchFolder folder;
    const auto data = shared_ball();
    run::Run a(data, test::with_device("mouse")), b(shared_ball(), test::with_device("mouse"));
    EXPECT_THROW(run::Run::record_together(std::array{&a, &b}, folder / "r.csv"),
                 std::invalid_argument);
    EXPECT_THROW(run::Run::record_together(std::array{&a, &a}, folder / "r.csv"),
                 std::invalid_argument);
    EXPECT_THROW(run::Run::record_together({}, folder / "r.csv"), std::invalid_argument);
    EXPECT_FALSE(std::filesystem::exists(folder / "r.csv"));
    EXPECT_EQ(a.recording(), nullptr);
}

}  // namespace
}  // namespace palpate::run
