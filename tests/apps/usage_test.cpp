// Help, version, wrong words and wrong settings.
#include "apps/program.hpp"

namespace palpate::app::test {
namespace {

constexpr const char* commands[] = {"info", "replay", "extract", "render", "demo", "doctor"};

TEST(Usage, the_help_of_a_command_says_what_this_command_does) {
    const ScratchFolder folder;
    for (const char* command : {"convert", "info", "extract", "render"}) {
        const std::string help = palpate(folder, std::string(command) + " --help").out;
        EXPECT_FALSE(contains(help, "while it is touched")) << command;
        EXPECT_FALSE(contains(help, "--coarse-first")) << command;
    }
    EXPECT_FALSE(contains(palpate(folder, "convert --help").out, "--all-times"));
    EXPECT_TRUE(contains(palpate(folder, "touch --help").out, "--coarse-first"));
}

TEST(Usage, every_command_has_help_with_an_example) {
    const ScratchFolder folder;
    const Outcome all = succeeds(folder, "--help");
    for (const std::string command : commands) {
        EXPECT_TRUE(contains(all.out, "\n  " + command)) << command;
        const Outcome help = palpate(folder, command + " --help");
        EXPECT_EQ(help.status, 0) << command;
        EXPECT_EQ(help.err, "");
        EXPECT_TRUE(contains(help.out, "Example")) << command;
        EXPECT_TRUE(contains(help.out, "\n  palpate " + command)) << command;
    }
}

TEST(Usage, every_command_prints_the_version) {
    const ScratchFolder folder;
    for (const std::string command : {"", "info ", "replay ", "extract ", "render ", "demo "}) {
        const Outcome version = palpate(folder, command + "--version");
        EXPECT_EQ(version.status, 0) << command;
        EXPECT_EQ(version.out, "palpate " PALPATE_VERSION "\n") << command;
    }
}

struct Case {
    std::string words, reason;
    friend std::ostream& operator<<(std::ostream& out, const Case& c) {
        return out << '\'' << c.words << '\'';
    }
};

class WrongWords : public testing::TestWithParam<Case> {};

TEST_P(WrongWords, are_refused_in_one_line_that_names_them) {
    const MotionFolder folder;
    const auto before = folder.names();
    expect_failure(palpate(folder, GetParam().words), 2, GetParam().reason);
    EXPECT_EQ(folder.names(), before);
}

INSTANTIATE_TEST_SUITE_P(
    Usage, WrongWords,
    testing::Values(
        Case{"", "a command is needed"}, Case{"feel", "no command 'feel'"},
        Case{"INFO synthetic:noise:4x4x4", "no command 'INFO'"}, Case{"--fast", "no option --fast"},
        Case{"--", "a command is needed"}, Case{"-- info", "VOLUME is required (see palpate info"},
        Case{"info --", "VOLUME is required (see palpate info"}, Case{"-", "no command '-'"},
        Case{"render -- synthetic:noise --isovalue 1", "'--isovalue' is one argument too many"},
        Case{"--quiet info synthetic:noise", "--quiet is an option of info: write it after info"},
        Case{"render synthetic:noise --isovalue=", "empty (see palpate render --help)"},
        Case{"info synthetic:noise --=", "there is no option --= (see palpate info"},
        Case{"info synthetic:noise ---", "there is no option --- (see palpate info"},
        Case{"info synthetic:noise --time-step 1 --time-step 2", "it is given more than once"},
        Case{"info", "VOLUME is required"},
        Case{"info --purple", "no option --purple (see palpate info"},
        Case{"info synthetic:noise:4x4x4 --fast 3", "palpate info --help"},
        Case{"info synthetic:noise --isovalu 3", "--isovalu: --isovalue is an option of "},
        Case{"info synthetic:noise:4x4x4 second", "'second' is one argument too many"},
        Case{"replay synthetic:noise:4x4x4 -o a.csv", "--trajectory is required"},
        Case{"replay synthetic:noise:4x4x4 --trajectory t.csv", "--output is required"},
        Case{"extract synthetic:noise:4x4x4", "--output is required"},
        Case{"info synthetic:bagel", "'bagel'"}, Case{"info synthetic:noise:0x4x4", "'0x4x4'"},
        Case{"info synthetic:noise:4x4", "'4x4'"},
        Case{"info synthetic:noise:99999x99999x99999", "the limit is"},
        Case{"info synthetic:noise --dims 4x4x4", "dims, spacing and orientation are for files"},
        Case{"info synthetic:noise --type int64", "'int64'"},
        Case{"info synthetic:noise --type", "--type"},
        Case{"info synthetic:noise --time-step -1", "-1 is not a whole number"},
        Case{"info synthetic:noise --time-step 1.5", "1.5 is not a whole number"},
        Case{"info synthetic:noise --skip -1", "-1 is not a whole number"},
        Case{"demo synthetic:noise --seed -1", "-1 is not a whole number"},
        Case{"demo synthetic:noise --motion dance", "dance"},
        Case{"demo synthetic:noise --duration -1", "0 s or more"},
        Case{"demo synthetic:noise --duration 1e12", "at most 100 million samples"},
        Case{"demo synthetic:noise --speed 0", "speed above 0"},
        Case{"demo synthetic:noise --depth -1", "depth of 0 mm or more"},
        Case{"extract synthetic:sphere -o a.ply -i 1 --solid left", "left"},
        Case{"replay synthetic:sphere -o a.csv --trajectory t.csv --field quartic", "quartic"},
        Case{"touch synthetic:sphere:16x16x16 --headless --seconds 1 --field cubic "
             "--method paper",
             "made for the linear field"}));

TEST(Usage, refuses_an_empty_value_of_an_option) {
    const ScratchFolder folder;
    const std::string ball = "synthetic:sphere:8x8x8";
    for (const Words& words :
         {Words{"info", ""}, Words{"info", ball, "--type", ""}, Words{"touch", ball, "--save", ""},
          Words{"touch", ball, "--brush", "", "--headless"}, Words{"touch", ball, "--record", ""},
          Words{"touch", ball, "--record=", "--headless"}, Words{"view", ball, "--after="},
          Words{"demo", "sculpt", ball, "-o", ""}, Words{"view", ball, "--screenshot", ""}}) {
        expect_failure(palpate(folder, words), 2, "the value is empty");
    }
}

TEST(Usage, a_word_of_any_bytes_and_any_length_is_refused_in_one_line) {
    const ScratchFolder folder;
    const std::string ball = "synthetic:sphere:8x8x8", longest(100000, 'a');
    for (const std::string& word : {std::string("a\nb"), std::string("a\x1b[31m"), longest}) {
        for (const Words& words :
             {Words{word}, Words{"info", ball, "--" + word}, Words{"info", ball, word},
              Words{"evaluate", word}, Words{"evaluate", "drift", "--" + word}}) {
            const Outcome outcome = palpate(folder, words);
            expect_failure(outcome, 2, "palpate: ");
            EXPECT_LT(outcome.err.size(), 7000U);
            EXPECT_EQ(outcome.err.find('\x1b'), std::string::npos);
        }
    }
}

TEST(Usage, a_command_may_follow_the_end_of_the_options) {
    const ScratchFolder folder;
    const Outcome info = succeeds(folder, "-- info synthetic:noise:4x4x4");
    EXPECT_EQ(info.out, palpate(folder, "info synthetic:noise:4x4x4").out);
}

class WrongSettings : public testing::TestWithParam<Case> {};

TEST_P(WrongSettings, are_refused_with_the_reason_and_leave_nothing) {
    const MotionFolder folder;
    const auto before = folder.names();
    const std::string line =
        "replay synthetic:sphere:24x24x24 --trajectory t.csv -o a.csv --path p.csv ";
    expect_failure(palpate(folder, line + GetParam().words), 2, GetParam().reason);
    EXPECT_EQ(folder.names(), before);
}

INSTANTIATE_TEST_SUITE_P(
    Usage, WrongSettings,
    testing::Values(
        Case{"--isovalue nan", "'nan' is not a level"}, Case{"--isovalue inf", "'inf'"},
        Case{"--isovalue abc", "'abc' is not a level"}, Case{"--isovalue 5%%", "'5%%'"},
        Case{"--isovalue", "--isovalue"}, Case{"--background nan", "'nan'"},
        Case{"--method magic", "magic"}, Case{"--stiffness 1000", "at most 5 at 1000 Hz"},
        Case{"--stiffness -1", "at least 0"}, Case{"--stiffness nan", "nan"},
        Case{"--stiffness abc", "abc"}, Case{"--scale 0", "scale = 0: must be from 1e-30 to 1e30"},
        Case{"--scale -1", "scale"}, Case{"--scale nan", "scale"},
        Case{"--friction 0.2,0.5", "dynamic coefficient <= static"}, Case{"--friction -1", "0 <="},
        Case{"--friction a", "--friction a"}, Case{"--friction 1,2,3", "--friction 1,2,3"},
        Case{"--penetrability maybe", "maybe"},
        Case{"--penetrability threshold --threshold -1", "at least 0 mm"},
        Case{"--penetrability threshold --threshold nan", "nan"},
        Case{"--penetrability ranges", "--range LOW:HIGH"},
        Case{"--penetrability ranges --range 5", "LOW:HIGH is needed"},
        Case{"--penetrability ranges --range 5:3", "low <= high"},
        Case{"--penetrability ranges --range a:b", "'a'"},
        Case{"--range 1:2", "does nothing without"}, Case{"--threshold 2", "does nothing without"},
        Case{"--minimum 3", "does nothing without"}, Case{"--force-limit -1", "at least 0"},
        Case{"--force-limit nan", "nan"}, Case{"--force-rate 0", "above 0"},
        Case{"--ramp -1", "at least 0"}, Case{"--rate 0", "1 to 100000"},
        Case{"--step-budget 0", "at least 1"}, Case{"--texture 1", "two numbers"},
        Case{"--texture 1,0", "wavelength"}, Case{"--magnet 1,100", "magnet peak"},
        Case{"--magnet x,1", "two numbers"}, Case{"--damping 9", "physical damping"},
        Case{"--path q.csv", "--path"}, Case{"-o b.csv", "--output"}));

TEST(Usage, options_that_may_be_repeated_leave_the_volume_alone) {
    const MotionFolder folder;
    for (const std::string options :
         {"--friction 0.5", "--friction 0.5,0.3", "--penetrability ranges --range 100:150",
          "--magnet 1,0.5", "--texture 0.1,2"}) {
        const Outcome done = palpate(
            folder, "replay " + options + " synthetic:sphere:24x24x24 --trajectory t.csv -o a.csv");
        EXPECT_EQ(done.status, 0) << options << ": " << done.err;
    }
}

TEST(Usage, no_message_has_the_password_or_the_query_of_an_address) {
    const MotionFolder folder;
    const std::string address = "http://ann:S3CRET@127.0.0.1:9/v.zarr?a=host;b&sig=TOKEN9";
    const std::string volume = "synthetic:sphere:9x9x9 ";
    for (const std::string& words :
         {address, "info " + volume + address, "convert " + volume + address,
          "convert " + volume + "--compression " + address + " a.zarr",
          "touch " + volume + "--save " + address, "tool " + address,
          "extract " + volume + "-o " + address, "info " + address,
          "render " + volume + "-i 5 -o a.png --path " + address,
          "replay " + volume + "--trajectory t.csv -o a.csv --tool " + address,
          "replay " + volume + "--trajectory " + address + " -o a.csv"}) {
        const Outcome outcome = palpate(folder, words);
        EXPECT_NE(outcome.status, 0) << words;
        EXPECT_TRUE(contains(outcome.err, "127.0.0.1:9/v.zarr")) << words << outcome.err;
        EXPECT_FALSE(contains(outcome.err, "S3CRET")) << outcome.err;
        EXPECT_FALSE(contains(outcome.err, "TOKEN9")) << outcome.err;
    }
    EXPECT_EQ(folder.names(), std::vector<std::string>{"t.csv"});
}

TEST(Usage, warns_of_an_isovalue_outside_the_range_and_goes_on) {
    const MotionFolder folder;
    const Outcome feel = succeeds(
        folder, "replay synthetic:sphere:24x24x24 --trajectory t.csv -o a.csv --isovalue 300");
    EXPECT_TRUE(is_one_line(feel.err) && contains(feel.err, "warning: isovalue 300")) << feel.err;
    EXPECT_TRUE(contains(feel.out, "in contact 0 "));
    const Outcome mesh =
        succeeds(folder, "extract synthetic:sphere:24x24x24 -o a.ply --isovalue 300");
    EXPECT_TRUE(contains(mesh.err, "warning: isovalue 300")) << mesh.err;
    EXPECT_TRUE(contains(mesh.out, " 0 triangles"));
}

TEST(Usage, refuses_a_replay_where_all_of_space_is_solid_and_leaves_no_file) {
    const MotionFolder folder;
    for (const std::string command : {"replay synthetic:sphere:9x9x9 --trajectory t.csv -o a.csv",
                                      "demo synthetic:sphere:9x9x9 --picture 120 -o out"}) {
        const Outcome outcome = palpate(folder, command + " --isovalue -5");
        EXPECT_EQ(outcome.status, 2);
        EXPECT_TRUE(contains(outcome.err, "everything is solid")) << outcome.err;
        EXPECT_EQ(folder.names(), std::vector<std::string>{"t.csv"});
    }
}

}  // namespace
}  // namespace palpate::app::test
