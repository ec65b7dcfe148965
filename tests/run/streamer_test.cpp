// Volumes that are read as they are felt: live runs, recordings, replays.
#include "palpate/run/streamer.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <cstring>
#include <fstream>
#include <thread>

#include "palpate/io/error.hpp"
#include "palpate/run/offline.hpp"
#include "palpate/run/run.hpp"
#include "palpate/scenes/volumes.hpp"
#include "palpate/stream/convert.hpp"
#include "run/run_support.hpp"
#include "stream/volumes_store.hpp"
#include "support/eventually.hpp"
#include "support/scratch_folder.hpp"
#include "support/zarr_image.hpp"

namespace palpate::run {
namespace {

using support::ScratchFolder;
using test::steps_until;

/// A ball in a volume of two bricks along each axis, as a file. Its overview is the whole volume,
/// so its range is known.
struct BallFile {
    ScratchFolder folder;
    Volume volume = scenes::make_volume("sphere:128x126x125").volume;
    std::string path = (folder.path() / "ball.nrrd").string();

    BallFile() { io::write_volume(volume, path); }

    std::map<std::string, std::string> names() const { return {{"volume", path}}; }
    Source streamed() const {
        auto given = names();
        given["level"] = "0";
        Source source = source_from(given);
        std::get<StoreSource>(source.from).loader.memory = std::uint64_t{200} << 20;
        return source;
    }
    Source whole() const { return source_from(names()); }
};

io::Trajectory stroke(const Volume& volume) {
    const Vec3 centre = physical_centre(volume.geometry());
    io::Trajectory trajectory;
    for (int i = 0; i < 3000; ++i) {
        const double a = 0.002 * i, r = 64 - 0.019 * i;
        trajectory.time.push_back(0.001 * i);
        trajectory.position.push_back(
            centre + Vec3(r * std::cos(a), r * std::sin(a), 25 * std::sin(0.001 * i)));
    }
    return trajectory;
}

TEST(Streamed, a_replay_that_waits_gives_the_ticks_of_the_whole_volume_bit_for_bit) {
    const BallFile ball;
    const LoadedVolume whole = load(ball.whole()), streamed = load(ball.streamed());
    ASSERT_FALSE(whole.streamed);
    ASSERT_TRUE(streamed.streamed);
    const io::Trajectory trajectory = stroke(whole.volume);
    const auto rows_of = [&](const LoadedVolume& loaded) {
        const Field field = make_field(start_samples(loaded), {});
        const double level = 0.5 * (whole.volume.minimum() + whole.volume.maximum());
        Renderer renderer =
            make_renderer(field, level, offline_settings(RenderSetup{}, field, level));
        std::vector<io::TraceRow> rows;
        OfflineSinks sinks;
        sinks.change = wait_for_bricks(loaded, trajectory);
        sinks.row = [&](const io::TraceRow& row) { rows.push_back(row); };
        render_offline(renderer, trajectory, sinks);
        return rows;
    };
    const auto expected = rows_of(whole), rows = rows_of(streamed);
    ASSERT_EQ(rows.size(), expected.size());
    int constrained = 0;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        ASSERT_FALSE(rows[i].waiting);
        ASSERT_EQ(rows[i].scp, expected[i].scp) << i;
        ASSERT_EQ(rows[i].force, expected[i].force) << i;
        constrained += rows[i].constrained;
    }
    EXPECT_GT(constrained, 500);
}

TEST(Streamed, a_replay_in_real_time_holds_the_proxy_until_its_samples_are_there) {
    const BallFile ball;
    const LoadedVolume streamed = load(ball.streamed());
    const io::Trajectory trajectory = stroke(ball.volume);
    Renderer renderer = make_renderer(make_field(start_samples(streamed), {}), 1);
    const auto pace = keep_pace(streamed, trajectory, [&](double seconds) {
        EXPECT_EQ(seconds, trajectory.time[1]);
        return std::chrono::steady_clock::time_point();
    });
    const auto status = [&] {
        return render(renderer, {trajectory.time[1], trajectory.position[1], true}).proxy.status;
    };
    EXPECT_EQ(status(), UpdateStatus::waiting);
    EXPECT_TRUE(support::comes_true([&] {
        pace(renderer, 1);
        return status() == UpdateStatus::done;
    }));
}

TEST(Streamed, a_live_run_touches_and_its_recording_repeats_bit_for_bit) {
    const BallFile ball;
    const auto data = test::stepped_data(load(ball.streamed()));
    run::Run live(data, test::with_device("simulated:hand=explore,seconds=60"));
    const std::string recording = (ball.folder.path() / "touch.csv").string();
    live.record(recording);
    live.start();
    int contacts = 0;
    EXPECT_TRUE(steps_until(live, [&] {
        const auto now = live.snapshot();
        contacts += now && now->session.tick.proxy.mode == Mode::constrained &&
                    now->session.tick.proxy.status == UpdateStatus::done;
        return contacts > 20;
    }));
    test::step(live, 150);
    EXPECT_THROW(data->player(), std::invalid_argument);
    EXPECT_GT(data->streaming().loaded, 0U);
    // A second recording begins with bricks in memory.
    const std::string later = (ball.folder.path() / "later.csv").string();
    live.record(later);
    test::step(live, 150);
    live.stop();
    live.stop_recording();
    for (const std::string& path : {recording, later}) {
        io::RecordingReader reader{std::filesystem::path(path)};
        const LoadedVolume again = load(recorded_source(reader.head(), path));
        ASSERT_TRUE(again.streamed) << "a recording says how its volume was read";
        Replay replay(reader, again, path);
        EXPECT_GT(test::expect_same_again(replay), 100);
        EXPECT_GT(replay.commands(), 0);
    }
}

/// Replays a recording and expects the same ticks; returns how many there are.
std::int64_t expect_same_again(const std::string& path) {
    io::RecordingReader reader{std::filesystem::path(path)};
    const LoadedVolume again = load(recorded_source(reader.head(), path));
    Replay replay(reader, again, path);
    return test::expect_same_again(replay);
}

Edit ball_at(const Vec3& centre, double radius, const Field& field, double isovalue) {
    return edit::Stroke{brush_for(BrushKind::carve, field, isovalue, radius), centre, centre};
}

TEST(Streamed, what_is_edited_is_felt_undone_recorded_and_repeats_bit_for_bit) {
    const BallFile ball;
    const auto data = test::stepped_data(load(ball.streamed()));
    run::Run live(data, test::with_device("simulated:hand=explore,seconds=60"));
    const std::string recording = (ball.folder.path() / "edits.csv").string();
    live.record(recording);
    live.start();
    // Before any brick need be there: it is read.
    const Vec3 centre = physical_centre(ball.volume.geometry());
    const Geometry& geometry = ball.volume.geometry();
    data->editor().apply(ball_at(centre, 9, live.field(), live.isovalue()));
    const auto expected = edited(std::make_shared<const Samples>(ball.volume),
                                 ball_at(centre, 9, live.field(), live.isovalue()));
    const Index3 middle = index_from_physical(geometry, centre).array().round().cast<int>();
    EXPECT_EQ(data->editor().state().samples->sample(middle), expected.samples->sample(middle));
    EXPECT_NE(expected.samples->sample(middle), ball.volume.sample(middle));
    HandBrush brush = usual_brush(geometry);
    data->editor().set_brush(brush);
    EXPECT_TRUE(steps_until(live, [&] { return data->editor().state().undo_steps > 1; }))
        << "the hand carves: " << data->editor().state().problem;
    data->editor().set_brush(std::nullopt);
    test::step(live, 150);
    const std::string later = (ball.folder.path() / "later.csv").string();
    live.record(later);  // begins with the edits and what is in memory
    data->editor().apply(edit::Fill{{{5, 5, 5}, {30, 30, 30}}, 0});
    EXPECT_TRUE(data->editor().undo());
    EXPECT_TRUE(data->editor().undo());
    EXPECT_TRUE(data->editor().redo());
    const std::string last = (ball.folder.path() / "last.csv").string();
    live.record(last);  // with steps that were undone
    const std::uint64_t version = data->editor().state().version;
    test::step(live, 150);
    EXPECT_GT(version, 0U);
    const std::shared_ptr<const Samples> felt = live.field_now().shared_samples();
    EXPECT_TRUE(felt->bricks());
    EXPECT_GT(felt->resident()->size(), 0U);
    live.stop();
    live.stop_recording();
    EXPECT_GT(expect_same_again(recording), 100);
    expect_same_again(later);
    EXPECT_GT(expect_same_again(last), 100);
}

/// A loaded volume of a store that a test may interfere with.
LoadedVolume loaded_of(const std::shared_ptr<stream::VolumesStore>& store) {
    LoadedVolume loaded{.volume = stream::overview_of(*store), .source = {}, .name = "v"};
    StoreSource source{.address = "v", .options = {}, .loader = {}};
    source.loader.memory = std::uint64_t{200} << 20;
    loaded.streamed = StreamedVolume{store, source.loader};
    loaded.source.from = source;
    return loaded;
}

TEST(Streamed, an_edit_reads_its_samples_once_although_others_edit_meanwhile) {
    // Rows are read each time that they are asked for.
    const auto store =
        stream::store_in_pieces(scenes::make_volume("sphere:128x126x125").volume, {128, 1, 1});
    Data data(loaded_of(store), {}, Pace::by_steps);
    std::map<std::array<int, 3>, int> reads;
    int others = 0;
    bool is_other = false;
    store->before_read = [&](int, const SampleBox& box, const std::stop_token&) {
        if (is_other) return;
        ++reads[{box.low[0], box.low[1], box.low[2]}];
        if (++others > 1000) return;
        is_other = true;
        data.editor().apply(edit::Fill{{{90, 90, 90}, {91, 91, 91}}, 80.0 + others % 2});
        is_other = false;
    };
    data.editor().apply(edit::Fill{{{10, 10, 10}, {50, 50, 20}}, 90});
    EXPECT_GT(reads.size(), 1U);
    for (const auto& [at, count] : reads) EXPECT_EQ(count, 1) << at[0] << " " << at[1];
    EXPECT_EQ(data.editor().state().samples->sample({20, 20, 15}), 90);
}

TEST(Streamed, undo_and_brush_do_not_wait_for_the_samples_of_an_edit) {
    const auto store = stream::store_in_pieces(scenes::make_volume("sphere:128x126x125").volume);
    Data data(loaded_of(store), {}, Pace::by_steps);
    data.editor().apply(edit::Fill{{{1, 1, 1}, {5, 5, 5}}, 90});
    std::atomic<bool> reads{false}, may_read{false};
    store->before_read = [&](int, const SampleBox&, const std::stop_token& stop) {
        reads = true;
        while (!may_read && !stop.stop_requested()) std::this_thread::yield();
    };
    std::jthread other([&] { data.editor().apply(edit::Fill{{{90, 90, 90}, {99, 99, 99}}, 80}); });
    ASSERT_TRUE(support::comes_true([&] { return reads.load(); }));
    EXPECT_TRUE(data.editor().undo());
    data.editor().set_brush(std::nullopt);
    EXPECT_EQ(data.editor().state().undo_steps, 0U);
    may_read = true;
    other.join();
    EXPECT_EQ(data.editor().state().samples->sample({95, 95, 95}), 80);
    EXPECT_EQ(data.editor().state().undo_steps, 1U);
}

TEST(Streamed, an_edit_that_waits_for_samples_stops_when_asked_to_and_changes_nothing) {
    const auto store = stream::store_in_pieces(scenes::make_volume("sphere:128x126x125").volume);
    Data data(loaded_of(store), {}, Pace::by_steps);
    std::atomic<bool> reads{false}, hangs{true};
    store->before_read = [&](int, const SampleBox&, const std::stop_token& asked) {
        reads = true;
        while (hangs && !asked.stop_requested()) std::this_thread::yield();
        if (asked.stop_requested()) throw stream::Cancelled{};
    };
    const edit::Fill fill{{{90, 90, 90}, {99, 99, 99}}, 80};
    const auto stop_once_it_reads = [&](double) {
        if (reads) throw stream::Cancelled{};
    };
    EXPECT_THROW(data.editor().apply(fill, stop_once_it_reads), stream::Cancelled);
    EXPECT_FALSE(data.editor().state().changed);
    hangs = false;
    data.editor().apply(fill);
    EXPECT_EQ(data.editor().state().samples->sample({95, 95, 95}), 80);
}

TEST(Streamed, edits_have_a_quarter_of_the_memory_and_say_so) {
    ScratchFolder folder;
    const std::string path = (folder.path() / "large.raw").string();
    std::filesystem::resize_file((std::ofstream(path), path), std::uintmax_t{512} << 20);
    Source source = source_from(
        {{"volume", path}, {"dims", "1024x1024x512"}, {"type", "uint8"}, {"level", "0"}});
    std::get<StoreSource>(source.from).loader.memory = std::uint64_t{40} << 20;
    Data data(load(source));
    EXPECT_NO_THROW(data.editor().apply(edit::Fill{{{0, 0, 0}, {99, 99, 99}}, 9}));
    const auto before = data.editor().state();
    try {
        data.editor().apply(edit::Fill{{{0, 0, 0}, {500, 500, 500}}, 9});
        FAIL() << "500^3 samples are more than 10 MB";
    } catch (const std::invalid_argument& e) {
        EXPECT_NE(std::string(e.what()).find("10 MB"), std::string::npos) << e.what();
    }
    EXPECT_EQ(data.editor().state().version, before.version) << "it is made whole or not at all";
    EXPECT_NO_THROW(data.editor().apply(edit::Fill{{{0, 0, 0}, {99, 99, 99}}, 8}));
    EXPECT_LE(data.streaming().most_bytes, std::uint64_t{42} << 20);
}

TEST(Streamed, what_was_edited_is_saved_beside_the_original_and_opens_again) {
    const BallFile ball;
    Data data(load(ball.streamed()));
    const std::string out = (ball.folder.path() / "ball-edits.zarr").string();
    EXPECT_THROW(data.save(out, {}), std::invalid_argument) << "nothing was edited";
    const edit::Fill fill{{{60, 60, 60}, {70, 64, 99}}, 0};
    data.editor().apply(fill);
    EXPECT_THROW(data.check_save_name("ball.nrrd"), std::invalid_argument);
    EXPECT_TRUE(data.editor().state().changed);
    EXPECT_NE(data.save(out, {}).find("ball-edits.zarr"), std::string::npos);
    EXPECT_FALSE(data.editor().state().changed);
    const auto expected = edited(std::make_shared<const Samples>(ball.volume), fill);
    const LoadedVolume again = load(source_from({{"volume", out}}));
    ASSERT_TRUE(again.streamed);
    const Geometry& geometry = ball.volume.geometry();
    std::vector<std::byte> bytes(ball.volume.bytes());
    again.streamed->store->read(0, whole_box(geometry), bytes, {});
    const Volume whole = flattened(*expected.samples);
    EXPECT_EQ(std::memcmp(bytes.data(), whole.data(), bytes.size()), 0);
}

TEST(Streamed, what_was_saved_is_saved_under_another_name_too_and_so_is_an_undo) {
    const BallFile ball;
    Data data(load(ball.streamed()));
    const std::filesystem::path one = ball.folder.path() / "one.zarr",
                                two = ball.folder.path() / "two.zarr";
    const auto sample_in = [](const std::filesystem::path& saved) {
        std::vector<std::byte> sample(1);
        const LoadedVolume again = load(source_from({{"volume", saved.string()}}));
        again.streamed->store->read(0, {{60, 60, 60}, {60, 60, 60}}, sample, {});
        return std::to_integer<int>(sample[0]);
    };
    const int original = static_cast<int>(ball.volume.sample({60, 60, 60}));
    ASSERT_NE(original, 7);
    data.editor().apply(edit::Fill{{{60, 60, 60}, {70, 64, 99}}, 7});
    (void)data.save(one, {});
    (void)data.save(two, {});
    EXPECT_EQ(sample_in(two), 7);
    EXPECT_TRUE(data.is_edited());
    data.editor().undo();
    (void)data.save(one, {});
    EXPECT_EQ(sample_in(one), original);
    EXPECT_FALSE(data.is_edited());
}

TEST(Streamed, edits_are_rescued_where_the_working_folder_has_gone) {
    namespace fs = std::filesystem;
    const BallFile ball;
    const fs::path zarr = ball.folder.path() / "ball.zarr", sub = ball.folder.path() / "sub";
    stream::convert_to_zarr(*stream::store_of(ball.volume, "v"), 0, zarr, {});
    fs::create_directory(sub);
    const fs::path before = fs::current_path();
    fs::current_path(sub);
    Data data(load(source_from({{"volume", "../ball.zarr"}, {"level", "0"}})));
    data.editor().apply(edit::Fill{{{10, 10, 10}, {20, 20, 20}}, 3});
    fs::remove(sub);
    struct Stopped {};
    fs::create_directory(sub);
    ::setenv("TMPDIR", sub.c_str(), 1);
    EXPECT_THROW((void)data.rescue([](double) { throw Stopped{}; }), Stopped);
    EXPECT_TRUE(fs::is_empty(sub)) << "who stops it does not wait and leaves nothing behind";
    const fs::path kept = data.rescue();
    ::unsetenv("TMPDIR");
    fs::current_path(before);
    EXPECT_NO_THROW((void)load(source_from({{"volume", kept.string()}})));
    fs::remove_all(kept.parent_path());
}

TEST(Streamed, edits_of_an_original_that_was_replaced_are_not_saved_as_those_of_the_new_one) {
    namespace fs = std::filesystem;
    const BallFile ball;
    const fs::path zarr = ball.folder.path() / "ball.zarr", out = ball.folder.path() / "e.zarr";
    const auto put_original = [&](const std::string& name) {
        fs::remove_all(zarr);
        stream::convert_to_zarr(*stream::store_of(scenes::make_volume(name).volume, "v"), 0, zarr,
                                {});
    };
    put_original("sphere:64x64x64");
    Data data(load(source_from({{"volume", zarr.string()}, {"level", "0"}})));
    data.editor().apply(edit::Fill{{{10, 10, 10}, {20, 20, 20}}, 3});
    put_original("torus:64x64x64");
    EXPECT_THROW(data.save(out, {}), io::OutputError);
    const fs::path kept = data.rescue();
    EXPECT_THROW((void)load(source_from({{"volume", kept.string()}})), io::InputError);
    put_original("sphere:64x64x64");
    EXPECT_NO_THROW((void)load(source_from({{"volume", kept.string()}})));
    fs::remove_all(kept.parent_path());
}

TEST(Streamed, all_times_of_a_store_are_a_sequence) {
    const ScratchFolder folder;
    const std::string path = (folder.path() / "image.zarr").string();
    support::put_image(path);
    std::map<std::string, std::string> names{
        {"volume", path}, {"channel", "1"}, {"level", "1"}, {"all-times", "yes"}};
    const Source source = source_from(names);
    EXPECT_EQ(to_names(source), names);
    const LoadedVolume loaded = load(source);
    EXPECT_FALSE(loaded.streamed);
    EXPECT_EQ(loaded.sequence.times, (std::vector<double>{0, 1})) << "seconds, as the store says";
    EXPECT_EQ(loaded.sequence.period, 2);
    EXPECT_EQ(loaded.time_steps, 2);
    for (const int time : {0, 1}) {
        stream::StoreOptions options;
        options.channel = 1;
        options.time = time;
        const auto store = stream::open_store(path, options);
        const Volume expected = stream::read_level(*store, 1);
        const Volume frame = io::read_frame(loaded.sequence, time);
        ASSERT_EQ(frame.geometry(), expected.geometry());
        EXPECT_EQ(frame.geometry().size, Index3(16, 16, 16));
        EXPECT_EQ(std::memcmp(frame.data(), expected.data(), expected.bytes()), 0);
    }
    EXPECT_NE(
        std::memcmp(loaded.volume.data(), io::read_frame(loaded.sequence, 1).data(), 16 * 16 * 16),
        0);

    run::Setup setup = test::with_device("simulated:hand=explore,seconds=60");
    setup.playback.speed = 5;
    run::Run live(test::stepped_data(loaded, setup.playback), setup);
    const std::string recording = (folder.path() / "touch.csv").string();
    live.record(recording);
    live.start();
    EXPECT_TRUE(steps_until(live, [&] {
        const auto now = live.snapshot();
        return now && now->number > 500 && now->session.moment > 1;
    }));
    live.stop();
    live.stop_recording();
    EXPECT_GT(expect_same_again(recording), 0);

    names["time-step"] = "1";
    EXPECT_THROW(load(source_from(names)), std::invalid_argument);
    names.erase("time-step");
    names["memory"] = "200000000";
    EXPECT_THROW(load(source_from(names)), std::invalid_argument);
    names.erase("memory");
    names["level"] = "2";
    EXPECT_THROW(load(source_from(names)), std::invalid_argument);
    const BallFile ball;
    auto single = ball.names();
    single["all-times"] = "yes";
    EXPECT_THROW(load(source_from(single)), std::invalid_argument) << "one time";
}

TEST(Streamed, sources_keep_level_channel_and_memory_in_their_names) {
    const BallFile ball;
    auto names = ball.names();
    names["level"] = "0";
    const Source source = source_from(names);
    ASSERT_TRUE(std::holds_alternative<StoreSource>(source.from));
    EXPECT_EQ(to_names(source), to_names(source_from(to_names(source))));
    EXPECT_EQ(to_names(source).at("level"), "0");
    EXPECT_FALSE(to_names(source).contains("memory"));
    names["memory"] = "200000000";
    names["coarse-first"] = "yes";
    const Source bounded = source_from(to_names(source_from(names)));
    const stream::BrickLoaderSettings& loader = std::get<StoreSource>(bounded.from).loader;
    EXPECT_EQ(loader.memory, 200'000'000U);
    EXPECT_TRUE(loader.whole_process);
    EXPECT_TRUE(loader.coarse_first);
    names["level"] = "3";
    EXPECT_THROW(load(source_from(names)), std::invalid_argument);
    EXPECT_TRUE(std::holds_alternative<StoreSource>(
        source_from({{"volume", "https://example.org/a.zarr"}}).from));
    EXPECT_TRUE(std::holds_alternative<FileSource>(ball.whole().from)) << "a small file is read";
}

/// All threads of two runs on the same data at their real pace: servos, streamer, editor with a
/// brush, recordings, and commands from here.
TEST(PacedRun, of_a_store_touches_carves_and_its_recordings_repeat_bit_for_bit) {
    const BallFile ball;
    const auto data = std::make_shared<Data>(load(ball.streamed()));
    run::Run live(data, test::with_device("simulated:hand=explore,seconds=600"));
    run::Run other(data, test::with_device("mouse"));
    const std::string recording = (ball.folder.path() / "touch.csv").string();
    const std::string later = (ball.folder.path() / "later.csv").string();
    live.record(recording);
    live.start();
    other.start();
    EXPECT_THROW(live.step(), std::logic_error);
    VolumeEditor& editor = data->editor();
    editor.set_brush(usual_brush(ball.volume.geometry()));
    EXPECT_TRUE(test::comes_true([&] { return editor.state().version > 5; }))
        << "the hand carves: " << editor.state().problem;
    // Before undo(), after which the version is the first one again.
    EXPECT_TRUE(test::comes_true([&] {
        const auto now = other.snapshot();
        return now && now->session.version > 0;
    }));
    const double level = live.isovalue() + 1;
    live.send(command::Isovalue{level});
    EXPECT_TRUE(editor.undo());
    editor.set_brush({});
    EXPECT_TRUE(
        test::comes_true([&] { return live.snapshot()->session.tick.proxy.isovalue == level; }));
    EXPECT_TRUE(test::comes_true([&] { return live.recording()->ticks() > 100; }));
    EXPECT_GT(live.report().compute.count, 100U);
    live.record(later);
    EXPECT_TRUE(test::comes_true([&] { return live.recording()->ticks() > 100; }));
    live.stop();
    live.stop_recording();
    for (const std::string& path : {recording, later}) EXPECT_GT(expect_same_again(path), 100);
}

}  // namespace
}  // namespace palpate::run
