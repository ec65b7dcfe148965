// Angles against the grid, along a short arc, and as a distribution.
#include "evaluation/fidelity/figure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "evaluation/fidelity/course.hpp"
#include "palpate/baselines/methods.hpp"

namespace palpate::evaluation {
namespace {

/// A line of a panel: which rows of the table, and how it is drawn.
struct Line {
    std::string method, samples, title, style;
};
using Lines = std::vector<Line>;

const Lines& ball_lines() {
    static const Lines lines{
        {"incumbent (measured)", "uint8", "incumbent, 8 bit (measured)", "lt 7 pt 5 ps 1.2"},
        {"gradient-improved", "uint8", "gradient-improved, 8 bit", "lt 4"},
        {"exact", "uint8", "exact, 8 bit", "lt 1"},
        {"nearest point (reference)", "uint8", "nearest point of the 8-bit surface", "lt 5 dt 3"},
        {"exact", "uint8 smoothed", "exact, 8 bit smoothed", "lt 6 dt 2 pt 9"},
        {"exact", "float32", "exact, not rounded", "lt 3 pt 13"},
    };
    return lines;
}

const Lines& shape_lines() {
    static const Lines lines{
        {"gradient-improved", "uint8", "gradient-improved, 8 bit", "lt 4"},
        {"gradient-improved", "float32", "gradient-improved, not rounded", "lt 5 dt 2"},
        {"paper", "float32", "paper, not rounded", "lt 2"},
        {"exact", "uint8", "exact, 8 bit", "lt 1"},
        {"exact", "uint8 smoothed", "exact, 8 bit smoothed", "lt 6 dt 2 pt 9"},
        {"exact", "float32", "exact, not rounded", "lt 3 pt 13"},
    };
    return lines;
}

/// Where the panels of a row are, over a key that they share.
std::string panel_place(int number, int count) {
    const double width = 0.985 / count;
    return fmt::format(
        "set lmargin at screen {}\nset rmargin at screen {}\nset bmargin at screen 0.25\n"
        "set tmargin at screen 0.93\nunset key\n",
        number * width + 0.065, (number + 1) * width - 0.005);
}

/// The key, in an empty panel as wide as the figure; the last of a figure.
std::string shared_key(const Lines& lines, const char* with) {
    std::string entries;
    for (const Line& line : lines) {
        entries += fmt::format("{}keyentry with {} {} title '{}'", entries.empty() ? "" : ", ",
                               with, line.style, line.title);
    }
    return fmt::format(
        "set lmargin at screen 0.02\nset rmargin at screen 0.98\nset bmargin at screen 0\n"
        "set tmargin at screen 0.13\nunset border\nunset tics\nunset grid\nunset title\n"
        "unset logscale\nset xlabel ''\nset ylabel ''\nset xrange [0:1]\nset yrange [0:1]\n"
        "set key noenhanced center horizontal maxcols 3 width 2\nplot -1 notitle, {}\nunset "
        "multiplot\n",
        entries);
}

/// The grids of a body on a logarithmic axis.
std::string grid_axis(const Table& table, const std::string& body) {
    std::vector<double> grids;
    for (std::size_t i = 0; i < table.rows().size(); ++i) {
        if (table.text(i, "body") == body) grids.push_back(table.number(i, "grid"));
    }
    std::sort(grids.begin(), grids.end());
    grids.erase(std::unique(grids.begin(), grids.end()), grids.end());
    std::string tics;
    for (const double grid : grids) tics += fmt::format("{}{}", tics.empty() ? "" : ", ", grid);
    return fmt::format(
        "set logscale xy\nset xlabel 'samples along an axis'\nset xtics ({})\n"
        "set format y '%g'\nset xrange [{}:{}]\n",
        tics, grids.front() / 1.15, grids.back() * 1.15);
}

/// A column against the grid; `name` tells the panel's data from the others'.
std::string panel(const Table& table, const std::string& body, const std::string& way,
                  const Lines& lines, const char* column, const std::string& name) {
    std::string blocks, plots;
    for (std::size_t l = 0; l < lines.size(); ++l) {
        const Line& line = lines[l];
        std::vector<std::vector<double>> rows;
        for (std::size_t i = 0; i < table.rows().size(); ++i) {
            if (table.text(i, "body") != body || table.text(i, "way") != way ||
                table.text(i, "method") != line.method ||
                table.text(i, "samples") != line.samples || std::isnan(table.number(i, column))) {
                continue;
            }
            rows.push_back({table.number(i, "grid"), table.number(i, column)});
        }
        if (rows.empty()) continue;
        const std::string data = name + std::to_string(l);
        blocks += block(data, rows);
        plots +=
            fmt::format("{}${} with linespoints {}", plots.empty() ? "" : ", ", data, line.style);
    }
    return blocks + "plot " + plots + "\n";
}

Figure figure_of_ball(const Table& table) {
    Figure figure;
    figure.caption =
        "The ball, gone round on a great circle 0.03 of the box below its surface: angle between "
        "the force and that of a perfect ball, mean and 99th percentile, and the median time of an "
        "update. The incumbent's numbers were measured on this protocol elsewhere.";
    figure.size = {1500, 600};
    const auto one = [&](int number, const char* column, const char* what) {
        return panel_place(number, 3) + fmt::format("set ylabel '{}'\n", what) +
               panel(table, "ball", "circle", ball_lines(), column, "p" + std::to_string(number));
    };
    figure.script = "set multiplot\n" + grid_axis(table, "ball") + "set yrange [0.05:100]\n" +
                    one(0, "off_ideal_mean_deg", "angle, mean [degrees]") +
                    one(1, "off_ideal_p99_deg", "angle, 99th percentile [degrees]") +
                    one(2, "update_median_us", "update, median [microseconds]") +
                    shared_key(ball_lines(), "linespoints");
    return figure;
}

/// Some of them in order, as a distribution: angle, and the share [%] that is no larger.
std::vector<std::vector<double>> distribution(std::vector<double> angles) {
    constexpr std::size_t most = 400;
    std::erase_if(angles, [](double angle) { return std::isnan(angle); });
    std::sort(angles.begin(), angles.end());
    std::vector<std::vector<double>> rows;
    const std::size_t step = std::max<std::size_t>(1, angles.size() / most);
    for (std::size_t i = 0; i < angles.size(); i += step) {
        rows.push_back({angles[i], 100 * double(i + 1) / double(angles.size())});
    }
    return rows;
}

/// What the three kinds of samples feel like along 12 degrees of the circle, and all round it.
Figure figure_of_facets(int grid) {
    constexpr double arc = 12;  // [degrees]
    constexpr int steps = 1500;
    Figure figure;
    figure.suffix = "facets";
    figure.caption = fmt::format(
        "The ball at grid {}, method exact. Left: the force's angle along {:g} degrees of the "
        "circle, in steps of {:g} degrees; it jumps where the SCP leaves a facet, an edge or a "
        "dent for the next. Right: its distribution all round.",
        grid, arc, arc / steps);
    figure.size = {1500, 600};
    const Lines lines{
        {"exact", name_of(Samples::uint8), "exact, 8 bit", "lt 1"},
        {"exact", name_of(Samples::smoothed), "exact, 8 bit smoothed", "lt 6 dt 2"},
        {"exact", name_of(Samples::float32), "exact, not rounded", "lt 3"},
    };
    std::string blocks, along, spread;
    for (const Samples samples : {Samples::uint8, Samples::smoothed, Samples::float32}) {
        const auto number = static_cast<std::size_t>(samples);
        const Body body = ball_by_circle(grid, samples);
        const CourseResult part = go_along(body, &update_exact, steps, 0.1, 0.1 + arc / 360);
        std::vector<std::vector<double>> rows;
        for (std::size_t i = 0; i < part.angles.size(); ++i) {
            rows.push_back({arc * double(i + 1) / steps, part.angles[i]});
        }
        const auto all = go_along(body, &update_exact, 4 * steps, 0, 1).angles;
        blocks += block(fmt::format("a{}", number), rows);
        blocks += block(fmt::format("d{}", number), distribution(all));
        const char* comma = number ? ", " : "";
        along += fmt::format("{}$a{} with lines {}", comma, number, lines[number].style);
        spread += fmt::format("{}$d{} with lines {}", comma, number, lines[number].style);
    }
    figure.script =
        "set multiplot\n" + blocks + panel_place(0, 2) +
        fmt::format(
            "set yrange [0:*]\nset xrange [0:{}]\nset ylabel 'angle of the force "
            "[degrees]'\nset xlabel 'hand along the circle [degrees]'\nplot {}\n",
            arc, along) +
        panel_place(1, 2) +
        fmt::format(
            "set logscale x\nset xrange [0.01:100]\nset yrange [0:100]\nset format x '%g'\n"
            "set xlabel 'angle of the force [degrees]'\n"
            "set ylabel 'part of the ticks with no larger angle [%]'\nplot {}\n",
            spread) +
        shared_key(lines, "lines");
    return figure;
}

Figure figure_of_shapes(const Table& table) {
    Figure figure;
    figure.suffix = "shapes";
    figure.caption =
        "Torus (a hand in its tube, on a helix) and Marschner-Lobb ripples (a hand under them, on "
        "a spiral): mean angle between the force and the true normal at the SCP. The classic "
        "ripples have 41 samples an axis, about two a wave at the rim.";
    figure.size = {1500, 600};
    figure.script =
        "set multiplot\nset ylabel 'angle, mean [degrees]'\nset yrange [0.1:100]\n"
        "set title 'torus'\n" +
        panel_place(0, 2) + grid_axis(table, "torus") +
        panel(table, "torus", "helix", shape_lines(), "angle_mean_deg", "t") +
        "set title 'Marschner-Lobb'\n" + panel_place(1, 2) + grid_axis(table, "marschner-lobb") +
        panel(table, "marschner-lobb", "spiral", shape_lines(), "angle_mean_deg", "r") +
        shared_key(shape_lines(), "linespoints");
    return figure;
}

}  // namespace

std::vector<Figure> fidelity_figures(const Table& table, int facet_grid) {
    return {figure_of_ball(table), figure_of_facets(facet_grid), figure_of_shapes(table)};
}

Figure fidelity_figure_of_users(const Table& table) {
    Figure figure;
    figure.size = {1500, 600};
    std::vector<std::string> volumes;
    bool is_known = false;
    for (std::size_t i = 0; i < table.rows().size(); ++i) {
        if (table.text(i, "method") == "exact") volumes.push_back(table.text(i, "body"));
        is_known |= !std::isnan(table.number(i, "angle_mean_deg"));
    }
    std::string tics;
    for (std::size_t v = 0; v < volumes.size(); ++v) {
        tics += fmt::format("{}{} {}", v ? ", " : "", gnuplot_text(volumes[v]), v);
    }
    Lines lines;
    std::string blocks, turns, angles;
    for (const auto& method : baselines::methods()) {
        std::vector<std::vector<double>> rows;
        for (std::size_t i = 0; i < table.rows().size(); ++i) {
            if (table.text(i, "method") != method.name) continue;
            // Side by side, or they would hide each other.
            const double x = double(rows.size()) + 0.1 * (double(lines.size()) - 1.5);
            rows.push_back({x, table.number(i, "turn_p99_deg"), table.number(i, "angle_mean_deg")});
        }
        const std::string style = method_style(method.name) + " ps 1.6";
        const char* comma = lines.empty() ? "" : ", ";
        blocks += block(fmt::format("m{}", lines.size()), rows);
        turns += fmt::format("{}$m{} using 1:2 with points {}", comma, lines.size(), style);
        angles += fmt::format("{}$m{} using 1:3 with points {}", comma, lines.size(), style);
        lines.push_back({method.name, "", method.name, style});
    }
    figure.caption = "How much the force turns from one tick to the next, 99th percentile.";
    figure.script = "set multiplot\n" + blocks + panel_place(0, is_known ? 2 : 1) +
                    fmt::format(
                        "set xtics ({}) noenhanced rotate by 15 right\n"
                        "set xrange [-0.5:{}]\nset yrange [0:*]\n"
                        "set ylabel 'turn in a tick, 99th percentile [degrees]'\n"
                        "set xlabel 'volume'\nplot {}\n",
                        tics, double(volumes.size()) - 0.5, turns);
    if (is_known) {
        figure.caption +=
            " Right: its mean angle to the true normal at the SCP, for the volumes whose true "
            "surface is known.";
        figure.script +=
            panel_place(1, 2) + "set ylabel 'angle, mean [degrees]'\nplot " + angles + "\n";
    }
    figure.script += shared_key(lines, "points");
    return figure;
}

}  // namespace palpate::evaluation
