// Values of options: whatever is written there, one short line says what is wrong with it.
#include <map>
#include <regex>

#include "apps/program.hpp"

namespace palpate::app::test {
namespace {

struct Option {
    std::string command, type;
};

/// All options that take a value, by name and help: one that several commands share is there once.
std::map<std::string, Option> options_with_values() {
    const ScratchFolder folder;
    std::map<std::string, Option> options;
    for (const std::string command :
         {"info", "replay", "extract", "convert", "tool", "render", "demo", "demo sculpt",
          "demo beating", "evaluate", "touch", "record", "view", "devices", "doctor"}) {
        std::istringstream lines(palpate(folder, command + " --help").out);
        const std::regex entry("  (?:-\\w,)?(--[\\w-]+) (\\S.*)");
        std::smatch found;
        for (std::string line; std::getline(lines, line);) {
            if (!std::regex_match(line, found, entry)) continue;
            const std::string type = found[2].str().substr(0, found[2].str().find("  "));
            if (type[0] != ' ') options.try_emplace(found[1].str() + ' ' + type, command, type);
        }
    }
    return options;
}

std::string name_of(const std::string& key) {
    return key.substr(0, key.find(' '));
}

TEST(Values, that_are_no_numbers_are_refused_in_one_short_line) {
    const ScratchFolder folder;
    const auto options = options_with_values();
    ASSERT_GT(options.size(), 70U);
    int numbers = 0;
    for (const auto& [key, option] : options) {
        const std::string name = name_of(key);
        const bool number = std::regex_search(option.type, std::regex("^(FLOAT|U?INT|SIZE)"));
        numbers += number;
        for (const std::string value : {"-3", "nan", "1e400", "1,5", "inf", "0x10", ""}) {
            if (!number && value != "") continue;
            // An accepted value fails at the end of the line, before anything is done.
            const Outcome outcome =
                palpate(folder, words_of(option.command) + Words{name, value, "--no-such-option"});
            const std::string line = option.command + ' ' + name + " '" + value + "'";
            EXPECT_EQ(outcome.status, 2) << line;
            EXPECT_TRUE(is_one_line(outcome.err)) << line << ": " << outcome.err;
            EXPECT_LT(outcome.err.size(), 420U) << line << ": " << outcome.err;
            for (const char* jargon : {"TEXT", "Value ", "in range", "Could not convert"}) {
                EXPECT_FALSE(contains(outcome.err, jargon)) << line << ": " << outcome.err;
            }
            const bool refused = !contains(outcome.err, "no option --no-such-option");
            const bool acceptable = value == "-3" || value == "inf";
            EXPECT_TRUE(refused || (acceptable && value != "")) << line << ": " << outcome.err;
            EXPECT_TRUE(!refused || contains(outcome.err, name)) << line << ": " << outcome.err;
            EXPECT_TRUE(!value.empty() || contains(outcome.err, "the value is empty"))
                << outcome.err;
        }
        const Outcome missing = palpate(folder, words_of(option.command) + Words{name});
        EXPECT_TRUE(is_one_line(missing.err) && contains(missing.err, name + " needs a value"))
            << option.command << ' ' << name << ": " << missing.err;
    }
    EXPECT_GT(numbers, 25);
}

struct Line {
    std::string words, text;
    friend std::ostream& operator<<(std::ostream& out, const Line& line) {
        return out << '\'' << line.words << '\'';
    }
};

class RefusedValue : public testing::TestWithParam<Line> {};

TEST_P(RefusedValue, is_named_with_what_to_write) {
    const ScratchFolder folder;
    const Outcome outcome = palpate(folder, GetParam().words);
    EXPECT_EQ(outcome.status, 2);
    EXPECT_EQ(outcome.err, "palpate: " + GetParam().text + "\n");
}

INSTANTIATE_TEST_SUITE_P(
    Values, RefusedValue,
    testing::Values(
        Line{"touch synthetic:sphere --seconds -3",
             "--seconds: -3 is not a number above 0 (see palpate touch --help)"},
        Line{"info synthetic:sphere --smooth 65",
             "--smooth: 65 is not from 0 to 64 (see palpate info --help)"},
        Line{"info synthetic:sphere --smooth 1.5",
             "--smooth: 1.5 is not a whole number (see palpate info --help)"},
        Line{"info synthetic:sphere --memory -1",
             "--memory: '-1' is not an amount of memory: write one like 512MB or 4GB (see palpate "
             "info --help)"},
        Line{"info synthetic:sphere --memory 1XB",
             "--memory: '1XB' is not an amount of memory: write one like 512MB or 4GB (see palpate "
             "info --help)"},
        Line{"info synthetic:sphere --level 99999999999",
             "--level: 99999999999 is not a whole number from 0 to 2147483647 (see palpate info "
             "--help)"},
        Line{"demo --seed 99999999999999999999",
             "--seed: 99999999999999999999 is not a whole number from 0 to 18446744073709551615 "
             "(see palpate demo --help)"},
        Line{"doctor --seconds nan",
             "--seconds: 'nan' is not a number (see palpate doctor --help)"},
        Line{"demo --depth 1,5",
             "--depth: '1,5' is not a number: its decimals follow a point, as in 1.5 (see palpate "
             "demo --help)"},
        Line{"extract synthetic:sphere -o a.ply --isovalue",
             "--isovalue needs a value: Isovalue of the surface, in the data's units (300) or "
             "percent of its range (53%) (see palpate extract --help)"},
        Line{"extract synthetic:sphere -o a.ply --solid above --solid below",
             "--solid: it is given more than once (see palpate extract --help)"},
        Line{"info synthetic:sphere --dequantize=0",
             "--dequantize takes 1 to 1000 rounds: leave it out to keep the samples"},
        Line{"info synthetic:sphere --json=abc",
             "--json = abc: this option takes no such value (see palpate info --help)"}));

class Misspelt : public testing::TestWithParam<Line> {};

TEST_P(Misspelt, names_are_answered_with_the_name_that_was_meant) {
    const MotionFolder folder;
    const Outcome outcome = palpate(folder, GetParam().words);
    EXPECT_NE(outcome.status, 0);
    EXPECT_TRUE(is_one_line(outcome.err)) << outcome.err;
    EXPECT_TRUE(contains(outcome.err, "did you mean " + GetParam().text + "?")) << outcome.err;
}

INSTANTIATE_TEST_SUITE_P(
    Values, Misspelt,
    testing::Values(
        Line{"inof head.nrrd", "info"}, Line{"EXTRACT head.nrrd", "extract"},
        Line{"extract synthetic:sphere --feild linear -o a.ply", "--field"},
        Line{"info synthetic:sphere --jsn", "--json"},
        Line{"replay synthetic:sphere --iso 5", "--isovalue"},
        Line{"demo sculpt --pictres 3", "--pictures"},
        Line{"extract synthetic:sphere -o a.ply --field linaer", "linear"},
        Line{"demo --motion circel", "circle"}, Line{"demo --method exat", "exact"},
        Line{"info synthetic:tours", "torus"}, Line{"info synthetic:sphere --type unit8", "uint8"},
        Line{"extract synthetic:sphere:8x8x8 -o a.plt", ".ply"},
        Line{"convert synthetic:sphere:8x8x8 a.zar", ".zarr"},
        Line{"doctor --device hapy", "haply"}, Line{"evaluate dirft", "drift"},
        Line{"touch synthetic:sphere:8x8x8 --headless --device simulatd", "simulated"},
        Line{"touch synthetic:sphere:8x8x8 --headless --device simulated:hadn=press", "hand"},
        Line{"touch synthetic:sphere:8x8x8 --headless --device simulated:hand=pres", "press"},
        Line{"replay synthetic:sphere:8x8x8 --trajectory t.csv -o a.csv --layers ct-bone-driling",
             "ct-bone-drilling"}));

TEST(Values, a_word_that_is_like_none_gets_no_suggestion) {
    const ScratchFolder folder;
    for (const std::string words : {"feel", "info synthetic:bagel", "info x --quartz"}) {
        EXPECT_FALSE(contains(palpate(folder, words).err, "did you mean")) << words;
    }
}

}  // namespace
}  // namespace palpate::app::test
