// Data that change, from the command line: edits, sequences and live sources in live sessions, and
// the demos of them.
#include <csignal>
#include <numeric>
#include <regex>

#include "apps/program.hpp"
#include "palpate/io/live_file.hpp"
#include "palpate/io/recording.hpp"
#include "palpate/io/trace.hpp"
#include "palpate/io/volume_file.hpp"
#include "support/png.hpp"

namespace palpate::app::test {
namespace {

using support::bytes_of;
using support::put_bytes;

const std::string ball = "synthetic:sphere:32x32x32";

TEST(Touch, recordings_of_edits_and_sequences_replay_bit_for_bit) {
    const ScratchFolder folder;
    put_bytes(folder / "c.txt",
              "0.2 brush carve 4 50\n0.8 brush off\n0.9 undo\n1.0 redo\n"
              "1.1 carve 0,0,0:3,3,3 5\n1.2 fill 1,1,1:4,4,4 90%\n");
    succeeds(folder, "touch " + ball +
                         " --unpaced --device simulated:hand=press --seconds 2.5 "
                         "--commands c.txt --record r.csv --save out.nrrd");
    succeeds(folder, "replay r.csv --validate");
    const Volume saved = io::read_volume(folder / "out.nrrd").volume;
    EXPECT_EQ(saved.geometry().size, Index3(32, 32, 32));
    EXPECT_EQ(saved.sample({16, 16, 16}), 0);
    EXPECT_NEAR(saved.sample({2, 2, 2}), 0.9 * 240, 12);
    // The recording has every edit in order: strokes of the brush, undo and redo, the stroke and
    // the box of the commands. It ends on the last version.
    std::string edits;
    std::uint64_t made = 0, felt = 0;
    io::RecordingReader reader(folder / "r.csv");
    while (const auto event = reader.next()) {
        if (const auto* tick = std::get_if<SessionTick>(&*event)) felt = tick->version;
        const auto* command = std::get_if<Command>(&*event);
        const auto* samples = command ? std::get_if<command::Samples>(command) : nullptr;
        if (!samples) continue;
        if (!samples->recipe) {
            edits += '-';  // a version that there was before
            continue;
        }
        const Edit& edit = std::get<EditOf>(*samples->recipe).edit;
        edits += std::holds_alternative<edit::Fill>(edit) ? 'f' : 's';
        made = samples->version;
    }
    EXPECT_TRUE(std::regex_match(edits, std::regex("s+--sf"))) << edits;
    EXPECT_EQ(felt, made);

    succeeds(folder,
             "touch synthetic:beating:24x24x24 --unpaced --device simulated:hand=press --seconds 1 "
             "--playback 3 --record b.csv");
    succeeds(folder, "replay b.csv --validate");
}

TEST(ChangingData, edits_are_saved_although_the_session_fails) {
    const ScratchFolder folder;
    // A line on standard error that cannot be written ends the session: a log on a full disk.
    std::filesystem::create_symlink("/dev/full", folder / "full.nrrd");
    put_bytes(folder / "c.txt", "0.1 fill 1,1,1:4,4,4 90%\n0.5 save full.nrrd\n");
    const Outcome done =
        by_bash(folder, "exec \"$0\" touch -q " + ball +
                            " --unpaced --device simulated:hand=press --seconds 2 --commands c.txt "
                            "--save out.nrrd 2>/dev/full");
    EXPECT_NE(done.status, 0);
    EXPECT_GT(io::read_volume(folder / "out.nrrd").volume.sample({2, 2, 2}), 200);
}

TEST(Touch, a_saved_raw_or_tiff_file_opens_with_the_options_that_it_names) {
    const ScratchFolder folder;
    Geometry geometry{Index3::Constant(8)};
    geometry.spacing = Vec3(0.5, 0.5, 2);
    std::vector<std::uint16_t> samples(512);
    std::iota(samples.begin(), samples.end(), 100);
    io::write_volume(Volume(geometry, std::move(samples)), folder / "a.tif");
    put_bytes(folder / "c.txt", "0.1 fill 1,1,1:4,4,4 9\n0.2 save b.tif\n0.4 quit\n");
    const Outcome done =
        succeeds(folder,
                 "touch a.tif --unpaced --isovalue 300 --device simulated:hand=hold "
                 "--commands c.txt --save b.raw");
    EXPECT_TRUE(
        contains(done.out, "saved b.raw (open it with dims 8x8x8, type uint16, spacing 0.5,0.5,2)"))
        << done.out;
    const Outcome raw =
        succeeds(folder, "info b.raw --dims 8x8x8 --type uint16 --spacing 0.5,0.5,2");
    const Volume tiff = io::read_volume(folder / "b.tif").volume;
    EXPECT_EQ(tiff.sample({2, 2, 2}), 9);
    EXPECT_EQ(tiff.sample({7, 7, 7}), 611);
    geometry.oriented = false;
    EXPECT_EQ(tiff.geometry(), geometry);
    EXPECT_EQ(bytes_of(folder / "b.raw"),
              std::string(static_cast<const char*>(tiff.data()), tiff.bytes()));
}

TEST(Touch, plays_a_numbered_series_and_opens_one_frame_of_it) {
    const ScratchFolder folder;
    for (const int number : {1, 2, 4}) {
        const Volume frame({Index3::Constant(12)},
                           std::vector<std::uint8_t>(1728, std::uint8_t(20 * number)));
        io::write_volume(frame, folder / ("f_00" + std::to_string(number) + ".nrrd"));
    }
    succeeds(folder, Words{"touch", "f_%03d.nrrd", "--unpaced", "--isovalue", "200",
                           "--frame-interval", "0.1", "--device", "simulated:hand=hold",
                           "--seconds", "2", "--once", "--record", "r.csv"});
    double last = 0;
    io::RecordingReader reader(folder / "r.csv");
    while (const auto event = reader.next()) {
        if (const auto* tick = std::get_if<SessionTick>(&*event)) last = tick->moment;
    }
    EXPECT_NEAR(last, 0.3, 1e-9) << "one is missing: time goes on";
    const Outcome one = palpate(folder, Words{"info", "f_%03d.nrrd", "--time-step", "2", "--json"});
    EXPECT_TRUE(contains(one.out, "80")) << one.out;
    expect_failure(palpate(folder, Words{"info", "f_%03d.nrrd", "--time-step", "3"}), 3,
                   "no time step 3");
}

TEST(Touch, says_which_commands_the_data_do_not_allow) {
    const ScratchFolder folder;
    put_bytes(folder / "c.txt", "0.1 undo\n0.3 quit\n");
    const Outcome still = succeeds(
        folder, "touch " + ball + " --unpaced --device simulated:hand=hold --commands c.txt");
    EXPECT_TRUE(contains(still.err, "nothing to undo")) << still.err;
    const auto expect_refusal = [&](const std::string& volume, const std::string& line,
                                    const std::string& why) {
        put_bytes(folder / "c.txt", line + "\n");
        expect_failure(palpate(folder, "touch " + volume + " --commands c.txt"), 3, why);
    };
    const std::string sequence = "synthetic:beating:16x16x16";
    for (const char* line : {"0 brush carve 3", "0 brush off", "0 fill 1,1,1 5", "0 redo"}) {
        expect_refusal(sequence, line, "cannot be edited");
    }
    for (const char* line : {"0 play 2", "0 pause", "0 seek 1", "0 step", "0 loop on"}) {
        expect_refusal(ball, line, "no sequence");
    }
    for (const char* line :
         {"0 brush carve", "0 brush drill 3", "0 brush carve -3", "0 paint 1,2,3", "0 carve 1,2 3",
          "0 fill 1,1,1 300", "0 fill 1,1,1 -7.4", "0 fill 1,1 5", "0 fill 1.5,1,1 5",
          "0 fill 99,1,1 5", "0 fill -3,0,0:-1,9,9 5", "0 save", "0 save o.png"}) {
        expect_refusal(ball, line, "c.txt, line 1");
    }
    for (const char* line : {"0 seek", "0 loop maybe", "0 play inf", "0 seek nan"}) {
        expect_refusal(sequence, line, "c.txt, line 1");
    }
    expect_failure(palpate(folder, Words{"touch", ball, "--brush", "carve"}), 2,
                   "brush KIND RADIUS");
    expect_failure(palpate(folder, "touch live:nothing.live"), 3, "nothing.live");
    expect_failure(palpate(folder, Words{"touch", ball, "--save", "o.png"}), 2, "o.png");
    Geometry moved{Index3::Constant(3)};
    moved.origin = Vec3(0, 0, 1);
    std::vector<std::uint8_t> ramp(27);
    std::iota(ramp.begin(), ramp.end(), std::uint8_t(0));
    io::write_volume(Volume(moved, std::move(ramp)), folder / "moved.nrrd");
    // Found out before there is anything to lose.
    expect_failure(palpate(folder, Words{"touch", "moved.nrrd", "--save", "o.tif"}), 2,
                   "no origin and no directions");
}

TEST(Touch, an_edit_that_fails_gives_status_5_and_what_could_be_done_is_saved) {
    const ScratchFolder folder;
    put_bytes(folder / "v.raw", std::string(std::size_t{256} * 256 * 256, '\0'));
    put_bytes(folder / "c.txt", "0.1 fill 1,1,1:3,3,3 9\n0.2 fill 0,0,0:255,255,255 1\n");
    const Outcome done = palpate(
        folder,
        "touch v.raw --dims 256x256x256 --type uint8 --memory 32MB --unpaced -i 5 --seconds 0.3 "
        "--device simulated:hand=hold --commands c.txt --save out.zarr");
    EXPECT_EQ(done.status, 5);
    EXPECT_TRUE(contains(done.err, "palpate: the edits take more than 8 MB")) << done.err;
    EXPECT_EQ(palpate(folder, "convert out.zarr out.nrrd").status, 0);
    const Volume saved = io::read_volume(folder / "out.nrrd").volume;
    EXPECT_EQ(saved.sample({2, 2, 2}), 9);
    EXPECT_EQ(saved.sample({4, 4, 4}), 0);
}

TEST(Touch, an_edit_of_the_last_moment_is_felt_and_recorded_if_it_is_saved) {
    const ScratchFolder folder;
    put_bytes(folder / "c.txt", "0.1 fill 1,1,1 7\n0.3 fill 5,5,5 8\n9 fill 6,6,6 8\n");
    const std::string touch = "touch " + ball +
                              " --unpaced --device simulated:hand=hold --seconds 0.3 --commands "
                              "c.txt -q --record r.csv";
    const Outcome done = palpate(folder, touch + " --save out.nrrd");
    EXPECT_EQ(done.status, 0) << done.err;
    EXPECT_TRUE(contains(done.err, "1 command was not carried out before the end")) << done.err;
    const Volume saved = io::read_volume(folder / "out.nrrd").volume;
    EXPECT_EQ(saved.sample({5, 5, 5}), 8);
    EXPECT_NE(saved.sample({6, 6, 6}), 8);
    const Outcome again = palpate(folder, "replay r.csv --validate");
    EXPECT_TRUE(contains(again.out, "2 commands")) << again.out;
    std::filesystem::remove(folder / "r.csv");
    EXPECT_TRUE(contains(palpate(folder, touch).err, "the edits were not saved"));
}

/// The first sample that was filled, in the file that the message names, which is removed.
double rescued_sample(const Outcome& done) {
    const std::string words = "the edits are kept in ";
    const auto at = done.err.find(words);
    if (at == std::string::npos) return -1;
    const auto begin = at + words.size();
    const std::filesystem::path kept = done.err.substr(begin, done.err.find('\n', begin) - begin);
    const double sample = io::read_volume(kept).volume.sample({2, 2, 2});
    std::filesystem::remove_all(kept.parent_path());
    return sample;
}

TEST(Touch, a_volume_that_cannot_be_saved_gives_status_5_and_the_session_goes_on) {
    const ScratchFolder folder;
    std::filesystem::create_symlink("/dev/full", folder / "full.nrrd");
    put_bytes(folder / "c.txt", "0.1 fill 1,1,1:4,4,4 9\n0.2 save full.nrrd\n0.4 quit\n");
    const Outcome done = palpate(
        folder, "touch " + ball +
                    " --unpaced --device simulated:hand=hold --commands c.txt --record r.csv");
    EXPECT_EQ(done.status, 5);
    EXPECT_TRUE(contains(done.err, "/dev/full: could not be written")) << done.err;
    EXPECT_EQ(rescued_sample(done), 9);
    succeeds(folder, "replay r.csv --validate");
}

TEST(Touch, edits_that_cannot_be_saved_at_the_end_are_kept_elsewhere_and_the_recording_too) {
    const ScratchFolder folder;
    // The name is free when the session begins, and not when it ends.
    put_bytes(folder / "c.txt",
              "0.1 fill 1,1,1:4,4,4 9\n0.2 save o.zarr\n0.3 fill 1,1,1:4,4,4 8\n0.4 quit\n");
    const Outcome done = palpate(folder, "touch " + ball +
                                             " --unpaced --device simulated:hand=hold "
                                             "--commands c.txt --record r.csv --save o.zarr");
    EXPECT_EQ(done.status, 5);
    EXPECT_TRUE(contains(done.err, "o.zarr: is there already")) << done.err;
    EXPECT_EQ(rescued_sample(done), 8);
    succeeds(folder, "replay r.csv --validate");
}

TEST(Touch, an_output_that_cannot_be_is_refused_before_the_session) {
    const ScratchFolder folder;
    std::filesystem::create_directory(folder / "folder");
    put_bytes(folder / "file", "x");
    const Words touch{"touch", ball, "--unpaced", "--device", "simulated:hand=hold"};
    for (const auto& [name, reason] :
         {std::pair{"none/o.nrrd", "does not exist"},
          {"file/o.nrrd", "is not a folder"},
          {"/proc/o.nrrd",
           "/proc/o.nrrd: cannot be written"},  // root may write, but not make files
          {"/proc/o.zarr", "/proc/o.zarr: cannot be written"}}) {
        SCOPED_TRACE(name);
        expect_failure(palpate(folder, touch + Words{"--save", name}), 5, reason);
        put_bytes(folder / "c.txt", std::string("0.1 fill 1,1,1 9\n0.2 save ") + name + "\n");
        const Outcome command = palpate(folder, touch + Words{"--commands", "c.txt", "--quiet"});
        expect_failure(command, 5, reason);
        EXPECT_TRUE(contains(command.err, "c.txt, line 2")) << command.err;
        if (std::filesystem::path(name).extension() == ".zarr") continue;
        expect_failure(palpate(folder, touch + Words{"--record", name}), 5, reason);
    }
    std::filesystem::create_directory(folder / "folder.nrrd");
    expect_failure(palpate(folder, Words{"touch", ball, "--save", "folder.nrrd"}), 5,
                   "is a folder");
    for (const std::string name : {"folder.zarr", "none/o.zarr"}) {
        if (name == "folder.zarr") std::filesystem::create_directory(folder / name);
        expect_failure(palpate(folder, Words{"touch", ball, "--save", name}), 5, name);
    }
}

TEST(Touch, a_file_in_use_is_not_saved_over) {
    const ScratchFolder folder;
    succeeds(folder, "convert " + ball + " -q in.nrrd");
    put_bytes(folder / "detached.nhdr",
              "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 24 24 24\nspacings: 1 1 1\n"
              "encoding: raw\ndata file: detached.raw\n");
    std::string samples(24 * 24 * 24, 0);
    std::fill(samples.begin(), samples.begin() + 24 * 24 * 12, char{100});
    put_bytes(folder / "detached.raw", samples);
    const auto save_as = [&](const std::string& name, const std::string& volume) {
        std::filesystem::remove(folder / "rec.nrrd");
        put_bytes(folder / "c.txt", "0.02 fill 0,0,0:5,5,5 7\n0.05 save " + name + "\n");
        return palpate(folder, "touch " + volume +
                                   " -i 50% --device simulated:hand=press --unpaced "
                                   "--seconds 0.1 --commands c.txt --record rec.nrrd");
    };
    for (const auto& [name, volume] : {std::pair{"in.nrrd", "in.nrrd"},
                                       {"rec.nrrd", "in.nrrd"},
                                       {"detached.nhdr", "detached.nhdr"}}) {
        SCOPED_TRACE(name);
        const std::string before = bytes_of(folder / volume);
        const Outcome outcome = save_as(name, volume);
        EXPECT_EQ(outcome.status, 5);
        EXPECT_TRUE(contains(outcome.err, "in use")) << outcome.err;
        EXPECT_EQ(bytes_of(folder / volume), before);
    }
    expect_failure(save_as("detached.raw", "detached.nhdr"), 5, "in use");
    EXPECT_EQ(bytes_of(folder / "detached.raw"), samples);
    EXPECT_EQ(save_as("out.nrrd", "in.nrrd").status, 0);
}

TEST(PacedTouch, feels_frames_that_another_program_pushes) {
    const ScratchFolder folder;
    Geometry geometry;
    geometry.size = Index3::Constant(8);
    io::LiveWriter writer(folder / "feed.live", geometry, SampleType::uint8, 0.02);
    double time = 0;
    const auto push = [&](int value) {
        writer.push(Volume(geometry, std::vector<std::uint8_t>(512, std::uint8_t(value))),
                    time += 0.02);
    };
    push(1);
    Running session(words_of("touch live:feed.live --isovalue 250 --device simulated:hand=hold "
                             "--record r.csv"),
                    folder.path());
    // From before it looks until it has felt some, however long that takes.
    const std::regex more_than_ten(R"("samples":\{"version":(1[1-9]|[2-9]\d|\d{3}))");
    const auto has_felt = [&] {
        return std::regex_search(bytes_of(folder / "r.csv"), more_than_ten);
    };
    for (int i = 0; !session.has_ended() && !has_felt(); ++i) {
        push(2 + i % 200);
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    const Outcome done = session.finish(SIGINT);
    ASSERT_EQ(done.status, 130) << done.err;
    std::uint64_t versions = 0;
    double before = 0;
    io::RecordingReader reader(folder / "r.csv");
    while (const auto event = reader.next()) {
        const auto* tick = std::get_if<SessionTick>(&*event);
        if (!tick) continue;
        versions = tick->version;
        EXPECT_GE(tick->moment, before);
        before = tick->moment;
    }
    EXPECT_GT(versions, 10U);
    // Samples from outside are not in the recording, and the command says so.
    expect_failure(palpate(folder, "replay r.csv --validate"), 3, "from outside");
}

TEST(Demo, sculpt_carves_what_it_feels_and_shows_it) {
    const ScratchFolder folder;
    succeeds(folder,
             "demo sculpt synthetic:sphere:32x32x32 --duration 1 --pictures 3 "
             "--picture 160 --radius 3 -o out");
    const Volume edited = io::read_volume(folder / "out" / "edited.nrrd").volume;
    EXPECT_EQ(edited.geometry().size, Index3(32, 32, 32));
    int felt = 0;
    for (const io::TraceRow& row : io::read_trace(folder / "out" / "trace.csv")) {
        felt += row.constrained && row.force.norm() > 0;
    }
    EXPECT_GT(felt, 50) << "it carves only what it touches";
    EXPECT_TRUE(contains(bytes_of(folder / "out" / "animation.png"), "acTL"));
    EXPECT_GT(support::png_from(bytes_of(folder / "out" / "surface.png")).colours(), 20U);
}

TEST(Demo, beating_feels_each_beat) {
    const ScratchFolder folder;
    succeeds(folder,
             "demo beating synthetic:beating:32x32x32 --beats 3 --pictures 3 --picture 160 -o out");
    int rises = 0;
    bool high = false;
    for (const io::TraceRow& row : io::read_trace(folder / "out" / "trace.csv")) {
        const double force = row.force.norm();
        if (!high && force > 1.2) ++rises;
        high = high ? force > 0.8 : force > 1.2;
    }
    EXPECT_GE(rises, 3);
    expect_failure(palpate(folder, "demo beating synthetic:sphere"), 2, "no sequence");
}

}  // namespace
}  // namespace palpate::app::test
