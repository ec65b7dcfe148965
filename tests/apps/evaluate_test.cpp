// palpate evaluate: what it leaves behind, and how it refuses.
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "apps/program.hpp"

namespace palpate::app::test {
namespace {

using Names = std::vector<std::string>;

TEST(Evaluate, an_experiment_leaves_a_table_figures_and_a_text) {
    const ScratchFolder folder;
    const Outcome outcome = palpate(folder, "evaluate drift --quick --output found");
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(outcome.err, "");
    EXPECT_TRUE(contains(outcome.out, "holds: exact stays on the isosurface")) << outcome.out;
    EXPECT_TRUE(contains(outcome.out, "Results: found")) << outcome.out;
    EXPECT_EQ(folder.names(), Names{"found"});
    Names names;
    for (const auto& entry : std::filesystem::directory_iterator(folder / "found")) {
        names.push_back(entry.path().filename().string());
    }
    std::sort(names.begin(), names.end());
    EXPECT_EQ(names, (Names{"drift.csv", "drift.md", "drift.png", "drift.svg"}));
    const std::string table = support::bytes_of(folder / "found/drift.csv");
    EXPECT_TRUE(table.starts_with("volume,method,speed_mm_s,rate_hz,turn,density,")) << table;
}

TEST(Evaluate, the_same_seed_gives_the_same_table) {
    const ScratchFolder folder;
    for (const std::string output : {"first", "second"}) {
        ASSERT_EQ(palpate(folder, "evaluate drift --quick -q -o " + output).status, 0);
    }
    EXPECT_EQ(support::bytes_of(folder / "first/drift.csv"),
              support::bytes_of(folder / "second/drift.csv"));
}

TEST(Evaluate, runs_on_a_volume_of_the_user) {
    const ScratchFolder folder;
    const Outcome outcome =
        palpate(folder, "evaluate drift --quick --json --volume synthetic:torus:30x30x16@40%");
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const auto json = nlohmann::json::parse(outcome.out);
    ASSERT_EQ(json.size(), 1U);
    EXPECT_EQ(json[0].at("experiment"), "drift");
    for (const auto& claim : json[0].at("claims")) EXPECT_EQ(claim.at("holds"), true) << claim;
    const std::string table = support::bytes_of(folder / "palpate-evaluation/drift.csv");
    EXPECT_TRUE(contains(table, "\ntorus,exact,"));
    EXPECT_FALSE(contains(table, "cylinder"));
}

/// The one test of every experiment through the program: the whole report.
TEST(Evaluate, all_makes_one_report_that_needs_no_other_file) {
    const ScratchFolder folder;
    const Outcome outcome = palpate(folder, "evaluate all --quick --json -o found");
    ASSERT_EQ(outcome.status, 0) << outcome.out << outcome.err;
    const std::string report = support::bytes_of(folder / "found/report.html");
    for (const auto& experiment : nlohmann::json::parse(outcome.out)) {
        const std::string name = experiment.at("experiment");
        EXPECT_FALSE(experiment.at("claims").empty()) << name;
        EXPECT_TRUE(contains(report, "<h2 id=\"" + name + "\">")) << name;
        for (const char* extension : {".csv", ".svg", ".png", ".md"}) {
            EXPECT_TRUE(std::filesystem::exists(folder / "found" / (name + extension))) << name;
        }
    }
    std::size_t embedded = 0;
    for (auto at = report.find("src=\""); at != std::string::npos;
         at = report.find("src=\"", at + 1)) {
        EXPECT_EQ(report.compare(at + 5, 11, "data:image/"), 0) << report.substr(at, 40);
        ++embedded;
    }
    EXPECT_GE(embedded, 1U);
}

TEST(Evaluate, all_leaves_out_what_cannot_be_done_on_the_users_volume) {
    const ScratchFolder folder;
    const Outcome outcome =
        palpate(folder, "evaluate all --quick -o found --volume synthetic:plane:24x24x24");
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_TRUE(contains(outcome.err, "note: drift is left out: ")) << outcome.err;
    EXPECT_FALSE(std::filesystem::exists(folder / "found/drift.csv"));
    EXPECT_TRUE(std::filesystem::exists(folder / "found/stability.csv"));
    EXPECT_TRUE(std::filesystem::exists(folder / "found/report.html"));
}

TEST(Evaluate, refuses_options_that_make_no_sense) {
    const ScratchFolder folder;
    expect_failure(palpate(folder, "evaluate"), 2, "EXPERIMENT");
    expect_failure(palpate(folder, "evaluate nothing"), 2, "drift");
    expect_failure(palpate(folder, "evaluate drift --seed -1"), 2, "whole number");
    expect_failure(palpate(folder, "evaluate drift --data nowhere"), 2, "no such folder");
    expect_failure(palpate(folder, "evaluate drift --volume head.nrrd"), 2, "head.nrrd@300");
    expect_failure(palpate(folder, "evaluate drift --volume head.nrrd@300"), 3, "head.nrrd");
    expect_failure(palpate(folder, "evaluate drift --quick --volume synthetic:torus@1e9"), 2,
                   "cannot go round it");
    EXPECT_EQ(folder.names(), Names{});
}

TEST(Evaluate, a_folder_that_cannot_be_written_is_refused_before_any_work) {
    const ScratchFolder folder;
    support::put_bytes(folder / "file", "");
    expect_failure(palpate(folder, "evaluate drift --output file"), 5, "file");
    EXPECT_EQ(folder.names(), Names{"file"});
}

TEST(Evaluate, says_what_to_install_where_gnuplot_is_missing) {
    const ScratchFolder folder;
    const std::string path = std::getenv("PATH");
    ASSERT_EQ(setenv("PATH", folder.path().c_str(), 1), 0);
    const Outcome outcome = palpate(folder, "evaluate drift --quick");
    ASSERT_EQ(setenv("PATH", path.c_str(), 1), 0);
    expect_failure(outcome, 5, "apt install gnuplot-nox");
    EXPECT_EQ(folder.names(), Names{});
}

TEST(Evaluate, leaves_nothing_half_written_when_interrupted) {
    const ScratchFolder folder;
    Running running(words_of("evaluate drift --output found"), folder.path());
    ASSERT_TRUE(comes_true([&] { return std::filesystem::exists(folder / "found"); }));
    const Outcome outcome = running.finish(SIGINT);
    EXPECT_EQ(outcome.status, 130) << outcome.err;
    EXPECT_EQ(folder.names(), Names{});
}

TEST(Evaluate, says_that_it_was_interrupted_where_gnuplot_was_as_well) {
    const ScratchFolder folder, programs;
    // Ctrl-C reaches both.
    support::put_bytes(programs / "gnuplot", "#!/bin/sh\nkill -INT $PPID\nexit 1\n");
    std::filesystem::permissions(programs / "gnuplot", std::filesystem::perms::owner_all);
    const std::string path = std::getenv("PATH");
    ASSERT_EQ(setenv("PATH", (programs.path().string() + ":" + path).c_str(), 1), 0);
    const Outcome outcome = palpate(folder, "evaluate walk-through --quick");
    ASSERT_EQ(setenv("PATH", path.c_str(), 1), 0);
    expect_failure(outcome, 130, "interrupted");
    EXPECT_EQ(folder.names(), Names{});
}

}  // namespace
}  // namespace palpate::app::test
