// The files of an experiment, and the HTML page.
#include "evaluation/report.hpp"

#include <gtest/gtest.h>

#include <string>

#include "palpate/io/error.hpp"
#include "support/scratch_folder.hpp"

namespace palpate::evaluation {
namespace {

using support::bytes_of;
using support::contains;

/// Three points, a claim that holds and one that does not.
Report some_report() {
    Report report{{"points", "Are there <three>?", nullptr}, {}, "a machine, some day"};
    for (const double x : {1.0, 2.0, 3.0}) report.result.table.add({{"x", x}, {"y", x * x}});
    report.result.summary.add({{"mean y", 14.0 / 3}, {"of", "three"}});
    Figure figure;
    figure.caption = "Three points & no more";
    figure.panels.resize(1);
    figure.panels[0].series = {{Draw::points, "", {}, {{1, 1}, {2, 4}, {3, 9}}}};
    report.result.figures = {figure};
    figure.suffix = "again";
    report.result.figures.push_back(figure);
    report.result.paragraph = "There are three.";
    report.result.claims = {{"there are three", true, "3"}, {"there are four", false, "3"}};
    return report;
}

TEST(Report, leaves_a_table_each_figure_twice_and_a_text_that_names_them) {
    const support::ScratchFolder folder;
    write_files(some_report(), folder.path());
    EXPECT_EQ(bytes_of(folder / "points.csv"), "x,y\n1,1\n2,4\n3,9\n");
    for (const char* name : {"points", "points-again"}) {
        EXPECT_TRUE(contains(bytes_of(folder / (name + std::string(".svg"))), "<svg")) << name;
        EXPECT_TRUE(bytes_of(folder / (name + std::string(".png"))).starts_with("\x89PNG")) << name;
    }
    const std::string text = bytes_of(folder / "points.md");
    for (const char* part :
         {"There are three.", "](points.svg)", "](points-again.svg)",
          "| mean y | of |\n|---|---|\n| 4.667 | three |\n", "| there are three | yes | 3 |",
          "| there are four | **no** | 3 |", "(points.csv)", "a machine, some day"}) {
        EXPECT_TRUE(contains(text, part)) << part;
    }
}

TEST(Report, the_page_has_its_figures_inside_and_no_link_to_the_outside) {
    const support::ScratchFolder folder;
    write_files(some_report(), folder.path());
    write_html({some_report()}, folder.path(), folder / "report.html");
    const std::string page = bytes_of(folder / "report.html");
    EXPECT_TRUE(contains(page, "data:image/svg+xml;base64,"));
    EXPECT_TRUE(contains(page, "Are there &lt;three&gt;?"));
    EXPECT_TRUE(contains(page, "1 of 2 claims hold"));
    EXPECT_FALSE(contains(page, "src=\"points"));
    EXPECT_FALSE(contains(page, "http"));
}

TEST(Report, a_figure_that_gnuplot_refuses_is_an_error_that_says_why) {
    const support::ScratchFolder folder;
    Report report = some_report();
    report.result.figures[0].width = 1;
    try {
        write_files(report, folder.path());
        FAIL() << "drawn";
    } catch (const io::OutputError& e) {
        EXPECT_TRUE(contains(e.what(), "points.svg: could not be drawn (")) << e.what();
        EXPECT_FALSE(contains(e.what(), "\n")) << e.what();
    }
    EXPECT_FALSE(std::filesystem::exists(folder / "points.svg"));
    EXPECT_FALSE(std::filesystem::exists(folder / "points.svg.part"));
}

}  // namespace
}  // namespace palpate::evaluation
