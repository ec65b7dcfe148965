// The examples of docs/command_line.md and of every --help, run as they stand there.
#include "apps/program.hpp"

namespace palpate::app::test {
namespace {

/// The lines of all blocks that are marked sh.
std::vector<std::string> examples() {
    std::ifstream reference(PALPATE_REFERENCE);
    std::vector<std::string> lines;
    bool inside = false;
    for (std::string line; std::getline(reference, line);) {
        if (line.rfind("```", 0) == 0) {
            inside = line == "```sh";
        } else if (inside) {
            lines.push_back(line);
        }
    }
    return lines;
}

TEST(Reference, every_example_of_the_command_line_page_works) {
    const ScratchFolder folder;
    const auto programs = std::filesystem::path(PALPATE_PROGRAM).parent_path();
    ASSERT_EQ(std::string(std::getenv("PATH")).empty(), false);
    ::setenv("PATH", (programs.string() + ":" + std::getenv("PATH")).c_str(), 1);
    const auto lines = examples();
    ASSERT_GT(lines.size(), 8U);
    for (const std::string& line : lines) {
        const Outcome outcome = by_bash(folder, line);
        EXPECT_EQ(outcome.status, 0) << line << "\n" << outcome.err;
        EXPECT_TRUE(line.rfind("palpate", 0) != 0 || !outcome.out.empty()) << line;
    }
}

/// The lines behind "Example" in the help of a command.
std::vector<std::string> examples_in(const std::string& help) {
    std::istringstream lines(help.substr(std::min(help.find("\nExample"), help.size())));
    std::vector<std::string> examples;
    for (std::string line; std::getline(lines, line);) {
        if (line.starts_with("  palpate ")) examples.push_back(line.substr(10));
    }
    return examples;
}

/// The files that the examples name: the head that comes with the program, a motion that touches
/// it, a recording and raw samples.
void put_named_files(const ScratchFolder& folder, const std::string& example) {
    std::filesystem::copy_file(PALPATE_SAMPLE_VOLUME, folder / "head.nrrd");
    std::string motion = "t,x,y,z\n";
    for (int i = 0; i < 200; ++i) {
        motion += std::to_string(0.001 * i) + ",57," + std::to_string(-0.3 * i) + ",124\n";
    }
    support::put_bytes(folder / "hand.csv", motion);
    if (contains(example, "--validate")) {
        ASSERT_EQ(palpate(folder, "record head.nrrd --unpaced --seconds 0.1 -o session.csv").status,
                  0);
    }
    support::put_bytes(folder / "samples.raw", "");
    std::filesystem::resize_file(folder / "samples.raw", 2 * 256 * 256 * 113);
}

/// With a stand-in for hardware, a patient's scan and a person, and shortened where it takes long.
Words runnable(std::string example) {
    const auto replace = [&](const std::string& what, const std::string& by) {
        const auto at = example.find(what);
        if (at != std::string::npos) example.replace(at, what.size(), by);
    };
    replace("--device haply", "--device simulated");
    replace("dicom-folder", "head.nrrd");
    if (example.starts_with("touch") || example.starts_with("record")) {
        example += " --unpaced --seconds 0.1";
    }
    if (example.starts_with("demo")) {
        example += " --picture 64";
        example += example.starts_with("demo beating") ? " --pictures 2" : " --duration 0.2";
        if (example.starts_with("demo sculpt")) example += " --pictures 2";
    }
    // Ticks that a busy machine misses are a fault, too. doctor_test.cpp measures.
    if (example.starts_with("doctor")) example += " --seconds 0";
    if (example.starts_with("evaluate") && !contains(example, "--quick")) example += " --quick";
    return words_of(example);
}

class Help : public testing::TestWithParam<const char*> {};

TEST_P(Help, has_examples_that_work) {
    const std::string command = GetParam();
    const ScratchFolder anywhere;
    const auto examples = examples_in(palpate(anywhere, command + " --help").out);
    ASSERT_FALSE(examples.empty());
    for (const std::string& example : examples) {
        EXPECT_TRUE(example.starts_with(command)) << example;
        if (example == "evaluate all --quick") continue;  // tests/python/evaluate_test.py runs it
        const ScratchFolder folder;
        put_named_files(folder, example);
        // A window is for people: here a program takes its place that accepts what it is given.
        if (command == "view") {
            ::setenv("PALPATE_VIEWER", "/bin/true", 1);
            ::setenv("DISPLAY", ":none", 1);
        }
        const Outcome outcome = palpate(folder, runnable(example));
        ::unsetenv("PALPATE_VIEWER");
        EXPECT_EQ(outcome.status, 0) << example << "\n" << outcome.err;
        EXPECT_FALSE(contains(outcome.err, "warning")) << example << "\n" << outcome.err;
    }
}

INSTANTIATE_TEST_SUITE_P(Reference, Help,
                         testing::Values("info", "replay", "extract", "convert", "tool", "render",
                                         "demo", "demo sculpt", "demo beating", "evaluate", "touch",
                                         "view", "record", "devices", "doctor"));

TEST(Reference, names_every_option_of_every_command) {
    const std::string reference = support::bytes_of(PALPATE_REFERENCE);
    const ScratchFolder folder;
    for (const std::string command :
         {"info", "touch", "record", "devices", "doctor", "replay", "extract", "demo"}) {
        const std::string help = palpate(folder, command + " --help").out;
        const std::string options = help.substr(0, help.find("\nExample"));
        for (auto at = options.find("--"); at != std::string::npos; at = options.find("--", at)) {
            const auto end = options.find_first_of(" ,={\n", at);
            const std::string option = options.substr(at, end - at);
            EXPECT_TRUE(contains(reference, option) || option == "--version") << option;
            at = end;
        }
    }
}

}  // namespace
}  // namespace palpate::app::test
