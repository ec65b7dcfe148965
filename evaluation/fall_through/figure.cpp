// Heat maps with their numbers in them: one panel a method, white is 0 %, dark blue is 100 %.
#include "evaluation/fall_through/figure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace palpate::evaluation {
namespace {

/// The axes of all panels.
struct Axes {
    std::vector<double> steps;  // [mm] of the hand in a tick, rising
    std::vector<std::string> step_names;
    std::vector<std::string> names;  // of thicknesses or of the user's volumes
    std::vector<Cell> walls;         // the same, as `column` of the table holds them
    const char* column;
    bool has_thickness;

    explicit Axes(const Table& table)
        : has_thickness(!std::isnan(table.number(0, "thickness_voxel"))) {
        column = has_thickness ? "thickness_voxel" : "wall";
        if (has_thickness) {
            for (const double thickness : table.distinct_numbers(column)) {
                names.push_back(fmt::format("{:g}", thickness));
                walls.emplace_back(thickness);
            }
        } else {
            names = table.distinct(column);
            walls.assign(names.begin(), names.end());
        }
        steps = table.distinct_numbers("step_mm");
        std::sort(steps.begin(), steps.end());
        steps.erase(std::unique(steps.begin(), steps.end(), is_same), steps.end());
        for (const double step : steps) step_names.push_back(fmt::format("{:g}", step));
    }

    static bool is_same(double a, double b) { return std::abs(a - b) < 1e-9 * (a + b); }
};

/// A share that is not 0 must not look like it.
std::string percent_text(double percent) {
    if (percent == 0) return "0";
    if (percent < 1) return "<1";
    return percent > 99 && percent < 100 ? "99" : fmt::format("{:.0f}", percent);
}

Panel panel_of(const Table& table, const Axes& axes, const char* column) {
    Panel panel;
    panel.has_grid = false;
    Series cells{Draw::cells, "", {}, {}};
    Series on_light{Draw::text, "", {"#202020"}, {}}, on_dark{Draw::text, "", {"#ffffff"}, {}};
    on_light.text.size = on_dark.text.size = 9;
    for (std::size_t w = 0; w < axes.names.size(); ++w) {
        const Table wall = table.where(axes.column, axes.walls[w]);
        const Rows shares = wall.rows_of({"step_mm", column});
        for (std::size_t x = 0; x < axes.steps.size(); ++x) {
            double sum = 0, count = 0;  // several speeds and rates have the same step
            for (const auto& share : shares) {
                if (!Axes::is_same(share[0], axes.steps[x])) continue;
                sum += share[1];
                count += 1;
            }
            const double percent = count > 0 ? 100 * sum / count : std::nan("");
            cells.rows.push_back({double(x), double(w), percent});
            if (std::isnan(percent)) continue;
            Series& text = percent > 50 ? on_dark : on_light;
            text.rows.push_back({double(x), double(w)});
            text.labels.push_back(percent_text(percent));
        }
    }
    panel.series = {cells, on_light, on_dark};
    return panel;
}

Figure map(const Table& table, const char* column, const std::string& suffix,
           const std::string& what, const std::string& caption) {
    const Axes axes(table);
    Figure figure;
    figure.suffix = suffix;
    figure.caption = caption;
    figure.width = 1500;
    const std::vector<std::string> methods = table.distinct("method");
    const std::size_t rows = (methods.size() + 1) / 2;
    figure.height =
        330 + static_cast<int>(rows) * std::max(200, 42 * static_cast<int>(axes.names.size()));
    figure.columns = 2;
    for (const std::string& method : methods) {
        Panel panel = panel_of(table.where("method", method), axes, column);
        const bool is_left = figure.panels.size() % 2 == 0;
        const bool is_top = figure.panels.size() + 2 < methods.size();
        panel.title = method;
        panel.scale = ColourScale{what + " [% of crossings]", 0, 100, false};
        panel.x = axis_named(axes.step_names);
        panel.x.turned = 90;
        panel.x.has_labels = !is_top;
        panel.y = axis_named(axes.names);
        std::swap(panel.y.low, panel.y.high);
        panel.y.has_labels = is_left;
        if (is_left)
            panel.y.title = axes.has_thickness ? "thickness of the wall [voxel]" : "volume";
        if (!is_top) {
            panel.x.title = axes.has_thickness ? "step of the hand in a tick [mm], voxels of 1 mm"
                                               : "step of the hand in a tick [mm]";
        }
        figure.panels.push_back(std::move(panel));
    }
    return figure;
}

}  // namespace

std::vector<Figure> fall_through_figures(const Table& table) {
    return {map(table, "inside_share", "", "ends inside",
                "Share of the crossings after which the proxy is inside, in percent. Columns: how "
                "far the hand moves in a tick, which is speed over rate."),
            map(table, "inside_while_pressed_share", "pressed", "inside while pressed",
                "Share of the crossings in which the proxy is inside before the hand has left the "
                "solid, in percent of those in which the hand is in the solid in any tick."),
            map(table, "unfelt_share", "unfelt", "feels nothing",
                "Share of the crossings in which the proxy is in contact in no tick, in percent: "
                "the wall is not felt at all.")};
}

}  // namespace palpate::evaluation
