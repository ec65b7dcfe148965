// Everything at once, as in the window: a servo, a brush or a player, a recording, surfaces that
// are extracted and volumes that are saved meanwhile. For the thread sanitizer above all.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cstring>
#include <functional>
#include <thread>

#include "apps/viewer/model/playback.hpp"
#include "apps/viewer/model/worker.hpp"
#include "palpate/run/run.hpp"
#include "palpate/surface.hpp"
#include "support/eventually.hpp"
#include "support/scratch_folder.hpp"

namespace palpate::viewer {
namespace {

using namespace std::chrono_literals;
using support::comes_true;
using support::ScratchFolder;

run::Setup sliding() {
    run::Setup setup;
    setup.device = devices::parse_device("simulated:hand=slide,depth=3,seconds=600");
    setup.real_time = false;
    return setup;
}

struct ChangingRun {
    run::LoadedVolume loaded;
    run::Run live;

    explicit ChangingRun(const std::string& volume)
        : loaded(run::load(run::source_named(volume))),
          live(std::make_shared<run::Data>(loaded), sliding()) {
        live.start();
    }
};

/// Looks at the data from two more threads, as painter and saving do, while `window` runs here.
void with_observers(const run::Run& live, const std::function<void()>& window) {
    std::atomic<bool> done{false};
    std::atomic<int> surfaces{0};
    std::jthread painter([&] {
        while (!done) {
            const Field field = live.field_now();
            surfaces += extract_surface(field, 76.5).complete;
        }
    });
    std::jthread observer([&] {
        while (!done) {
            (void)live.snapshot();
            (void)live.report();
        }
    });
    window();
    EXPECT_TRUE(comes_true([&] { return surfaces > 3; }));
    done = true;
}

TEST(RunData, a_brush_works_while_all_others_look_record_and_save) {
    const ScratchFolder folder;
    std::shared_ptr<const Samples> felt;
    {
        ChangingRun s("synthetic:sphere:32x32x32");
        s.live.record(folder / "r.csv");
        run::VolumeEditor& editor = s.live.data().editor();
        std::unique_ptr<Worker> saving;
        with_observers(s.live, [&] {
            editor.set_brush(run::HandBrush{.radius = 2, .rate = 20});
            // A busy machine makes few and long strokes until nothing is left in the hand's way.
            ASSERT_TRUE(comes_true([&] { return editor.state().version > 5; }));
            const auto samples = s.live.field_now().shared_samples();
            saving = std::make_unique<Worker>(
                [&, samples](const io::Progress&) {
                    io::WriteOptions options;
                    options.helper = PALPATE_IO_HELPER_PROGRAM;
                    io::write_volume(flattened(*samples), folder / "saved.nrrd", options);
                },
                [] {});
            for (int i = 0; i < 5; ++i) {
                editor.apply(edit::Fill{{{i, i, i}, {i + 3, i + 3, i + 3}}, 200});
                editor.undo();
                editor.redo();
            }
            editor.set_brush({});
        });
        felt = editor.state().samples;
        EXPECT_TRUE(comes_true([&] { return saving->ended(); }));
        EXPECT_TRUE(saving->finish());
        EXPECT_GT(s.live.stop_recording(), 0);
        EXPECT_EQ(editor.state().samples, felt) << "the session began anew with its edits";
        EXPECT_TRUE(comes_true([&] {
            const auto now = s.live.snapshot();
            return now && now->session.version == editor.state().version;
        }));
    }
    Playback played = Playback::read(folder / "r.csv",
                                     run::load(run::source_named("synthetic:sphere:32x32x32")), {});
    EXPECT_EQ(played.different(), 0U);
    const Volume seen = flattened(played.field_at(played.at(played.end())).samples());
    const Volume want = flattened(*felt);
    EXPECT_EQ(std::memcmp(seen.data(), want.data(), want.bytes()), 0);
}

TEST(RunData, a_sequence_plays_while_all_others_look_and_record) {
    const ScratchFolder folder;
    {
        ChangingRun s("synthetic:beating:24x24x24");
        s.live.record(folder / "r.csv");
        run::Player& player = s.live.data().player();
        with_observers(s.live, [&] {
            ASSERT_TRUE(comes_true([&] {
                const auto now = s.live.snapshot();
                return now && now->session.moment > 1;
            }));
            player.set_loop(false);
            player.play(-2);
            player.seek(0.3);
            player.step(1);
            player.set_loop(true);
            player.play(3);
            ASSERT_TRUE(comes_true([&] { return player.state().time > 0.5; }));
        });
        EXPECT_GT(s.live.stop_recording(), 0);
        EXPECT_EQ(player.state().speed, 3) << "it goes on in the session that began anew";
    }
    const Playback played = Playback::read(
        folder / "r.csv", run::load(run::source_named("synthetic:beating:24x24x24")), {});
    EXPECT_EQ(played.different(), 0U);
}

TEST(RunData, a_recording_that_begins_after_edits_begins_with_them) {
    const ScratchFolder folder;
    ChangingRun s("synthetic:sphere:32x32x32");
    run::VolumeEditor& editor = s.live.data().editor();
    editor.apply(edit::Fill{{{5, 5, 5}, {20, 20, 20}}, 0});
    editor.apply(edit::Fill{{{5, 5, 5}, {9, 9, 9}}, 200});
    editor.undo();
    s.live.record(folder / "r.csv");
    ASSERT_TRUE(comes_true([&] { return s.live.recording()->ticks() > 50; }));
    (void)s.live.stop_recording();
    const Playback played = Playback::read(folder / "r.csv", s.loaded, {});
    EXPECT_EQ(played.different(), 0U);
    EXPECT_EQ(played.at(played.begin()).session.version, 1U);
    // And after more of them than its queue has room for.
    for (int i = 0; i < 9000; ++i) {
        editor.apply(edit::Fill{{{1, 1, 1}, {1, 1, 1}}, double(i % 2 + 1)});
    }
    s.live.record(folder / "s.csv");
    ASSERT_TRUE(comes_true([&] { return s.live.recording()->ticks() > 50; }));
    (void)s.live.stop_recording();
    const Playback long_one = Playback::read(folder / "s.csv", s.loaded, {});
    EXPECT_EQ(long_one.different(), 0U);
    EXPECT_EQ(long_one.at(long_one.begin()).session.version, editor.state().version);
}

}  // namespace
}  // namespace palpate::viewer
