// Panels of the update's time, and of time and memory of both approaches against the volume's size.
#include "evaluation/scaling/report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

namespace palpate::evaluation {
namespace {

struct Growth {
    const char* part;
    const char* column;  // of the x axis
    const char* axis;
    const char* title;
    std::vector<AxisTick> ticks;
};

constexpr double no_noise = 0.004;  // where 0 is on a logarithmic axis

/// Times on the left axis, tetrahedra on the right one. Of several volumes the first.
Panel panel_of(const Table& table, const Growth& growth, double most_us) {
    const Table part = table.where("part", growth.part);
    const std::string volume = part.text(0, "volume");
    const Table both = part.where("volume", volume);
    const Table exact = both.where("method", "exact"), smooth = both.where("method", "smooth");
    std::vector<double> x = exact.numbers(growth.column);
    for (double& value : x) {
        if (growth.column == std::string("samples")) value = std::cbrt(value);
        value = std::max(value, no_noise);
    }
    Panel panel;
    panel.title = volume.ends_with("ball") ? growth.title : growth.title + (": " + volume);
    panel.x = {.title = growth.axis,
               .is_logarithmic = true,
               .low = 0.75 * smallest(x, 1e9),
               .high = largest(x) / 0.75,
               .ticks = growth.ticks};
    panel.y = {
        .title = "time of an update [µs]", .is_logarithmic = true, .low = 0.05, .high = most_us};
    panel.right = panel.y;
    panel.right->title = "tetrahedra an update";
    const auto add = [&](const char* title, const Look& look, const char* column, double unit,
                         const Table& rows) {
        Rows points;
        for (const double value : rows.numbers(column)) {
            points.push_back({x[points.size()], value / unit});
        }
        return &panel.add(Draw::line_points, title, look, std::move(points));
    };
    add("p99.9", {colours::orange, Marker::triangle_down}, "p999_ns", 1000, exact);
    add("p99", {colours::green, Marker::triangle}, "p99_ns", 1000, exact);
    add("mean", {colours::black, Marker::cross}, "mean_ns", 1000, exact);
    add("p50", {colours::blue, Marker::circle}, "p50_ns", 1000, exact);
    add("mean, smooth field", {colours::vermilion, Marker::open_square}, "mean_ns", 1000, smooth);
    add("tetrahedra (right axis)", {colours::purple, Marker::open_diamond, 1, 2, Dash::dashed},
        "tetrahedra_per_update", 1, exact)
        ->on_right_axis = true;
    return panel;
}

Figure growth_figure(const Table& table) {
    Figure figure;
    figure.caption =
        "What the time of an update grows with: the hand's speed; the voxels per millimetre of "
        "hand, the same ball sampled more finely; the edge of the volume, the same motion in the "
        "same samples; white noise added to the ball, as a part of its range. On the linear field, "
        "and the mean on the smooth one. Right axis: "
        "tetrahedra that the proxy moves through in an update.";
    std::vector<AxisTick> noises = ticks_at({0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1});
    noises.push_back({no_noise, "0"});
    const std::array<Growth, 4> all{
        {{"speed", "speed_mm_s", "speed of the hand [mm/s]", "speed", {}},
         {"voxels-per-mm", "voxels_per_mm", "voxels per mm of hand", "resolution",
          ticks_at({0.25, 0.5, 1, 2, 4, 8})},
         {"size", "samples", "edge of the volume [samples]", "size of the volume",
          ticks_at({64, 128, 256, 512, 1024})},
         {"noise", "noise_of_range", "amplitude of the noise / range", "complexity of the contact",
          noises}}};
    const double most_us = std::max(60.0, largest(table.numbers("p999_ns")) / 100);
    for (const Growth& growth : all) {
        if (table.where("part", growth.part).rows().empty()) continue;
        figure.panels.push_back(panel_of(table, growth, most_us));
    }
    figure.columns = 2;
    figure.height = figure.panels.size() > 2 ? 900 : 480;
    return figure;
}

/// A column of the explicit part, in seconds or bytes.
struct Curve {
    const char* title;
    Look look;
    const char* column;
    double unit;            // of the column
    bool is_named = false;  ///< single marks are named, and the last ball has its time beside it
};

constexpr Look explicit_change{colours::vermilion, Marker::square, 1.2, 2.5};
constexpr Look explicit_rest{colours::vermilion, Marker::open_square, 1.1, 2, Dash::dashed};
constexpr Look dynamic_change{colours::blue, Marker::circle, 1.2, 2.5};
constexpr Look dynamic_rest{colours::blue, Marker::open_circle, 1.1, 2, Dash::dashed};
constexpr Look samples_look{colours::grey, Marker::plus, 1, 2, Dash::dotted};

constexpr std::array<Curve, 4> time_curves{
    {{"explicit: extract and build a hierarchy", explicit_change, "explicit_ready_s", 1, true},
     {"explicit: then, one segment query", explicit_rest, "explicit_segment_ns", 1e-9},
     {"dynamic: the update that follows (p99)", dynamic_change, "change_p99_ns", 1e-9, true},
     {"dynamic: any other update (mean)", dynamic_rest, "mean_ns", 1e-9}}};
constexpr std::array<Curve, 4> memory_curves{
    {{"explicit: at the peak", explicit_change, "explicit_peak_bytes", 1, true},
     {"explicit: mesh and hierarchy, kept", explicit_rest, "explicit_kept_bytes", 1},
     {"dynamic: the proxy", dynamic_change, "state_bytes", 1},
     {"both: the samples", samples_look, "samples_bytes", 1}}};

/// Lines through the balls, single marks for other volumes.
void add_curve(Panel& panel, const Table& table, const Curve& curve, bool has_times) {
    Rows balls, others;
    int named = 0;
    for (std::size_t i = 0; i < table.rows().size(); ++i) {
        const std::vector<double> point{table.number(i, "samples"),
                                        curve.unit * table.number(i, curve.column)};
        if (std::isnan(point[1])) continue;
        const bool is_ball = table.text(i, "volume") == "ball";
        (is_ball ? balls : others).push_back(point);
        if (is_ball || !curve.is_named) continue;
        // In turn to the left and to the right, so that neighbours do not cover one another.
        const bool is_left = named++ % 2 == 0;
        Series& name = panel.add(Draw::text, "", {colours::dark_grey}, {point});
        name.labels = {table.text(i, "volume")};
        name.text = {.align = is_left ? Align::right : Align::left,
                     .right = is_left ? -0.9 : 0.9,
                     .up = is_left ? 0.2 : 0.4};
    }
    if (has_times && curve.is_named && !balls.empty()) {
        Series& time = panel.add(Draw::text, "", {curve.look.colour}, {balls.back()});
        time.labels = {time_text(balls.back()[1])};
        time.text.up = 0.9;
    }
    panel.add(Draw::line_points, curve.title, curve.look, std::move(balls));
    panel.add(Draw::points, curve.title, curve.look, std::move(others));
}

Figure explicit_figure(const Table& all) {
    const Table table = all.where("part", "explicit");
    Figure figure;
    figure.suffix = "explicit";
    figure.caption =
        "After a change of the isovalue by a tenth of the data's range: the explicit approach "
        "extracts the whole isosurface (VTK, flying edges) and builds a bounding volume hierarchy "
        "on it (Embree), the dynamic approach updates its proxy. Left: the time until the new "
        "surface is felt. Right: the memory that it takes. Lines: a ball that grows with the "
        "volume; single marks: other volumes.";
    figure.height = 640;
    figure.columns = 2;
    const std::vector<double> samples = table.numbers("samples");
    Panel time, memory;
    time.x = {.title = "size of the volume [samples]",
              .is_logarithmic = true,
              .low = smallest(samples, 1e18) / 2,
              .high = largest(samples) * 2,
              .ticks = {}};
    for (const int edge : {32, 64, 128, 256, 512, 1024}) {
        time.x.ticks.push_back({std::pow(edge, 3), fmt::format("{}³", edge)});
    }
    memory.x = time.x;
    time.title = "time until the new surface is felt";
    time.y = {.title = "time", .is_logarithmic = true, .low = 1e-8, .high = 100};
    for (double seconds = 1e-8; seconds < 20; seconds *= 10) {
        time.y.ticks.push_back({seconds, time_text(1.0001 * seconds)});
    }
    memory.title = "memory that it takes";
    memory.y = {.title = "memory",
                .is_logarithmic = true,
                .low = 10,
                .high = 2e10,
                .ticks = {},
                .format = "%.0s %cB"};
    for (const Curve& curve : time_curves) add_curve(time, table, curve, true);
    for (const Curve& curve : memory_curves) add_curve(memory, table, curve, false);
    time.add_level(1e-3, "a tick at 1 kHz",
                   {.colour = colours::dark_grey, .dash = Dash::dash_dotted});
    figure.panels = {std::move(time), std::move(memory)};
    return figure;
}

}  // namespace

std::vector<Figure> scaling_figures(const Table& table) {
    return {growth_figure(table), explicit_figure(table)};
}

}  // namespace palpate::evaluation
