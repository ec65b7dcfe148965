// Options that do nothing beside the others say so in one line, and a reader that has enough ends a
// pipe without a word.
#include "apps/program.hpp"

namespace palpate::app::test {
namespace {

constexpr const char* small_ball = "synthetic:sphere:16x16x16";

struct Ineffective {
    std::string words, warning;
    friend std::ostream& operator<<(std::ostream& out, const Ineffective& c) {
        return out << '\'' << c.words << '\'';
    }
};

class NoEffect : public testing::TestWithParam<Ineffective> {};

TEST_P(NoEffect, is_told_in_one_line_and_the_work_goes_on) {
    const MotionFolder folder;
    succeeds(folder, std::string("convert ") + small_ball + " still.nrrd");
    support::put_bytes(folder / "tool.csv", "x,y,z\n0,0,0\n1,0,0\n0,1,0\n");
    std::string line = GetParam().words;
    for (auto at = line.find("BALL"); at != std::string::npos; at = line.find("BALL")) {
        line.replace(at, 4, small_ball);
    }
    const Outcome outcome = succeeds(folder, line);
    EXPECT_TRUE(contains(outcome.err, "palpate: warning: " + GetParam().warning)) << outcome.err;
    EXPECT_EQ(std::ranges::count(outcome.err, '\n'), 1) << outcome.err;
}

const std::string replaying = "replay BALL --trajectory t.csv -o a.csv -q ";
const std::string touching = "touch BALL --unpaced --seconds 0.05 -q ";

INSTANTIATE_TEST_SUITE_P(
    Options, NoEffect,
    testing::Values(
        Ineffective{touching + "--playback 2", "--playback does nothing: "},
        Ineffective{touching + "--once --sequence-memory 5",
                    "--once, --sequence-memory do nothing: "},
        Ineffective{touching + "--normal-priority", "--normal-priority does nothing: "},
        Ineffective{"info still.nrrd --frame-interval 2",
                    "--frame-interval does nothing: still.nrrd"},
        Ineffective{"info still.nrrd --time-step 0", "--time-step does nothing: "},
        Ineffective{"info still.nrrd --series 2", "--series does nothing: "},
        Ineffective{"info still.nrrd --byte-order big", "--byte-order does nothing: "},
        Ineffective{"info still.nrrd --channel 2", "--channel does nothing: "},
        Ineffective{"info still.nrrd --cache x --cache-size 1GB",
                    "--cache, --cache-size do nothing: "},
        Ineffective{"info BALL --memory 100MB --coarse-first",
                    "--memory, --coarse-first do nothing: "},
        Ineffective{"info BALL --level 1", "--level does nothing: "},
        Ineffective{"info BALL --forbidden-is-missing", "--forbidden-is-missing does nothing: "},
        Ineffective{"extract BALL -o a.ply --tolerance 0.1 --field linear",
                    "--tolerance does nothing: "},
        Ineffective{"convert still.nrrd a.nrrd -q --series 1", "--series does nothing: still.nrrd"},
        Ineffective{"convert still.nrrd a.nrrd -q --frame-interval 2",
                    "--frame-interval does nothing: "},
        Ineffective{"convert BALL a.zarr -q --compress", "--compress does nothing: "},
        Ineffective{"convert BALL a.nii -q --compress", "--compress does nothing: .nii is never"},
        Ineffective{"convert BALL a.mha -q --chunk 8 --threads 2",
                    "--chunk, --threads do nothing: "},
        Ineffective{"render BALL -o a.png -q --stiffness 2", "--stiffness does nothing: "},
        Ineffective{"tool point --spacing 2", "--spacing does nothing: "},
        Ineffective{"tool tool.csv --spacing 2", "--spacing does nothing: "},
        Ineffective{replaying + "--tool-spacing 2", "--tool-spacing does nothing: "},
        Ineffective{replaying + "--wait", "--wait does nothing: synthetic:sphere:16x16x16 is in"},
        Ineffective{replaying + "--magnet 0,1", "--magnet does nothing: its distance is 0"},
        Ineffective{replaying + "--magnet 1,0", "--magnet does nothing: its peak is 0"},
        Ineffective{replaying + "--texture 0,3", "--texture does nothing: its amplitude is 0"},
        Ineffective{"info synthetic:beating:12x12x12 --time-step 1 --frame-interval 2",
                    "--frame-interval does nothing: synthetic:beating:12x12x12: a single frame"},
        Ineffective{replaying + "--rotational-stiffness 9 --torque-limit 9",
                    "--rotational-stiffness, --torque-limit do nothing: "},
        Ineffective{replaying + "--isovalue 90 --penetrability ranges --range 100:150",
                    "--isovalue does nothing: "},
        Ineffective{replaying + "--isovalue 90 --penetrability threshold --minimum 95",
                    "--isovalue does nothing: "},
        Ineffective{"demo --depth 3 sculpt BALL -q --duration 0.1 --pictures 2 --picture 64",
                    "--depth does nothing: "}));

TEST(NoEffect, says_nothing_of_options_that_have_one) {
    const MotionFolder folder;
    for (const std::string words :
         {"touch synthetic:beating:12x12x12 --unpaced --seconds 0.05 -q --playback 2 --once",
          "info synthetic:beating:12x12x12 --time-step 1",
          "extract synthetic:sphere:9x9x9 -o a.ply -q --tolerance 0.1",
          "replay synthetic:sphere:16x16x16 --trajectory t.csv -o a.csv -q --tool sphere:1 "
          "--tool-spacing 0.5 --torque-limit 9",
          "render synthetic:sphere:9x9x9 -o a.png -q --hip 0,0,3 --stiffness 2"}) {
        const Outcome outcome = palpate(folder, std::string(words));
        EXPECT_EQ(outcome.status, 0) << words;
        EXPECT_EQ(outcome.err, "") << words;
    }
}

TEST(NoEffect, ranges_of_a_file_need_no_isovalue) {
    const MotionFolder folder;
    succeeds(folder, std::string("convert ") + small_ball + " still.nrrd");
    const std::string line = "replay still.nrrd --trajectory t.csv -o a.csv -q ";
    succeeds(folder, line + "--penetrability ranges --range 100:150");
    expect_failure(palpate(folder, line), 2, "--isovalue is needed");
}

/// A shell's view of a pipe whose reader takes one line: statuses and standard error.
Outcome piped(const ScratchFolder& folder, const std::string& line) {
    return by_bash(folder, "\"$0\" " + line + " | head -n 1 > line; echo ${PIPESTATUS[0]}");
}

TEST(Pipe, to_a_reader_that_takes_one_line_ends_quietly) {
    const ScratchFolder folder;
    std::string text = "t,x,y,z\n";  // more rows than a pipe holds
    for (int i = 0; i < 20'000; ++i) text += std::to_string(i) + ",-20,0.1,0\n";
    support::put_bytes(folder / "t.csv", text);
    const std::string table = "replay synthetic:sphere:16x16x16 --trajectory t.csv --path p.csv ";
    for (const std::string output : {"-o -", "-o /dev/stdout", "-o /dev/fd/1"}) {
        const Outcome cut = piped(folder, table + output);
        EXPECT_EQ(cut.out, "141\n") << output << ": the work did not come to its end";
        EXPECT_EQ(cut.err, "") << output;
        EXPECT_FALSE(std::filesystem::exists(folder / "p.csv"));
        EXPECT_TRUE(support::bytes_of(folder / "line").starts_with("t,hip_x"));
    }
    // Text at the end of the work: all was done.
    const Outcome whole =
        by_bash(folder, "exec 3> >(true); wait $!; \"$0\" touch --help >&3; echo $?");
    EXPECT_EQ(whole.out, "0\n");
    EXPECT_EQ(whole.err, "");
}

}  // namespace
}  // namespace palpate::app::test
