// Recordings to be looked at.
#include "apps/viewer/model/playback.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <stdexcept>

#include "palpate/run/run.hpp"
#include "support/random.hpp"
#include "support/recordings.hpp"
#include "support/scratch_folder.hpp"

namespace palpate::viewer {
namespace {

using support::message_of;
using support::ScratchFolder;

/// A recording as a session makes it, without waiting for its time to pass: a hand that dips into a
/// ball once a second, with a command now and then.
struct Recorded {
    ScratchFolder folder;
    std::filesystem::path path = folder / "a.csv";
    run::LoadedVolume loaded;
    std::vector<SessionTick> ticks;

    /// From tick `layers_from` on with layers.
    explicit Recorded(int count, const std::function<double(int)>& time = {}, int layers_from = -1)
        : loaded(run::load(volume())) {
        const Field field = linear_field(loaded.volume);
        RendererSettings settings;
        settings.method = &update_exact;
        Session session{make_renderer(field, 76.5, settings), {}};
        io::RecordingWriter writer(path, run::recording_head(session, {}, identity_of(session), {}),
                                   Pace::by_steps);
        std::vector<SessionEvent> events;
        for (int i = 0; i < count; ++i) {
            if (i % 1500 == 700) {
                const Command command = command::Isovalue{70.0 + i % 11};
                apply(session, command);
                events.emplace_back(command);
            }
            if (i == layers_from) {
                Layers layers;
                layers.layers.resize(1);
                layers.layers[0].name = "shell";
                layers.layers[0].level = 80;
                const Command command = command::UseLayers{std::make_shared<const Layers>(layers)};
                apply(session, command);
                events.emplace_back(command);
            }
            const double t = time ? time(i) : 1e-3 * i + 1e-5 * (i % 7);
            DeviceReading reading;
            reading.status = DeviceStatus::ready;
            reading.position = {14 + 8 * std::cos(6.2832e-3 * i), 0.5 * std::sin(1e-3 * i), 0.3};
            ticks.push_back(advance(session, t, reading));
            events.emplace_back(ticks.back());
        }
        for (const SessionEvent& event : events) {
            while (!writer.queue().push(event)) writer.step();
        }
        writer.finish(0);
    }
    static io::VolumeIdentity identity_of(const Session& session) {
        return io::identify(session.renderer.field.volume(), run::to_names(volume()));
    }
    static run::Source volume() { return run::source_named("synthetic:sphere:32x32x32"); }
    Playback play(std::size_t most_bytes = Playback::usual_bytes) const {
        return Playback::read(path, loaded, {}, most_bytes);
    }
};

/// The hands have different levels and lengths.
TEST(Playback, of_two_hands_has_the_snapshots_of_each) {
    const ScratchFolder folder;
    const auto path = folder / "two.csv";
    const run::LoadedVolume loaded = run::load(Recorded::volume());
    std::vector<io::RecordingHead> heads;
    std::vector<Session> sessions;
    for (const double level : {76.5, 90.0}) {
        RendererSettings settings;
        settings.method = &update_exact;
        sessions.push_back({make_renderer(linear_field(loaded.volume), level, settings), {}});
        heads.push_back(
            run::recording_head(sessions.back(), {}, Recorded::identity_of(sessions.back()), {}));
    }
    io::RecordingWriter writer(path, heads, Pace::by_steps);
    for (int i = 0; i < 200; ++i) {
        DeviceReading reading;
        reading.status = DeviceStatus::ready;
        reading.position = {14 + 8 * std::cos(6.2832e-3 * i), 0.5, 0.3};
        for (const int hand : {1, 2}) {
            if (hand == 2 && i >= 100) continue;
            auto& session = sessions[static_cast<std::size_t>(hand - 1)];
            // Sessions have clocks of their own.
            ASSERT_TRUE(writer.queue(hand).push(advance(session, 1e-3 * i + 7 * hand, reading)));
        }
        writer.step();
    }
    writer.set_begin(5'000'000'000, 1);
    writer.set_begin(5'250'000'000, 2);
    for (const int hand : {1, 2}) writer.finish(0, hand);
    double last = 0;
    const auto both = Playback::read_hands(path, loaded, [&](double part) {
        EXPECT_GE(part, last);
        last = part;
    });
    EXPECT_EQ(last, 1);
    ASSERT_EQ(both.size(), 2U);
    EXPECT_EQ(both[0].ticks(), 200U);
    EXPECT_EQ(both[1].ticks(), 100U);
    EXPECT_EQ(both[0].begin(), 7);
    EXPECT_EQ(both[1].begin(), 14);
    EXPECT_EQ(both[1].clock() - both[0].clock(), 0.25);
    EXPECT_EQ(both[1].head().isovalue, 90);
    for (const Playback& one : both) {
        EXPECT_EQ(one.different(), 0U);
        EXPECT_EQ(one.hands(), 2);
        EXPECT_TRUE(one.complete());
    }
}

void expect_same(const Snapshot& shown, const SessionTick& recorded) {
    EXPECT_EQ(shown.session.tick.time, recorded.tick.time);
    EXPECT_EQ(shown.session.tick.proxy.hip, recorded.tick.proxy.hip);
    EXPECT_EQ(shown.session.tick.proxy.scp, recorded.tick.proxy.scp);
    EXPECT_EQ(shown.session.tick.force, recorded.tick.force);
    EXPECT_EQ(shown.session.tick.proxy.isovalue, recorded.tick.proxy.isovalue);
    EXPECT_EQ(shown.session.device.position, recorded.device.position);
}

TEST(Playback, any_moment_shows_a_tick_at_or_just_before_it_as_it_was) {
    const Recorded recorded(3000);
    const Playback playback = recorded.play();
    EXPECT_EQ(playback.ticks(), 3000U);
    EXPECT_EQ(playback.different(), 0U);
    EXPECT_TRUE(playback.complete());
    EXPECT_EQ(playback.begin(), recorded.ticks.front().tick.time);
    EXPECT_EQ(playback.end(), recorded.ticks.back().tick.time);
    EXPECT_EQ(playback.head().isovalue, 76.5);
    EXPECT_LT(playback.snapshots(), 1100U);
    support::Random random(3);
    int pressed = 0;
    for (int i = 0; i < 500; ++i) {
        const double time = random.uniform(playback.begin(), playback.end());
        const Snapshot& shown = playback.at(time);
        EXPECT_LE(shown.session.tick.time, time);
        EXPECT_GT(shown.session.tick.time, time - 0.0062);
        const SessionTick& tick = recorded.ticks[static_cast<std::size_t>(shown.number)];
        expect_same(shown, tick);
        if (tick.tick.force.norm() > 0.1) ++pressed;
    }
    EXPECT_GT(pressed, 30);
}

TEST(Playback, knows_the_layers_at_any_time) {
    const Recorded recorded(3000, {}, 1000);
    const Playback playback = recorded.play();
    EXPECT_EQ(playback.different(), 0U);
    EXPECT_EQ(playback.layers_at(0.5), nullptr);
    EXPECT_EQ(playback.layers_at(-1), nullptr);
    ASSERT_TRUE(playback.layers_at(1.5));
    EXPECT_EQ(playback.layers_at(1.5)->layers.front().name, "shell");
    EXPECT_EQ(playback.layers_at(9), playback.layers_at(1.5));
}

TEST(Playback, its_ends_are_the_first_and_the_last_tick_and_so_is_what_lies_beyond) {
    const Recorded recorded(1001);
    const Playback playback = recorded.play();
    for (const double before : {playback.begin(), -1.0, -1e300, std::nan("")}) {
        expect_same(playback.at(before), recorded.ticks.front());
    }
    for (const double after : {playback.end(), 99.0, 1e300}) {
        expect_same(playback.at(after), recorded.ticks.back());
    }
}

TEST(Playback, the_time_line_knows_force_level_and_contact) {
    const Recorded recorded(20'000);
    const Overview overview = recorded.play().overview();
    ASSERT_LE(overview.pieces.size(), Overview::most_pieces);
    ASSERT_GT(overview.pieces.size(), Overview::most_pieces / 2 - 1);
    EXPECT_EQ(overview.width, 0.008);
    std::vector<Overview::Piece> expected(overview.pieces.size());
    for (const SessionTick& tick : recorded.ticks) {
        const auto at =
            static_cast<std::size_t>((tick.tick.time - overview.begin) / overview.width);
        Overview::Piece& piece = expected[at];
        const double force = tick.tick.force.norm(), level = tick.tick.proxy.isovalue;
        piece.least_force = piece.empty ? force : std::min(piece.least_force, force);
        piece.most_force = std::max(piece.most_force, force);
        piece.least_isovalue = piece.empty ? level : std::min(piece.least_isovalue, level);
        piece.most_isovalue = piece.empty ? level : std::max(piece.most_isovalue, level);
        piece.contact = piece.contact || tick.tick.proxy.mode == Mode::constrained;
        piece.empty = false;
    }
    int touching = 0, dips = 0;
    for (std::size_t i = 0; i < expected.size(); ++i) {
        EXPECT_EQ(overview.pieces[i].empty, expected[i].empty);
        EXPECT_EQ(overview.pieces[i].least_force, expected[i].least_force);
        EXPECT_EQ(overview.pieces[i].most_force, expected[i].most_force);
        EXPECT_EQ(overview.pieces[i].least_isovalue, expected[i].least_isovalue);
        EXPECT_EQ(overview.pieces[i].most_isovalue, expected[i].most_isovalue);
        EXPECT_EQ(overview.pieces[i].contact, expected[i].contact);
        const double middle = overview.begin + (double(i) + 0.5) * overview.width;
        EXPECT_EQ(overview.over(middle, middle).contact, expected[i].contact) << middle;
        touching += expected[i].contact;
        dips += expected[i].contact && (i == 0 || !expected[i - 1].contact);
    }
    EXPECT_GT(touching, 300);
    EXPECT_EQ(dips, 20);  // one a second
    const Overview::Piece two =
        overview.over(overview.begin, overview.begin + 1.5 * overview.width);
    EXPECT_EQ(two.most_force, std::max(expected[0].most_force, expected[1].most_force));
    const Overview::Piece all = overview.over(-1e9, 1e9);
    EXPECT_EQ(all.most_force,
              std::ranges::max_element(expected, {}, &Overview::Piece::most_force)->most_force);
}

TEST(Playback, memory_is_bounded_however_long_it_is) {
    const Recorded recorded(8000);
    constexpr std::size_t room = 100;
    const Playback playback = recorded.play(room * sizeof(Snapshot));
    EXPECT_LE(playback.snapshots(), room);
    EXPECT_GE(playback.snapshots(), room / 2 - 2);
    EXPECT_EQ(playback.ticks(), 8000U);
    expect_same(playback.at(playback.begin()), recorded.ticks.front());
    expect_same(playback.at(playback.end()), recorded.ticks.back());
    for (double time = playback.begin(); time < playback.end(); time += 0.01) {
        const Snapshot& shown = playback.at(time);
        EXPECT_LE(shown.session.tick.time, time);
        EXPECT_GT(shown.session.tick.time, time - 8.0 / (room / 2 - 2));
        expect_same(shown, recorded.ticks[static_cast<std::size_t>(shown.number)]);
    }
}

TEST(Playback, a_recording_that_was_cut_off_is_played_up_to_there) {
    const Recorded recorded(1000);
    const std::string text = support::bytes_of(recorded.path);
    support::put_bytes(recorded.path, text.substr(0, text.size() / 2));
    const Playback playback = recorded.play();
    EXPECT_FALSE(playback.complete());
    EXPECT_GT(playback.ticks(), 300U);
    EXPECT_LT(playback.ticks(), 700U);
    expect_same(playback.at(1e9), recorded.ticks[playback.ticks() - 1]);
}

TEST(Playback, ticks_that_replay_differently_are_counted) {
    const Recorded recorded(500);
    // Format 1 has no checksums, which would refuse it.
    std::string text = support::as_format_1(support::bytes_of(recorded.path));
    // The end of the last tick's line: another hand, another proxy.
    const auto end = text.rfind("\n#");
    const auto line = text.rfind('\n', end - 1) + 1;
    const auto comma = text.find(',', line) + 1;
    text.replace(comma, text.find(',', comma) - comma, "99.5");
    support::put_bytes(recorded.path, text);
    EXPECT_EQ(recorded.play().different(), 1U);
}

TEST(Playback, times_that_stand_still_or_go_back_have_no_place_on_the_line) {
    const Recorded recorded(300, [](int i) { return i % 10 == 9 ? 0.001 * (i - 5) : 0.001 * i; });
    const Playback playback = recorded.play();
    EXPECT_EQ(playback.ticks(), 300U);
    EXPECT_EQ(playback.different(), 0U);
    double last = -1;
    for (double time = playback.begin(); time < playback.end(); time += 0.0005) {
        const double shown = playback.at(time).session.tick.time;
        EXPECT_GE(shown, last);
        EXPECT_LE(shown, time);
        last = shown;
    }
    EXPECT_EQ(playback.end(), 0.298);
}

TEST(Playback, a_file_that_cannot_be_played_is_an_input_error_with_its_name) {
    const Recorded recorded(50);
    const std::string text = support::bytes_of(recorded.path);
    const auto words = [&](const std::string& bytes) {
        support::put_bytes(recorded.path, bytes);
        const std::string said = message_of<io::InputError>([&] { (void)recorded.play(); });
        EXPECT_TRUE(support::contains(said, "a.csv")) << said;
        return said;
    };
    words("");
    words("t,x\n1,2\n");
    words(text.substr(0, text.size() - 300) + "oh,no\n");
    const auto first_tick = text.find('\n', text.find("\nt,hip") + 1) + 1;
    EXPECT_TRUE(support::contains(words(text.substr(0, first_tick)), "no ticks"));
    words(text.substr(0, first_tick) + "# command {\"scale\": {\"scale\": -1}}\n" +
          text.substr(first_tick));
    support::put_bytes(recorded.path, text);
    const run::LoadedVolume torus = run::load(run::source_named("synthetic:torus:32x32x32"));
    EXPECT_TRUE(support::contains(
        message_of<io::InputError>([&] { (void)Playback::read(recorded.path, torus, {}); }),
        "synthetic:torus"));
    EXPECT_THROW((void)Playback::read(recorded.folder / "none.csv", torus, {}), io::InputError);
}

TEST(Playback, progress_rises_to_the_end_and_may_stop_the_reading) {
    const Recorded recorded(5000);
    double last = -1;
    int told = 0;
    const Playback whole = Playback::read(recorded.path, recorded.loaded, [&](double part) {
        EXPECT_GE(part, last);
        EXPECT_LE(part, 1);
        last = part;
        ++told;
    });
    EXPECT_EQ(last, 1);
    EXPECT_GE(told, 4);
    struct Enough {};
    EXPECT_THROW((void)Playback::read(recorded.path, recorded.loaded,
                                      [](double part) {
                                          if (part > 0.5) throw Enough{};
                                      }),
                 Enough);
}

}  // namespace
}  // namespace palpate::viewer
