// palpate doctor, on the machine that runs the tests.
#include <nlohmann/json.hpp>

#include "apps/program.hpp"

namespace palpate::app::test {
namespace {

TEST(Doctor, examines_this_machine_and_its_status_says_whether_something_essential_is_missing) {
    const ScratchFolder folder;
    const Outcome outcome = palpate(folder, "doctor --seconds 0.5 --json --report report.md");
    const auto json = nlohmann::json::parse(outcome.out);
    const bool missing = json.at("essential_missing");
    EXPECT_EQ(outcome.status, missing ? 4 : 0);
    EXPECT_EQ(outcome.err.empty(), !missing);
    EXPECT_EQ(json.at("version"), PALPATE_VERSION);
    EXPECT_GE(json.at("machine").at("processors"), 1);
    EXPECT_FALSE(json.at("machine").at("kernel").get<std::string>().empty());
    EXPECT_GE(
        json.at("latency").at("ticks").get<int>() + json.at("latency").at("missed").get<int>(),
        490);
    EXPECT_EQ(json.at("latency").at("under_load"), true);
    EXPECT_FALSE(json.at("graphics").at("pictures").get<std::string>().empty());
    EXPECT_EQ(json.at("programs").at(0).at("works"), true);
    EXPECT_EQ(json.at("devices").at(0).at("name"), "simulated");
    const std::string report = support::bytes_of(folder / "report.md");
    for (const auto& fault : json.at("faults")) {
        EXPECT_TRUE(contains(report, fault.at("remedy"))) << fault;
    }
    EXPECT_TRUE(contains(report, "## Real-time certificate"));
    EXPECT_TRUE(contains(report, "woken late by at most [us]"));
}

TEST(Doctor, asks_for_a_device_that_has_to_work) {
    const ScratchFolder folder;
    const Outcome outcome = palpate(folder, "doctor --seconds 0 --device openhaptics --json");
    const auto json = nlohmann::json::parse(outcome.out);
    bool found = false;
    for (const auto& device : json.at("devices")) {
        if (device.at("name") == "openhaptics") found = device.at("found");
    }
    if (found) GTEST_SKIP() << "OpenHaptics is installed here";
    EXPECT_EQ(outcome.status, 4);
    EXPECT_TRUE(contains(outcome.err, "device-missing")) << outcome.err;
    EXPECT_FALSE(json.contains("latency"));
    expect_failure(palpate(folder, "doctor --seconds 0 --device glove"), 2, "no device 'glove'");
}

TEST(Doctor, finds_a_helper_that_does_not_run) {
    const ScratchFolder folder;
    const Outcome outcome = by_bash(folder,
                                    "PALPATE_IO_HELPER=/nonexistent PALPATE_PICTURE_HELPER="
                                    "/nonexistent exec \"$0\" doctor --seconds 0");
    EXPECT_EQ(outcome.status, 4);
    for (const char* name : {"helper-io", "helper-pictures", "graphics-missing"}) {
        EXPECT_TRUE(contains(outcome.out, name)) << outcome.out;
    }
}

TEST(Doctor, finds_a_reader_that_was_copied_without_those_of_other_formats) {
    const ScratchFolder folder;
    const auto build = std::filesystem::path(PALPATE_PROGRAM).parent_path() / "../..";
    std::filesystem::copy_file(build / "libexec/palpate/palpate-io-helper",
                               folder / "palpate-io-helper");
    const Outcome outcome =
        by_bash(folder, "PALPATE_IO_HELPER=$PWD/palpate-io-helper exec \"$0\" doctor --seconds 0");
    EXPECT_EQ(outcome.status, 4);
    EXPECT_TRUE(contains(outcome.out, "palpate-io-dicom is missing in its folder")) << outcome.out;
}

TEST(Doctor, leaves_no_report_when_it_is_interrupted) {
    const ScratchFolder folder;
    Running running({"doctor", "--report", "report.md", "--quiet"}, folder.path());
    ASSERT_TRUE(comes_true([&] { return running.catches(SIGINT) && !folder.names().empty(); }));
    const Outcome outcome = running.finish(SIGINT);
    EXPECT_EQ(outcome.status, 130) << outcome.err;
    EXPECT_TRUE(folder.names().empty());
}

}  // namespace
}  // namespace palpate::app::test
