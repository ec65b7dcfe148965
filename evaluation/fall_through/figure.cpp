// Maps with their numbers in them: white is none, dark blue is all.
#include "evaluation/fall_through/figure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "palpate/baselines/methods.hpp"

namespace palpate::evaluation {
namespace {

/// What the axes of all panels are: the values met, in order.
struct Axes {
    std::vector<double> ways;        // [mm] in a tick, rising
    std::vector<std::string> walls;  // from the first row of the table on
    bool thickness;                  // of own walls, instead of names of volumes

    explicit Axes(const Table& table) : thickness(!std::isnan(table.number(0, "thickness_voxel"))) {
        for (std::size_t i = 0; i < table.rows().size(); ++i) {
            ways.push_back(table.number(i, "way_per_tick_mm"));
            const std::string wall = wall_of(table, i);
            if (std::find(walls.begin(), walls.end(), wall) == walls.end()) walls.push_back(wall);
        }
        std::sort(ways.begin(), ways.end());
        ways.erase(std::unique(ways.begin(), ways.end(), same_way), ways.end());
    }

    static bool same_way(double a, double b) { return std::abs(a - b) < 1e-9 * (a + b); }
    static std::string wall_of(const Table& table, std::size_t row) {
        const double thickness = table.number(row, "thickness_voxel");
        return std::isnan(thickness) ? table.text(row, "wall") : fmt::format("{:g}", thickness);
    }
};

/// The mean of a column over the rows of a cell of the map [%]; NaN where there is none.
double percent(const Table& table, const std::string& method, const std::string& wall, double way,
               const char* column) {
    double sum = 0, rows = 0;
    for (std::size_t i = 0; i < table.rows().size(); ++i) {
        if (table.text(i, "method") != method || Axes::wall_of(table, i) != wall ||
            !Axes::same_way(table.number(i, "way_per_tick_mm"), way)) {
            continue;
        }
        sum += table.number(i, column);
        rows += 1;
    }
    return rows > 0 ? 100 * sum / rows : std::nan("");
}

std::string panel(const Table& table, const Axes& axes, const std::string& method,
                  const char* column, const std::string& name) {
    // Number on white or on dark: two blocks.
    std::vector<std::vector<double>> cells, on_light, on_dark;
    for (std::size_t w = 0; w < axes.walls.size(); ++w) {
        for (std::size_t x = 0; x < axes.ways.size(); ++x) {
            const double share = percent(table, method, axes.walls[w], axes.ways[x], column);
            cells.push_back({double(x), double(w), share});
            if (std::isnan(share)) continue;
            (share > 50 ? on_dark : on_light).push_back(cells.back());
        }
    }
    const std::vector<double> none{std::nan(""), std::nan(""), std::nan("")};
    if (on_light.empty()) on_light.push_back(none);
    if (on_dark.empty()) on_dark.push_back(none);
    const auto labels = [](const std::string& data, const char* colour) {
        // A share that is not 0 must not look like it.
        return fmt::format(
            "${} using 1:2:($3 == 0 ? '0' : $3 < 1 ? '<1' : $3 > 99 && $3 < 100 ? '99' : "
            "sprintf('%.0f', $3)) with labels tc rgb '{}' font ',9' notitle",
            data, colour);
    };
    return block("c" + name, cells) + block("l" + name, on_light) + block("d" + name, on_dark) +
           fmt::format(
               "set title '{}' noenhanced\nplot $c{} using 1:2:3 with image notitle, {}, "
               "{}\n",
               method, name, labels("l" + name, "#202020"), labels("d" + name, "#ffffff"));
}

std::string tics(const Axes& axes) {
    std::string x, y;
    for (std::size_t i = 0; i < axes.ways.size(); ++i) {
        x += fmt::format("{}'{:g}' {}", i ? ", " : "", axes.ways[i], i);
    }
    for (std::size_t i = 0; i < axes.walls.size(); ++i) {
        y += fmt::format("{}{} {}", i ? ", " : "", gnuplot_text(axes.walls[i]), i);
    }
    return fmt::format(
        "set xtics ({}) rotate by 90 right font ',9' scale 0\nset ytics ({}) noenhanced scale 0\n"
        "set xrange [-0.5:{}]\nset yrange [{}:-0.5]\n",
        x, y, double(axes.ways.size()) - 0.5, double(axes.walls.size()) - 0.5);
}

Figure map(const Table& table, const char* column, const std::string& suffix,
           const std::string& what, const std::string& caption) {
    const Axes axes(table);
    Figure figure;
    figure.suffix = suffix;
    figure.caption = caption;
    figure.size = {1500, 330 + 2 * std::max(200, 42 * static_cast<int>(axes.walls.size()))};
    const double height = figure.size.height;
    std::size_t longest = 0;
    for (const std::string& wall : axes.walls) longest = std::max(longest, wall.size());
    // Room for the longest name on the axis.
    const double left = std::min(0.2, 0.03 + 0.0056 * double(std::max<std::size_t>(4, longest)));
    const std::string wall_axis = axes.thickness ? "'thickness of the wall [voxel]'" : "'volume'";
    figure.script = fmt::format(
        "unset grid\nset palette defined (0 '#ffffff', 50 '#6baed6', 100 '#08306b')\n"
        "set cbrange [0:100]\nset cblabel '{} [% of crossings]'\nset cbtics 25\n{}"
        "set xlabel 'way of the hand in a tick [mm]{}'\n"
        "set multiplot layout 2,2 margins screen {}, screen 0.92, screen {}, screen {} "
        "spacing screen {}, screen {}\n",
        what, tics(axes), axes.thickness ? ", voxels of 1 mm" : "", left, 115 / height,
        1 - 40 / height, left, 165 / height);
    for (const auto& method : baselines::methods()) {
        const auto number = &method - baselines::methods().data();
        if (number % 2 == 1) figure.script += "set ylabel ''\n";
        if (number % 2 == 0) figure.script += "set ylabel " + wall_axis + "\n";
        // One bar of colours serves all panels.
        figure.script += number == 0 ? "set colorbox user origin 0.935,0.3 size 0.015,0.4\n"
                                     : "unset colorbox\n";
        figure.script += panel(table, axes, method.name, column, std::to_string(number));
    }
    figure.script += "unset multiplot\n";
    return figure;
}

}  // namespace

std::vector<Figure> fall_through_figures(const Table& table) {
    return {map(table, "inside_share", "", "ends inside",
                "Share of the crossings after which the proxy is inside, in percent. Columns: the "
                "hand's way in a tick, which is speed over rate."),
            map(table, "inside_while_pressed_share", "pressed", "inside while pressed",
                "Share of the crossings in which the proxy is inside before the hand has left the "
                "solid, in percent of those in which the hand is in the solid in any tick."),
            map(table, "unfelt_share", "unfelt", "feels nothing",
                "Share of the crossings in which the proxy is in contact in no tick, in percent: "
                "the wall is not felt at all.")};
}

}  // namespace palpate::evaluation
