// The table of settings on the command line: options with help, and live commands.
#include <gtest/gtest.h>

#include <concepts>
#include <nlohmann/json.hpp>
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
    succeeds(folder, line + "all.txt");
    const std::string recorded = support::bytes_of(folder / "r.csv");
    for_each_option([&](const std::string&, const auto& one) {
        if constexpr (std::same_as<decltype(one.member), double ForceSettings::*>) {
            EXPECT_TRUE(contains(recorded, "\"" + std::string(one.key) + "\":0.001")) << one.key;
        }
    });
    support::put_bytes(folder / "no.txt", "0.1 wobble 3\n");
    expect_failure(palpate(folder, line + "no.txt"), 3, "force-limit");
}

TEST(SettingsTable, numbers_without_an_option_are_set_by_their_names_while_they_are_felt) {
    const ScratchFolder folder;
    const std::string line =
        "touch synthetic:sphere:16x16x16 --unpaced --seconds 0.3 --json --commands set.txt";
    const auto told = [&](const std::string& commands) {
        support::put_bytes(folder / "set.txt", commands);
        return palpate(folder, line);
    };
    const Outcome done = told(
        "0.1 set limits.maximum_force 1.25\n0.1 set force.stale_after 0.015\n"
        "0.2 set force.magnet.distance 3\n0.2 set friction.static_coefficient 0.75\n");
    ASSERT_EQ(done.status, 0) << done.err;
    const auto settings = nlohmann::json::parse(done.out).at("settings");
    EXPECT_EQ(settings.at("device").at("maximum_force"), 1.25);
    EXPECT_EQ(settings.at("force").at("stale_after"), 0.015);
    EXPECT_EQ(settings.at("force").at("magnet").at("distance"), 3);
    EXPECT_EQ(settings.at("friction").at("static"), 0.75);
    const Outcome raised = told("0.1 set limits.maximum_force 100\n");
    EXPECT_TRUE(contains(raised.err, "limits can only be lowered")) << raised.err;
    EXPECT_EQ(nlohmann::json::parse(raised.out).at("settings").at("device").at("maximum_force"),
              3.3);
    expect_failure(told("0.1 set force.stifness 1\n"), 3, "did you mean force.stiffness?");
    expect_failure(told("0.1 set force.ramp\n"), 3, "set NAME VALUE");
}

}  // namespace
}  // namespace palpate::app::test
