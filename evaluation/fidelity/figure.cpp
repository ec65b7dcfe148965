// Angles of the force against the grid, along a short arc, and as a distribution.
#include "evaluation/fidelity/figure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "evaluation/fidelity/trajectory.hpp"
#include "palpate/baselines/methods.hpp"

namespace palpate::evaluation {
namespace {

/// A line of a panel: which rows of the table, and how it is drawn.
struct Line {
    std::string method, samples, title;
    Look look;
};
using Lines = std::vector<Line>;

constexpr Look incumbent_look{colours::black, Marker::square, 1.2};
constexpr Look smoothed_look{colours::sky, Marker::triangle, 1, 2, Dash::dashed};
constexpr Look float_look{colours::green, Marker::diamond};

Lines ball_lines() {
    return {{"incumbent (measured)", "uint8", "incumbent, 8 bit (measured)", incumbent_look},
            {"gradient-improved", "uint8", "gradient-improved, 8 bit", look_of(3)},
            {"exact", "uint8", "exact, 8 bit", look_of(0)},
            {"nearest point (reference)",
             "uint8",
             "nearest point of the 8-bit surface",
             {colours::orange, Marker::triangle_down, 1, 2, Dash::dotted}},
            {"exact", "uint8 smoothed", "exact, 8 bit smoothed", smoothed_look},
            {"exact", "float32", "exact, not rounded", float_look}};
}

Lines shape_lines() {
    return {{"gradient-improved", "uint8", "gradient-improved, 8 bit", look_of(3)},
            {"gradient-improved",
             "float32",
             "gradient-improved, not rounded",
             {colours::orange, Marker::triangle_down, 1, 2, Dash::dashed}},
            {"paper", "float32", "paper, not rounded", look_of(1)},
            {"exact", "uint8", "exact, 8 bit", look_of(0)},
            {"exact", "uint8 smoothed", "exact, 8 bit smoothed", smoothed_look},
            {"exact", "float32", "exact, not rounded", float_look}};
}

Figure empty_figure(std::size_t columns) {
    Figure figure;
    figure.width = 1500;
    figure.height = 600;
    figure.columns = columns;
    return figure;
}

/// A column against the grid, for one body and one trajectory of the hand.
Panel panel_of(const Table& all, const std::string& body, const std::string& trajectory,
               const Lines& lines, const char* column, const char* what) {
    const Table table = all.where("body", body).where("trajectory", trajectory);
    std::vector<double> grids = table.distinct_numbers("grid");
    std::sort(grids.begin(), grids.end());
    Panel panel;
    panel.x = {.title = "samples along an axis",
               .is_logarithmic = true,
               .low = grids.front() / 1.15,
               .high = grids.back() * 1.15,
               .ticks = ticks_at(grids)};
    panel.y = {.title = what, .is_logarithmic = true, .low = 0.05, .high = 100};
    for (const Line& line : lines) {
        Rows rows = table.where("method", line.method)
                        .where("samples", line.samples)
                        .rows_of({"grid", column});
        std::erase_if(rows, [](const auto& row) { return std::isnan(row[1]); });
        panel.add(Draw::line_points, line.title, line.look, std::move(rows));
    }
    return panel;
}

Figure figure_of_ball(const Table& table) {
    Figure figure = empty_figure(3);
    figure.caption =
        "The ball; the hand follows a great circle 0.03 of the box below its surface: angle "
        "between the force and that of a perfect ball, mean and 99th percentile, and the median "
        "time of an update. The incumbent's numbers were measured on this protocol elsewhere.";
    const auto panel = [&](const char* column, const char* what) {
        return panel_of(table, "ball", "circle", ball_lines(), column, what);
    };
    figure.panels = {panel("off_ideal_mean_deg", "angle, mean [degrees]"),
                     panel("off_ideal_p99_deg", "angle, 99th percentile [degrees]"),
                     panel("update_median_us", "update, median [microseconds]")};
    return figure;
}

/// Some of the angles in order, each with the share [%] of all that is no larger.
Rows distribution(std::vector<double> angles) {
    constexpr std::size_t most = 400;
    std::erase_if(angles, [](double angle) { return std::isnan(angle); });
    std::sort(angles.begin(), angles.end());
    Rows rows;
    const std::size_t step = std::max<std::size_t>(1, angles.size() / most);
    for (std::size_t i = 0; i < angles.size(); i += step) {
        rows.push_back({angles[i], 100 * double(i + 1) / double(angles.size())});
    }
    return rows;
}

/// The force on the three kinds of samples along 12 degrees of the circle, and all round it.
Figure figure_of_facets(int grid) {
    constexpr double arc = 12;  // [degrees]
    constexpr int steps = 1500;
    Figure figure = empty_figure(2);
    figure.suffix = "facets";
    figure.caption = fmt::format(
        "The ball at grid {}, method exact. Left: the force's angle along {:g} degrees of the "
        "circle, in steps of {:g} degrees; it jumps where the SCP leaves a facet, an edge or a "
        "dent for the next. Right: its distribution all round.",
        grid, arc, arc / steps);
    Panel along, spread;
    along.x = {.title = "hand along the circle [degrees]", .low = 0, .high = arc};
    along.y = {.title = "angle of the force [degrees]", .low = 0};
    spread.x = {
        .title = "angle of the force [degrees]", .is_logarithmic = true, .low = 0.01, .high = 100};
    spread.y = {.title = "part of the ticks with no larger angle [%]", .low = 0, .high = 100};
    const auto add = [&](Samples samples, const char* title, const Look& look) {
        const Body body = ball_by_circle(grid, samples);
        const auto part = follow(body, &update_exact, steps, 0.1, 0.1 + arc / 360).angles;
        Rows rows;
        for (const double angle : part) {
            rows.push_back({arc * double(rows.size() + 1) / steps, angle});
        }
        const auto all = follow(body, &update_exact, 4 * steps, 0, 1).angles;
        along.add(Draw::line, title, look, std::move(rows));
        spread.add(Draw::line, title, look, distribution(all));
    };
    add(Samples::uint8, "exact, 8 bit", {colours::blue});
    add(Samples::smoothed, "exact, 8 bit smoothed", {.colour = colours::sky, .dash = Dash::dashed});
    add(Samples::float32, "exact, not rounded", {colours::green});
    figure.panels = {std::move(along), std::move(spread)};
    return figure;
}

Figure figure_of_shapes(const Table& table) {
    Figure figure = empty_figure(2);
    figure.suffix = "shapes";
    figure.caption =
        "Torus (a hand in its tube, on a helix) and Marschner-Lobb ripples (a hand under them, on "
        "a spiral): mean angle between the force and the true normal at the SCP. The classic "
        "ripples have 41 samples an axis, about two a wave at the rim.";
    const auto panel = [&](const char* body, const char* trajectory, const char* title) {
        Panel made = panel_of(table, body, trajectory, shape_lines(), "angle_mean_deg",
                              "angle, mean [degrees]");
        made.title = title;
        made.y.low = 0.1;
        return made;
    };
    figure.panels = {panel("torus", "helix", "torus"),
                     panel("marschner-lobb", "spiral", "Marschner-Lobb")};
    return figure;
}

}  // namespace

std::vector<Figure> fidelity_figures(const Table& table, int facet_grid) {
    return {figure_of_ball(table), figure_of_facets(facet_grid), figure_of_shapes(table)};
}

Figure fidelity_figure_of_users(const Table& table) {
    const std::vector<std::string> volumes = table.where("method", "exact").distinct("body");
    const auto panel = [&](const char* column, const char* what) {
        Panel made;
        made.x = axis_named(volumes);
        made.x.title = "volume";
        made.x.turned = 15;
        made.y = {.title = what, .low = 0};
        for (const auto& method : baselines::methods()) {
            Look look = look_of_method(method.name);
            look.size = 1.6;
            // Side by side, or they would hide each other.
            double x = 0.1 * (double(made.series.size()) - 1.5);
            Rows rows;
            for (const double value : table.where("method", method.name).numbers(column)) {
                rows.push_back({x++, value});
            }
            made.add(Draw::points, method.name, look, std::move(rows));
        }
        return made;
    };
    const auto angles = table.numbers("angle_mean_deg");
    const bool is_known =
        !std::all_of(angles.begin(), angles.end(), [](double angle) { return std::isnan(angle); });
    Figure figure = empty_figure(is_known ? 2 : 1);
    figure.caption = "How much the force turns from one tick to the next, 99th percentile.";
    figure.panels = {panel("turn_p99_deg", "turn in a tick, 99th percentile [degrees]")};
    if (is_known) {
        figure.caption +=
            " Right: its mean angle to the true normal at the SCP, for the volumes whose true "
            "surface is known.";
        figure.panels.push_back(panel("angle_mean_deg", "angle, mean [degrees]"));
    }
    return figure;
}

}  // namespace palpate::evaluation
