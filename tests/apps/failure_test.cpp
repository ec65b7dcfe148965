// Bad input, streams that cannot be written, and signals: one line, the right status, nothing left.
#include <poll.h>

#include "apps/program.hpp"
#include "palpate/io/trace.hpp"

namespace palpate::app::test {
namespace {

namespace fs = std::filesystem;
using support::bytes_of;
using support::put_bytes;

/// Every command that reads a volume refuses this one and writes nothing.
void expect_refused(const ScratchFolder& folder, const Words& volume, const std::string& reason) {
    put_trajectory(folder);
    fs::create_directory(folder / "results");
    for (const std::string command :
         {"info", "replay --trajectory t.csv -i 5 -o results/a.csv --path results/p.csv",
          "extract -i 5 -o results/a.ply", "demo -o results/demo"}) {
        const Outcome outcome = palpate(folder, words_of(command) + volume);
        expect_failure(outcome, 3, reason);
        EXPECT_TRUE(contains(outcome.err, volume[0])) << outcome.err;
    }
    EXPECT_TRUE(fs::is_empty(folder / "results"));
}

TEST(BadInput, that_is_no_volume_is_refused_with_what_is_wrong) {
    struct Case {
        std::string words, file, bytes, reason;
    };
    for (const Case& c :
         {Case{"missing.nrrd", "", "", "does not exist"},
          {"empty.nrrd", "empty.nrrd", "", "is empty"},
          {"text.nrrd", "text.nrrd", "Dear reader,\nthis is a letter.\n", "is not a NRRD file"},
          {"a.xyz", "a.xyz", "samples", "dims"},
          {"holiday", "holiday/a.txt", "x", "no DICOM or TIFF slices"},
          {"a.raw --dims 3x3x3 --type uint8", "a.raw", std::string(26, 'x'), "has 26 bytes"}}) {
        const ScratchFolder folder;
        fs::create_directories((folder / c.file).parent_path());
        if (!c.file.empty()) put_bytes(folder / c.file, c.bytes);
        expect_refused(folder, words_of(c.words), c.reason);
    }
}

TEST(BadInput, files_that_are_cut_short_are_refused) {
    const std::string nrrd = "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 4 4 4\nencoding: raw\n\n";
    const std::string mha =
        "ObjectType = Image\nNDims = 3\nDimSize = 4 4 4\nElementType = MET_UCHAR\n"
        "ElementDataFile = LOCAL\n";
    std::string nifti(352, '\0');
    const auto put16 = [&](std::size_t at, char value) { nifti[at] = value; };
    nifti[0] = '\x5C';  // 348
    nifti[1] = '\x01';
    for (const auto& [at, value] :
         {std::pair{40, 3}, {42, 4}, {44, 4}, {46, 4}, {70, 2}, {72, 8}}) {
        put16(std::size_t(at), char(value));
    }
    const float one = 1;
    const float offset = 352;
    for (const std::size_t at : {76, 80, 84, 88}) nifti.replace(at, 4, (const char*)&one, 4);
    nifti.replace(108, 4, reinterpret_cast<const char*>(&offset), 4);
    nifti.replace(344, 3, "n+1");
    for (const auto& [name, head] : {std::pair{"a.nrrd", nrrd}, {"a.mha", mha}, {"a.nii", nifti}}) {
        const ScratchFolder folder;
        std::string samples(64, '\1');
        samples[5] = '\7';
        put_bytes(folder / name, head + samples);
        EXPECT_EQ(palpate(folder, std::string("info ") + name).status, 0) << name;
        put_bytes(folder / name, head + samples.substr(0, 40));
        expect_refused(folder, {name}, name);
    }
}

TEST(BadInput, a_wrong_spacing_or_size_of_a_raw_file_is_wrong_use) {
    const ScratchFolder folder;
    put_bytes(folder / "a.raw", std::string(27, 'x'));
    const std::string raw = "info a.raw --type uint8 --dims ";
    for (const std::string words : {"0,1,1", "-1,1,1", "1,1", "nan,1,1"}) {
        expect_failure(palpate(folder, raw + "3x3x3 --spacing " + words), 2, "spacing " + words);
    }
    for (const std::string words : {"0x1x1", "3x3", "axbxc", "1.5x2x9", "-3x-3x3"}) {
        expect_failure(palpate(folder, raw + words), 2, "dims " + words);
    }
    expect_failure(palpate(folder, "info a.raw --dims 3x3x3"), 2, "type");
    succeeds(folder, raw + "3x3x3");
}

TEST(BadInput, a_refused_trajectory_is_named_with_its_line) {
    const ScratchFolder folder;
    const std::pair<std::string, std::string> cases[] = {
        {"t,x,y,z\n0,1,2,3\n# note\n1,2,three,4\n", "line 4: 'three'"},
        {"t,x,y,z\n0,1,2,3\n0,1,2,3\n", "line 3: the time '0'"},
        {"t,x,y,z\n0,1,2,nan\n", "line 2: 'nan'"},
        {"t,x,y,z\n0,1,2\n", "line 2: there are 3 cells"},
        {"t;x;y;z\n0;1;2;3\n", "no column 't'"},
        {"t,x,y\n0,1,2\n", "no column 'z'"},
        {"t,x,y,z\n", "no rows"},
        {"", "is empty"},
        {std::string("\0\1\2", 3), "not a text file"}};
    for (const auto& [text, reason] : cases) {
        put_bytes(folder / "t.csv", text);
        const Outcome outcome =
            palpate(folder, "replay synthetic:sphere:9x9x9 --trajectory t.csv -o a.csv");
        expect_failure(outcome, 3, reason);
        EXPECT_TRUE(contains(outcome.err, "t.csv")) << outcome.err;
    }
    expect_failure(palpate(folder, "replay synthetic:sphere --trajectory no.csv -o a.csv"), 3,
                   "no.csv: cannot be opened");
    expect_failure(palpate(folder, "replay synthetic:sphere --trajectory . -o a.csv"), 3,
                   "is a folder");
    EXPECT_EQ(folder.names(), std::vector<std::string>{"t.csv"});
}

TEST(BadOutput, standard_output_that_is_closed_or_full_is_a_failure) {
    const MotionFolder folder;
    for (const std::string line :
         {"--help", "--version", "info --help", "info synthetic:noise:9x9x9",
          "info synthetic:noise --json", "extract synthetic:sphere:9x9x9 -o a.ply",
          "replay synthetic:sphere:24x24x24 --trajectory t.csv -o a.csv",
          "replay synthetic:sphere:24x24x24 --trajectory t.csv -o -",
          "demo synthetic:sphere:9x9x9 --duration 0.1 --picture 120"}) {
        for (const Stdout to : {Stdout::closed, Stdout::full}) {
            const Outcome outcome = palpate(folder, line, to);
            EXPECT_EQ(outcome.status, 5) << line;
            EXPECT_TRUE(is_one_line(outcome.err) && contains(outcome.err, "standard output"))
                << line << ": " << outcome.err;
        }
    }
    // The other requested output is whole all the same.
    EXPECT_EQ(io::read_trace(folder / "a.csv").size(), 6U);
}

TEST(BadOutput, standard_error_that_is_full_or_closed_loses_words_only) {
    const MotionFolder folder;
    for (const std::string line :
         {"info synthetic:noise:9x9x9", "extract synthetic:sphere:9x9x9 -i 1e9 -o a.ply",
          "replay synthetic:sphere:24x24x24 -i 1e9 --trajectory t.csv -o a.csv",
          "touch synthetic:sphere:24x24x24 -i 1e9 --device simulated:hand=press --unpaced "
          "--seconds 0.1 --record r.csv"}) {
        const Outcome usual = palpate(folder, line);
        for (const char* where : {"2>/dev/full", "2>&-"}) {
            const std::string command = "exec \"$0\" " + line + " " + where + " </dev/null";
            std::filesystem::remove(folder / "r.csv");
            const Outcome outcome = by_bash(folder, command);
            EXPECT_EQ(outcome.status, usual.status) << command;
            EXPECT_EQ(outcome.status, 0) << command;
        }
    }
    succeeds(folder, "replay r.csv --validate");
}

TEST(BadOutput, a_reader_that_has_gone_leaves_no_temporary_file) {
    const ScratchFolder folder;
    // More than a pipe holds, so that the program still writes when the reader ends.
    std::string motion = "t,x,y,z\n";
    for (int i = 0; i < 5000; ++i) motion += std::to_string(0.001 * i) + ",-20,0.1,0.2\n";
    support::put_bytes(folder / "t.csv", motion);
    ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
    Running replay(
        words_of("replay synthetic:sphere:24x24x24 --trajectory t.csv -o pipe --path p.csv"),
        folder.path());
    const int reader = ::open((folder / "pipe").c_str(), O_RDONLY);
    ::close(reader);
    expect_failure(replay.finish(), 5, "has ended");
    EXPECT_EQ(folder.names(), (std::vector<std::string>{"pipe", "t.csv"}));
}

TEST(BadInput, without_an_end_is_refused) {
    const MotionFolder folder;
    const std::string replay = "replay synthetic:sphere:24x24x24 -o a.csv --trajectory ";
    expect_failure(palpate(folder, replay + "/dev/zero"), 3, "/dev/zero: is not a text file");
    const std::string touch = "touch synthetic:sphere:24x24x24 --seconds 1 ";
    expect_failure(palpate(folder, touch + "--commands /dev/zero"), 3, "/dev/zero: is not a text");
    expect_failure(palpate(folder, touch + "--device recorded:file=/dev/zero"), 3, "is not a text");
    expect_failure(palpate(folder, "replay --validate /dev/zero"), 3, "/dev/zero: is not a text");
    EXPECT_EQ(folder.names(), std::vector<std::string>{"t.csv"});
}

class Wait : public testing::TestWithParam<const char*> {};

TEST_P(Wait, for_a_pipe_without_a_writer_ends_with_a_signal) {
    const ScratchFolder folder;
    ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
    put_trajectory(folder);
    for (const int signal : {SIGTERM, SIGINT, SIGHUP}) {
        Running program(words_of(GetParam()), folder.path());
        ASSERT_TRUE(comes_true([&] { return program.catches(signal); }));
        ASSERT_TRUE(comes_true([&] { return program.waits_with(folder / "pipe"); }));
        const Outcome outcome = program.finish(signal);
        EXPECT_GE(outcome.status, 128) << outcome.err;
        EXPECT_LT(outcome.status, 160) << outcome.err;
        EXPECT_TRUE(contains(outcome.err, "interrupted")) << outcome.err;
        EXPECT_EQ(folder.names(), (std::vector<std::string>{"pipe", "t.csv"}));
    }
}

INSTANTIATE_TEST_SUITE_P(
    , Wait,
    testing::Values("replay synthetic:sphere:24x24x24 -o a.csv --trajectory pipe",
                    "replay --validate pipe",
                    "touch synthetic:sphere:24x24x24 --seconds 1 --commands pipe",
                    "touch synthetic:sphere:24x24x24 --seconds 1 --device recorded:file=pipe",
                    "render synthetic:sphere:24x24x24 -o a.png --path pipe"));

TEST(BadOutput, a_recordings_reader_that_does_not_read_is_not_waited_for_after_a_second_signal) {
    const ScratchFolder folder;
    ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
    Running touch(words_of("touch synthetic:sphere:24x24x24 --headless --quiet --record pipe"),
                  folder.path());
    const int reader = ::open((folder / "pipe").c_str(), O_RDONLY);
    const int other = ::open((folder / "pipe").c_str(), O_WRONLY | O_NONBLOCK);
    EXPECT_TRUE(comes_true([&] {
        pollfd room{other, POLLOUT, 0};
        return ::poll(&room, 1, 0) == 0;
    }));
    EXPECT_TRUE(comes_true([&] {
        touch.signal(SIGINT);
        return touch.has_ended();
    }));
    expect_failure(touch.finish(), 5, "not waited for");
    ::close(reader);
    ::close(other);
}

TEST(BadOutput, on_a_disk_that_is_full_for_the_path_leaves_no_trace) {
    const MotionFolder folder;
    put_bytes(folder / "a.csv", "old");
    // One row a tick, but many corners: within the limit of 2 KiB a file the trace fits, the path
    // does not.
    put_bytes(folder / "t.csv",
              "t,x,y,z\n0,-20,0.1,0.2\n0.001,-5,0.1,0.2\n0.002,5,9,0.2\n0.003,5,-9,0.2\n"
              "0.004,5,9,0.2\n0.005,5,-9,0.2\n");
    const Outcome outcome =
        by_bash(folder,
                "ulimit -f 2; exec \"$0\" replay synthetic:sphere:64x64x64 --trajectory t.csv -o "
                "a.csv --path p.csv");
    expect_failure(outcome, 5, "p.csv: could not be written: File too large");
    EXPECT_EQ(folder.names(), (std::vector<std::string>{"a.csv", "t.csv"}));
    EXPECT_EQ(support::bytes_of(folder / "a.csv"), "old");
}

TEST(BadOutput, of_a_recording_on_a_full_disk_is_told_once) {
    const ScratchFolder folder;
    const Outcome outcome =
        by_bash(folder,
                "ulimit -f 32; exec \"$0\" touch synthetic:sphere:24x24x24 --unpaced -q --device "
                "simulated:hand=hold --seconds 2 --record r.csv");
    EXPECT_EQ(outcome.status, 5);
    const auto told = outcome.err.find("recording stopped");
    EXPECT_NE(told, std::string::npos) << outcome.err;
    EXPECT_EQ(outcome.err.find("recording stopped", told + 1), std::string::npos) << outcome.err;
    EXPECT_TRUE(contains(outcome.err, "r.csv: is not complete")) << outcome.err;
}

TEST(BadOutput, names_places_that_cannot_be_written) {
    const MotionFolder folder;
    fs::create_directory(folder / "folder");
    const auto before = folder.names();
    const std::string replay = "replay synthetic:sphere:24x24x24 --trajectory t.csv -o ";
    expect_failure(palpate(folder, replay + "missing/a.csv"), 5, "missing does not exist");
    expect_failure(palpate(folder, replay + "folder"), 5, "is a folder");
    expect_failure(palpate(folder, replay + "folder/"), 5, "is a folder");
    expect_failure(palpate(folder, replay + "t.csv/a.csv"), 5, "t.csv");
    expect_failure(palpate(folder, replay + "/dev/full"), 5, "No space left");
    expect_failure(palpate(folder, replay + "a.csv --path missing/p.csv"), 5, "missing");
    expect_failure(palpate(folder, replay + "a.csv --path /dev/full"), 5, "No space left");
    EXPECT_EQ(folder.names(), before);
}

class Signal : public testing::TestWithParam<int> {
  protected:
    void expect_interrupted(Running& program, const ScratchFolder& folder,
                            const std::vector<std::string>& left) {
        const Outcome outcome = program.finish(GetParam());
        expect_failure(outcome, 128 + GetParam(), "interrupted");
        // A killed reader is gone a moment later than its parent knows.
        EXPECT_TRUE(comes_true([&] { return !program.left_a_process(); }));
        EXPECT_EQ(folder.names(), left);
    }
};

bool has_part(const fs::path& folder) {
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(folder, error)) {
        if (contains(entry.path().filename().string(), ".part")) return true;
    }
    return false;
}

TEST_P(Signal, leaves_no_file_of_a_replay) {
    const ScratchFolder folder;
    std::string text = "t,x,y,z\n";
    for (int i = 0; i < 400'000; ++i) {
        text += std::to_string(i) + (i % 2 != 0 ? ",-20,0.1,0\n" : ",-5,0.1,0\n");
    }
    put_bytes(folder / "t.csv", text);
    Running replay(
        words_of("replay synthetic:sphere:24x24x24 --trajectory t.csv -o a.csv --path p.csv"),
        folder.path());
    ASSERT_TRUE(comes_true([&] { return has_part(folder.path()); }));
    expect_interrupted(replay, folder, {"t.csv"});
}

TEST_P(Signal, leaves_no_file_of_an_extraction) {
    const ScratchFolder folder;
    Running extract(words_of("extract synthetic:noise:160x160x160 -o a.ply"), folder.path());
    ASSERT_TRUE(comes_true([&] { return extract.catches(GetParam()); }));
    expect_interrupted(extract, folder, {});
}

TEST_P(Signal, ends_what_is_done_to_large_volumes_in_memory) {
    const ScratchFolder folder;
    const std::string small = "info synthetic:marschner-lobb:256x256x256 ";
    for (const std::string& command :
         {std::string("info synthetic:marschner-lobb:1024x1024x1024"), small + "--smooth 64",
          small + "--dequantize=1000 --smooth 64 --prefilter"}) {
        Running info(words_of(command), folder.path());
        ASSERT_TRUE(comes_true([&] { return info.catches(GetParam()); }));
        expect_interrupted(info, folder, {});
    }
}

TEST_P(Signal, leaves_no_folder_of_a_demo) {
    const ScratchFolder folder;
    Running demo(words_of("demo synthetic:sphere:24x24x24 --duration 100 -o out"), folder.path());
    ASSERT_TRUE(comes_true([&] { return has_part(folder / "out"); }));
    expect_interrupted(demo, folder, {});
}

TEST_P(Signal, ends_the_reader_too_while_a_file_is_read) {
    const ScratchFolder folder;
    put_bytes(folder / "a.nii", std::string(1000, 'x'));
    put_bytes(folder / "slow-reader", "#!/bin/sh\ntouch reading\nexec sleep 100\n");
    fs::permissions(folder / "slow-reader", fs::perms::owner_all);
    ::setenv("PALPATE_IO_HELPER", (folder / "slow-reader").c_str(), 1);
    put_bytes(folder / "a.stl", std::string(1000, 'x'));
    const std::string touch = "touch synthetic:sphere:24x24x24 --headless --seconds 1 ";
    for (const std::string& command :
         {std::string("info a.nii"), touch + "--tool a.stl", touch + "--labels a.nii"}) {
        ::setenv("PALPATE_IO_HELPER", (folder / "slow-reader").c_str(), 1);
        Running reader(words_of(command), folder.path());
        ::unsetenv("PALPATE_IO_HELPER");
        ASSERT_TRUE(comes_true([&] { return fs::exists(folder / "reading"); }));
        expect_interrupted(reader, folder, {"a.nii", "a.stl", "reading", "slow-reader"});
        fs::remove(folder / "reading");
    }
}

INSTANTIATE_TEST_SUITE_P(Failure, Signal, testing::Values(SIGINT, SIGTERM),
                         [](const auto& test) { return test.param == SIGINT ? "INT" : "TERM"; });

}  // namespace
}  // namespace palpate::app::test
