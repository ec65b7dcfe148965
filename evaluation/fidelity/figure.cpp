// Angles of the force against the grid, along a short arc, and as a distribution.
#include "evaluation/fidelity/figure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "evaluation/fidelity/trajectory.hpp"
#include "palpate/density.hpp"

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
constexpr Look dequantized_look{colours::orange, Marker::circle, 1.2};
constexpr Look smooth_look{colours::vermilion, Marker::open_square, 1.2};

Lines ball_lines() {
    return {{"incumbent (measured)", "uint8", "incumbent, 8 bit (measured)", incumbent_look},
            {"gradient-improved", "uint8", "gradient-improved, 8 bit", look_of(3)},
            {"exact", "uint8", "exact, 8 bit", look_of(0)},
            {"nearest point (reference)",
             "uint8",
             "nearest point of the 8-bit surface",
             {colours::orange, Marker::triangle_down, 1, 2, Dash::dotted}},
            {"exact", "uint8 smoothed", "exact, 8 bit smoothed", smoothed_look},
            {"exact", "float32", "exact, not rounded", float_look},
            {"smooth", "uint8 dequantized", "smooth, 8 bit dequantized", dequantized_look},
            {"smooth", "float32", "smooth, not rounded", smooth_look}};
}

/// What becomes of 8-bit samples, on both fields.
Lines terrace_lines() {
    return {{"exact", "uint8", "linear, 8 bit", look_of(0)},
            {"exact", "uint8 smoothed", "linear, smoothed", smoothed_look},
            {"exact",
             "uint8 dequantized",
             "linear, dequantized",
             {colours::purple, Marker::open_diamond, 1, 2, Dash::dotted}},
            {"exact", "float32", "linear, not rounded", float_look},
            {"smooth",
             "uint8",
             "smooth, 8 bit",
             {colours::black, Marker::open_circle, 1, 2, Dash::dashed}},
            {"smooth",
             "uint8 smoothed",
             "smooth, smoothed",
             {colours::yellow, Marker::open_triangle, 1, 2, Dash::dashed}},
            {"smooth", "uint8 dequantized", "smooth, dequantized", dequantized_look},
            {"smooth", "float32", "smooth, not rounded", smooth_look}};
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
            {"exact", "float32", "exact, not rounded", float_look},
            {"smooth", "uint8 dequantized", "smooth, 8 bit dequantized", dequantized_look},
            {"smooth", "float32", "smooth, not rounded", smooth_look}};
}

constexpr double lowest_angle = 1e-4;  // [degrees] that is drawn

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
    panel.y = {.title = what, .is_logarithmic = true, .low = lowest_angle, .high = 100};
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
    figure.panels.back().y.low = 0.05;
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
        const auto part = follow(body, contestant("exact"), steps, 0.1, 0.1 + arc / 360).angles;
        Rows rows;
        for (const double angle : part) {
            rows.push_back({arc * double(rows.size() + 1) / steps, angle});
        }
        const auto all = follow(body, contestant("exact"), 4 * steps, 0, 1).angles;
        along.add(Draw::line, title, look, std::move(rows));
        spread.add(Draw::line, title, look, distribution(all));
    };
    add(Samples::uint8, "exact, 8 bit", {colours::blue});
    add(Samples::smoothed, "exact, 8 bit smoothed", {.colour = colours::sky, .dash = Dash::dashed});
    add(Samples::float32, "exact, not rounded", {colours::green});
    figure.panels = {std::move(along), std::move(spread)};
    return figure;
}

/// How far the force turns from tick to tick, tick by tick and as a distribution, on both fields.
Figure figure_of_turn(int grid) {
    constexpr double arc = 12;  // [degrees]
    constexpr int steps = 1500;
    Figure figure = empty_figure(2);
    figure.suffix = "turn";
    figure.caption = fmt::format(
        "The turn of the force along a stroke: the ball at grid {}, the hand goes on by {:g} "
        "degrees of the circle in a tick, and the force of a perfect ball turns by as much "
        "(dashed). "
        "Left: over {:g} degrees; on the linear field it turns where the proxy passes from facet "
        "to "
        "facet. Right: the distribution of the turns. Not rounded, and 8 bits dequantized.",
        grid, arc / steps, arc);
    Panel along, spread;
    along.x = {.title = "hand along the circle [degrees]", .low = 0, .high = arc};
    along.y = {.title = "turn of the force in a tick [degrees]",
               .is_logarithmic = true,
               .low = 1e-4,
               .high = 10};
    spread.x = {
        .title = "turn in a tick [degrees]", .is_logarithmic = true, .low = 1e-4, .high = 10};
    spread.y = {.title = "part of the ticks with no larger turn [%]", .low = 0, .high = 100};
    const auto add = [&](const char* field, Samples samples, const char* title, const Look& look) {
        const Body body = ball_by_circle(grid, samples);
        const auto turns = follow(body, contestant(field), steps, 0.1, 0.1 + arc / 360).turns;
        Rows rows;
        for (const double turn : turns) {
            rows.push_back({arc * double(rows.size() + 1) / steps, std::max(turn, 1e-4)});
        }
        along.add(Draw::line, title, look, std::move(rows));
        spread.add(Draw::line, title, look, distribution(turns));
    };
    add("exact", Samples::dequantized, "linear, 8 bit dequantized",
        {.colour = colours::sky, .width = 1});
    add("exact", Samples::float32, "linear, not rounded", {.colour = colours::green, .width = 1});
    add("smooth", Samples::dequantized, "smooth, 8 bit dequantized", {colours::orange});
    add("smooth", Samples::float32, "smooth, not rounded", {colours::vermilion});
    along.add_level(arc / steps, "the ball's own",
                    {.colour = colours::dark_grey, .dash = Dash::dashed});
    figure.panels = {std::move(along), std::move(spread)};
    return figure;
}

Figure figure_of_terraces(const Table& table) {
    Figure figure = empty_figure(2);
    figure.suffix = "terraces";
    figure.caption =
        "The terraces of 8-bit data: angle of the force on the ball, from 8-bit samples as they "
        "are, "
        "smoothed in one pass, dequantized, and from samples that were never rounded; on the "
        "linear "
        "and on the smooth field.";
    const auto panel = [&](const char* column, const char* what) {
        return panel_of(table, "ball", "circle", terrace_lines(), column, what);
    };
    figure.panels = {panel("off_ideal_mean_deg", "angle, mean [degrees]"),
                     panel("off_ideal_p99_deg", "angle, 99th percentile [degrees]")};
    return figure;
}

/// Across a wall of so many samples of 1 in 0.
Rows across_wall(int samples, Interpolation interpolation) {
    std::vector<float> values(15 * 15 * 15, 0);
    for (std::size_t i = 0; i < values.size(); ++i) {
        const int x = static_cast<int>(i % 15) - 7;
        values[i] = x > -samples && x <= 0 ? 1 : 0;
    }
    const Field field(Volume({.size = Index3::Constant(15)}, std::move(values)), Solid::above,
                      std::nullopt, interpolation);
    const double middle = 7 - 0.5 * (samples - 1);
    Rows rows;
    for (int i = -60; i <= 60; ++i) {
        rows.push_back({i / 20.0, value_at(field, Vec3(middle + i / 20.0, 7, 7))});
    }
    return rows;
}

/// What the smooth field costs: the height of thin walls, and a bias where surfaces curve.
Figure figure_of_losses(const Table& table) {
    Figure figure = empty_figure(2);
    figure.suffix = "losses";
    figure.caption =
        "What the smooth field costs. Left: density across walls of one, two and three samples of "
        "1 "
        "in 0; the linear field (dashed) keeps their height, the smooth one keeps 3/4 of a wall of "
        "one sample. Right: how far the SCP is from the true surface of the ball on average, not "
        "rounded: the smooth field lies inside a convex body by an eighth of its Laplacian.";
    Panel walls;
    walls.x = {.title = "across the wall [voxel]", .low = -3, .high = 3};
    walls.y = {.title = "density", .low = 0, .high = 1.1};
    constexpr std::array<const char*, 3> hues{colours::vermilion, colours::blue, colours::green};
    for (int samples = 1; samples <= 3; ++samples) {
        const char* const hue = hues[static_cast<std::size_t>(samples - 1)];
        walls.add(Draw::line, fmt::format("{} thick, linear", samples),
                  {.colour = hue, .dash = Dash::dashed},
                  across_wall(samples, Interpolation::linear));
        walls.add(Draw::line, fmt::format("{} thick, smooth", samples), {.colour = hue},
                  across_wall(samples, Interpolation::cubic));
    }
    Panel bias = panel_of(
        table, "ball", "circle",
        {{"exact", "float32", "linear", float_look}, {"smooth", "float32", "smooth", smooth_look}},
        "surface_error_mean_voxel", "distance from the true surface [voxel]");
    bias.y.high = 0.1;
    figure.panels = {std::move(walls), std::move(bias)};
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
        made.y.low = 0.01;
        return made;
    };
    figure.panels = {panel("torus", "helix", "torus"),
                     panel("marschner-lobb", "spiral", "Marschner-Lobb")};
    return figure;
}

}  // namespace

std::vector<Figure> fidelity_figures(const Table& table, int facet_grid) {
    return {figure_of_ball(table),     figure_of_facets(facet_grid), figure_of_turn(facet_grid),
            figure_of_terraces(table), figure_of_losses(table),      figure_of_shapes(table)};
}

Figure fidelity_figure_of_users(const Table& table) {
    const std::vector<std::string> volumes = table.where("method", "exact").distinct("body");
    const auto panel = [&](const char* column, const char* what) {
        Panel made;
        made.x = axis_named(volumes);
        made.x.title = "volume";
        made.x.turned = 15;
        made.y = {.title = what, .low = 0};
        for (const Contestant& one : contestants()) {
            Look look = look_of_method(one.name);
            look.size = 1.6;
            // Side by side, or they would hide each other.
            double x = 0.1 * (double(made.series.size()) - 2);
            Rows rows;
            for (const double value : table.where("method", one.name).numbers(column)) {
                rows.push_back({x++, value});
            }
            made.add(Draw::points, one.name, look, std::move(rows));
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
