// Panels of the update's time, and time and memory of both ways against the size of the volume.
#include "evaluation/scaling/figure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <string_view>

namespace palpate::evaluation {
namespace {

using Rows = std::vector<std::vector<double>>;

struct Curve {
    const char* column;
    double unit;  // of the axis, in the column's
    const char* title;
    const char* style;
};

constexpr std::array<Curve, 4> times{{{"p999_ns", 1000, "p99.9", "lc rgb '#E69F00' lw 2 pt 11"},
                                      {"p99_ns", 1000, "p99", "lc rgb '#009E73' lw 2 pt 9"},
                                      {"mean_ns", 1000, "mean", "lc rgb '#000000' lw 2 pt 2"},
                                      {"p50_ns", 1000, "p50", "lc rgb '#0072B2' lw 2 pt 7"}}};

std::vector<std::string> volumes_of(const Table& table, const std::string& part) {
    std::vector<std::string> names;
    for (std::size_t i = 0; i < table.rows().size(); ++i) {
        if (table.text(i, "part") != part) continue;
        const std::string& name = table.text(i, "volume");
        if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
    }
    return names;
}

struct Panel {
    const char* part;
    const char* column;  // of the x axis
    const char* axis;
    const char* title;
    const char* tics;  // of the x axis, gnuplot
};

/// Times on the left axis, tetrahedra on the right one. Of several volumes the first.
std::string panel(const Table& table, const Panel& p, bool with_key) {
    const auto names = volumes_of(table, p.part);
    Rows rows;
    for (std::size_t i = 0; i < table.rows().size(); ++i) {
        if (table.text(i, "part") != p.part || table.text(i, "volume") != names.front()) continue;
        std::vector<double> row{table.number(i, p.column)};
        if (std::string_view(p.column) == "samples") row[0] = std::cbrt(row[0]);
        if (row[0] == 0) row[0] = 0.004;  // a logarithm has no zero; the tics say what it is
        for (const Curve& curve : times) row.push_back(table.number(i, curve.column) / curve.unit);
        row.push_back(table.number(i, "tetrahedra_per_update"));
        rows.push_back(row);
    }
    const std::string title =
        names.front().ends_with("ball") ? p.title : p.title + (": " + names.front());
    std::string script = block(fmt::format("part_{}", p.column), rows);
    const auto [least, most] = std::minmax_element(
        rows.begin(), rows.end(), [](const auto& a, const auto& b) { return a[0] < b[0]; });
    script += fmt::format("set xrange [{}:{}]\n", 0.75 * (*least)[0], (*most)[0] / 0.75);
    script += fmt::format("set title {} noenhanced\nset xlabel {}\n{}\n{}\nplot ",
                          gnuplot_text(title), gnuplot_text(p.axis), p.tics,
                          with_key ? "set key top left reverse Left samplen 2.5" : "unset key");
    for (std::size_t c = 0; c < times.size(); ++c) {
        script += fmt::format("$part_{} using 1:{} with linespoints {} title '{}', ", p.column,
                              c + 2, times[c].style, times[c].title);
    }
    return script + fmt::format(
                        "$part_{} using 1:6 axes x1y2 with linespoints lc rgb '#CC79A7' "
                        "lw 2 dt 2 pt 12 title 'tetrahedra (right axis)'\n",
                        p.column);
}

double largest(const Table& table, const std::string& column) {
    double most = 0;
    for (std::size_t i = 0; i < table.rows().size(); ++i) {
        const double value = table.number(i, column);
        if (value > most) most = value;
    }
    return most;
}

Figure growth_figure(const Table& table) {
    Figure figure;
    figure.caption =
        "What the time of an update grows with: the hand's speed; the voxels per millimetre of "
        "hand, the same ball sampled more finely; the edge of the volume, the same motion in the "
        "same samples; white noise added to the ball, as a part of its range. Right axis: "
        "tetrahedra that the proxy moves through in an update.";
    std::vector<Panel> panels{
        {"speed", "speed_mm_s", "speed of the hand [mm/s]", "speed", "set xtics auto"},
        {"voxels-per-mm", "voxels_per_mm", "voxels per mm of hand", "resolution",
         "set xtics (0.25, 0.5, 1, 2, 4, 8)"}};
    if (!volumes_of(table, "size").empty()) {
        panels.push_back({"size", "samples", "edge of the volume [samples]", "size of the volume",
                          "set xtics (64, 128, 256, 512, 1024)"});
        panels.push_back({"noise", "noise_of_range", "amplitude of the noise / range",
                          "complexity of the contact",
                          "set xtics ('0' 0.004, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1)"});
    }
    figure.size = {1200, panels.size() > 2 ? 900 : 480};
    figure.script = fmt::format(
        "set multiplot layout {0},2\nset logscale xyy2\nset format x '%g'\nset format y '%g'\n"
        "set format y2 '%g'\nset ytics nomirror\nset y2tics\nset yrange [0.05:{1}]\n"
        "set y2range [0.05:{1}]\nset ylabel 'time of an update [µs]'\n"
        "set y2label 'tetrahedra an update'\n",
        panels.size() / 2, std::max(60.0, largest(table, "p999_ns") / 100));
    for (const Panel& p : panels) figure.script += panel(table, p, &p == &panels[1]);
    figure.script += "unset multiplot\n";
    return figure;
}

/// Rows of the explicit part: the balls to be joined by a line, or all others.
Rows compared(const Table& table, bool balls) {
    Rows rows;
    for (std::size_t i = 0; i < table.rows().size(); ++i) {
        if (table.text(i, "part") != "explicit") continue;
        if ((table.text(i, "volume") == "ball") != balls) continue;
        const auto value = [&](const char* column) { return table.number(i, column); };
        rows.push_back({value("samples"), value("explicit_extraction_s") + value("explicit_tree_s"),
                        1e-9 * value("explicit_segment_ns"), 1e-9 * value("change_p99_ns"),
                        1e-9 * value("mean_ns"), value("explicit_peak_bytes"),
                        value("explicit_mesh_bytes") + value("explicit_tree_bytes"),
                        value("samples_bytes"), value("state_bytes")});
    }
    return rows;
}

/// One drawing of compared(): its column, number within a row.
struct Way {
    int column;
    const char* title;
    const char* style;
};
constexpr std::array<Way, 4> in_time{
    {{2, "explicit: extract and build a tree", "lc rgb '#D55E00' lw 2.5 pt 5 ps 1.2"},
     {3, "explicit: then, one segment query", "lc rgb '#D55E00' lw 2 dt 2 pt 4 ps 1.1"},
     {4, "dynamic: the update that follows (p99)", "lc rgb '#0072B2' lw 2.5 pt 7 ps 1.2"},
     {5, "dynamic: any other update (mean)", "lc rgb '#0072B2' lw 2 dt 2 pt 6 ps 1.1"}}};
constexpr std::array<Way, 4> in_memory{
    {{6, "explicit: at the peak", "lc rgb '#D55E00' lw 2.5 pt 5 ps 1.2"},
     {7, "explicit: mesh and tree, kept", "lc rgb '#D55E00' lw 2 dt 2 pt 4 ps 1.1"},
     {9, "dynamic: the proxy", "lc rgb '#0072B2' lw 2.5 pt 7 ps 1.2"},
     {8, "both: the samples", "lc rgb '#808080' lw 2 dt 3 pt 1 ps 1"}}};

/// The names of single volumes beside their marks of a column.
std::string names_at(const Table& table, int column) {
    std::string script;
    const Rows others = compared(table, false);
    std::size_t number = 0;
    for (std::size_t i = 0; i < table.rows().size(); ++i) {
        if (table.text(i, "part") != "explicit" || table.text(i, "volume") == "ball") continue;
        const auto& row = others[number++];
        const double y = row[static_cast<std::size_t>(column) - 1];
        if (std::isnan(y)) continue;
        // In turn to the left and to the right, so that neighbours do not cover one another.
        script += fmt::format("set label {} at {}, {} {} textcolor '#404040' noenhanced\n",
                              gnuplot_text(table.text(i, "volume")), row[0], y,
                              number % 2 == 1 ? "right offset -0.9,0.2" : "left offset 0.9,0.4");
    }
    return script;
}

/// How long it takes at the largest ball, above that mark.
std::string time_at(const Table& table, int column, const char* colour) {
    const Rows balls = compared(table, true);
    if (balls.empty()) return {};
    const double y = balls.back()[static_cast<std::size_t>(column) - 1];
    if (std::isnan(y)) return {};
    const std::string text = y < 1e-3 ? fmt::format("{:.2g} µs", 1e6 * y)
                             : y < 1  ? fmt::format("{:.2g} ms", 1e3 * y)
                                      : fmt::format("{:.2g} s", y);
    return fmt::format("set label '{}' at {}, {} center offset 0,0.9 textcolor rgb '{}'\n", text,
                       balls.back()[0], y, colour);
}

template <std::size_t Count>
std::string ways(const std::array<Way, Count>& drawn, const Table& table) {
    std::string script;
    const bool balls = !compared(table, true).empty(), others = !compared(table, false).empty();
    for (const Way& way : drawn) {
        const std::string title = gnuplot_text(way.title);
        if (balls) {
            script += fmt::format("{}$balls using 1:{} with linespoints {} title {}",
                                  script.empty() ? "" : ", ", way.column, way.style, title);
        }
        if (others) {
            script +=
                fmt::format("{}$others using 1:{} with points {} {}", script.empty() ? "" : ", ",
                            way.column, way.style, balls ? "notitle" : "title " + title);
        }
    }
    return script;
}

Figure explicit_figure(const Table& table) {
    Figure figure;
    figure.suffix = "explicit";
    figure.caption =
        "After a change of the isovalue by a tenth of the data's range: the explicit way extracts "
        "the whole isosurface (VTK, flying edges) and builds a tree of boxes on it, the dynamic "
        "way "
        "updates its proxy. Left: the time until the new surface is felt. Right: the memory that "
        "it takes. Lines: a ball that grows with the volume; single marks: other volumes.";
    figure.size = {1200, 620};
    Rows all = compared(table, true);
    const Rows others = compared(table, false);
    figure.script += block("balls", all) + block("others", others);
    all.insert(all.end(), others.begin(), others.end());
    double least = all.front()[0], most = least;
    for (const auto& row : all) {
        least = std::min(least, row[0]);
        most = std::max(most, row[0]);
    }
    figure.script += fmt::format(
        "set multiplot layout 1,2\nset logscale xy\nset xrange [{}:{}]\n"
        "set xlabel 'size of the volume [samples]'\n"
        "set xtics ('32³' 32768, '64³' 262144, '128³' 2097152, '256³' 16777216, "
        "'512³' 134217728, '1024³' 1073741824)\n"
        "set bmargin 10.5\nset key at graph -0.02, -0.2 left top Left reverse maxcols 1 samplen "
        "3\n",
        least / 2, most * 2);
    figure.script +=
        names_at(table, 2) + names_at(table, 4) + time_at(table, 2, "#D55E00") +
        time_at(table, 4, "#0072B2") +
        "set title 'time until the new surface is felt'\nset ylabel 'time'\n"
        "set ytics ('100 ns' 1e-7, '1 µs' 1e-6, '10 µs' 1e-5, '100 µs' 1e-4, '1 ms' 1e-3, "
        "'10 ms' 1e-2, '100 ms' 0.1, '1 s' 1, '10 s' 10)\nset yrange [1e-7:100]\nplot " +
        ways(in_time, table) +
        ", 1e-3 lc rgb '#404040' lw 1.5 dt 4 title 'a tick at 1 kHz'\nunset label\n";
    figure.script += names_at(table, 6) +
                     "set title 'memory that it takes'\nset ylabel 'memory'\nset ytics auto\n"
                     "set format y '%.0s %cB'\nset yrange [10:2e10]\nplot " +
                     ways(in_memory, table) + "\nunset multiplot\n";
    return figure;
}

}  // namespace

std::vector<Figure> scaling_figures(const Table& table) {
    return {growth_figure(table), explicit_figure(table)};
}

}  // namespace palpate::evaluation
