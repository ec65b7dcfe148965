// The examples of docs/command_line.md, run as they stand there.
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
        const Outcome outcome =
            Running({"-c", line}, folder.path(), Stdout::captured, "/bin/sh").finish();
        EXPECT_EQ(outcome.status, 0) << line << "\n" << outcome.err;
        EXPECT_TRUE(line.rfind("palpate", 0) != 0 || !outcome.out.empty()) << line;
    }
}

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
