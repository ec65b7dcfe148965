// Percentiles of every row, one above the other, against the budget of a tick.
#include "evaluation/performance/figure.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>

namespace palpate::evaluation {
namespace {

struct Mark {
    const char* column;
    const char* title;
    const char* style;
};
constexpr std::array<Mark, 6> marks{
    {{"max_ns", "max", "lc rgb '#D55E00' pt 13 ps 1.2"},
     {"cold_p50_ns", "p50, caches emptied", "lc rgb '#56B4E9' pt 6 lw 2 ps 1.1"},
     {"p999_ns", "p99.9", "lc rgb '#E69F00' pt 11 ps 1.0"},
     {"p99_ns", "p99", "lc rgb '#009E73' pt 9 ps 1.0"},
     {"mean_ns", "mean", "lc rgb '#000000' pt 2 lw 2 ps 0.9"},
     {"p50_ns", "p50", "lc rgb '#0072B2' pt 7 ps 0.9"}}};

/// Where on the x axis a row of a method stands: LR and HR of a volume side by side.
double position(std::size_t row) {
    return 2.6 * static_cast<double>(row / 2) + static_cast<double>(row % 2);
}

struct Panel {
    std::vector<std::vector<double>> rows;  // x and the marks [us]
    std::vector<std::vector<double>> paper;
    std::string tics, names;
};

Panel panel_of(const Table& table, const std::string& method) {
    Panel panel;
    for (std::size_t i = 0; i < table.rows().size(); ++i) {
        if (table.text(i, "method") != method) continue;
        const double x = position(panel.rows.size());
        panel.tics += fmt::format("{}'{}' {}", panel.tics.empty() ? "" : ", ",
                                  table.text(i, "resolution"), x);
        if (panel.rows.size() % 2 == 0) {
            panel.names += fmt::format(
                "set label {} {} at first {}, graph -0.14 center noenhanced\n",
                panel.rows.size() / 2 + 1, gnuplot_text(table.text(i, "volume")), x + 0.5);
        }
        std::vector<double> row{x};
        for (const Mark& mark : marks) row.push_back(table.number(i, mark.column) / 1000);
        panel.rows.push_back(row);
        const double paper = table.number(i, "paper_mean_us");
        if (!std::isnan(paper)) panel.paper.push_back({x, paper});
    }
    return panel;
}

std::string script_of(const Table& table, const std::string& method, const std::string& title) {
    const Panel panel = panel_of(table, method);
    std::string script = block("rows_" + method, panel.rows) + panel.names;
    if (!panel.paper.empty()) script += block("paper_" + method, panel.paper);
    script += fmt::format(
        "set title {} noenhanced\nset xtics ({}) scale 0\nset xrange [-0.8:{}]\nplot "
        "1000 lc rgb '#404040' lw 1.5 dt 2 title 'a tick at 1 kHz', ",
        gnuplot_text(title), panel.tics, position(panel.rows.size() - 1) + 0.8);
    if (!panel.paper.empty()) {
        script += fmt::format(
            "$paper_{} with points pt 3 ps 1.3 lw 2 lc rgb '#CC79A7' title "
            "'mean in the paper', ",
            method);
    }
    // From p50 (column 7) up to the longest (column 2).
    script += fmt::format(
        "$rows_{} using 1:7:(0):($2-$7) with vectors nohead lc rgb '#b0b0b0' notitle", method);
    for (std::size_t m = 0; m < marks.size(); ++m) {
        if (std::isnan(panel.rows.front()[m + 1])) continue;
        script += fmt::format(", $rows_{} using 1:{} with points {} title {}", method, m + 2,
                              marks[m].style, gnuplot_text(marks[m].title));
    }
    return script + "\n";
}

}  // namespace

Figure performance_figure(const Table& table) {
    Figure figure;
    figure.caption =
        "Time of a proxy update while a hand explores and touches at 5 cm/s and 1 kHz, at 0.5 (LR) "
        "and 3 (HR) voxels per millimetre of hand: the exact method above, the paper's method in "
        "this implementation below. Stars: the means that the paper gives, on its machine. Where "
        "there are circles: the median when all caches were emptied before the update.";
    figure.size = {1200, 860};
    figure.script =
        "set multiplot\nset bmargin 3.6\nset lmargin 9\nset rmargin 3\nunset grid\n"
        "set grid y lc rgb '#d8d8d8' lw 1\nset ylabel 'time of an update [µs]'\n"
        "set logscale y\nset format y '%g'\nset yrange [0.02:3000]\n"
        "set key outside top center horizontal noenhanced maxrows 1 samplen 2\n"
        "set tmargin 5\nset size 1,0.53\nset origin 0,0.47\n" +
        script_of(table, "exact", "exact") +
        "unset key\nset tmargin 2\nset size 1,0.47\nset origin 0,0\n" +
        script_of(table, "paper", "the paper's method") + "unset multiplot\n";
    return figure;
}

}  // namespace palpate::evaluation
