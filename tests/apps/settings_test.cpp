// The table of settings on the command line: options with help, and live commands.
#include <gtest/gtest.h>

#include <concepts>
#include <string>

#include "palpate/settings.hpp"
#include "tests/apps/program.hpp"

namespace palpate::app::test {
namespace {

/// Calls visit(option, setting) for each setting that has an option, by its long name.
void for_each_option(auto&& visit) {
    for_each_setting<ForceSettings>([&](const auto& one) {
        const std::string option = one.option;
        if (!option.empty()) visit(option.substr(option.rfind("--")), one);
    });
}

TEST(SettingsTable, each_option_is_in_the_help_of_commands_that_feel_with_purpose_and_unit) {
    const ScratchFolder folder;
    for (const std::string command : {"replay", "touch", "record", "demo", "view"}) {
        const std::string help = palpate(folder, command + " --help").out;
        std::string line;  // the help breaks lines anywhere
        for (const char c : help) {
            if (c != ' ' && c != '\n') line += c;
        }
        int seen = 0;
        for_each_option([&](const std::string& option, const auto& one) {
            EXPECT_TRUE(contains(help, option)) << command << ' ' << option;
            std::string about;
            for (const char c : std::string(one.about)) {
                if (c != ' ') about += c;
            }
            EXPECT_TRUE(contains(line, about)) << command << ' ' << option << ": " << about;
            ++seen;
        });
        EXPECT_GE(seen, 12);
    }
}

TEST(SettingsTable, each_number_of_the_force_can_be_changed_while_it_is_felt) {
    const ScratchFolder folder;
    std::string script;
    int seen = 0;
    for_each_option([&](const std::string& option, const auto& one) {
        if constexpr (std::same_as<decltype(one.member), double ForceSettings::*>) {
            script += "0." + std::to_string(100 + ++seen) + " " + option.substr(2) + " 0.001\n";
        }
    });
    ASSERT_LT(seen, 100);
    ASSERT_GE(seen, 10);
    support::put_bytes(folder / "all.txt", script);
    const std::string line =
        "touch synthetic:sphere:16x16x16 --unpaced --seconds 0.2 --record r.csv --commands ";
    const Outcome done = palpate(folder, line + "all.txt");
    EXPECT_EQ(done.status, 0) << done.err;
    const std::string recorded = support::bytes_of(folder / "r.csv");
    for_each_option([&](const std::string&, const auto& one) {
        if constexpr (std::same_as<decltype(one.member), double ForceSettings::*>) {
            EXPECT_TRUE(contains(recorded, "\"" + std::string(one.key) + "\":0.001")) << one.key;
        }
    });
    support::put_bytes(folder / "no.txt", "0.1 wobble 3\n");
    expect_failure(palpate(folder, line + "no.txt"), 3, "force-limit");
}

}  // namespace
}  // namespace palpate::app::test
