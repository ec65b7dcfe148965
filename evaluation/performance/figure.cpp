// One panel a method: the percentiles of every row above one another, the paper's means beside
// them.
#include "evaluation/performance/figure.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace palpate::evaluation {
namespace {

struct Mark {
    const char* column;
    const char* title;
    Look look;
};

constexpr std::array<Mark, 6> marks{
    {{"max_ns", "max", {colours::vermilion, Marker::diamond, 1.2}},
     {"cold_p50_ns", "p50, caches emptied", {colours::sky, Marker::open_circle, 1.1}},
     {"p999_ns", "p99.9", {colours::orange, Marker::triangle_down}},
     {"p99_ns", "p99", {colours::green, Marker::triangle}},
     {"mean_ns", "mean", {colours::black, Marker::cross}},
     {"p50_ns", "p50", {colours::blue, Marker::circle, 0.9}}}};

/// Where on the x axis the rows of a method stand: LR and HR of a volume side by side.
double position(std::size_t row) {
    return 2.6 * static_cast<double>(row / 2) + static_cast<double>(row % 2);
}

/// Microseconds of a column, each at its row's position.
Rows microseconds(const Table& table, const std::string& column, double scale) {
    Rows rows;
    for (const double value : table.numbers(column)) {
        rows.push_back({position(rows.size()), scale * value});
    }
    return rows;
}

Panel panel_of(const Table& table, const char* title) {
    Panel panel;
    panel.title = title;
    panel.y = {
        .title = "time of an update [µs]", .is_logarithmic = true, .low = 0.02, .high = 3000};
    const std::size_t rows = table.rows().size();
    panel.x.low = -0.8;
    panel.x.high = position(rows - 1) + 0.8;
    for (std::size_t i = 0; i < rows; ++i) {
        panel.x.ticks.push_back({position(i), table.text(i, "resolution")});
        if (i % 2 > 0) continue;
        panel.x.ticks.push_back({position(i) + 0.5, "\n" + table.text(i, "volume")});
    }
    panel.series.push_back(
        level_line(1000, "a tick at 1 kHz", {.colour = colours::dark_grey, .dash = Dash::dashed}));
    const Rows paper = microseconds(table, "paper_mean_us", 1);
    if (std::any_of(paper.begin(), paper.end(), [](const auto& r) { return !std::isnan(r[1]); })) {
        panel.series.push_back({Draw::points,
                                "mean of the haptic loop in the paper",
                                {colours::purple, Marker::star, 1.3},
                                paper});
    }
    Series spans{Draw::segments, "", {.colour = colours::light_grey}, {}};
    for (std::size_t i = 0; i < rows; ++i) {
        spans.rows.push_back({position(i), table.number(i, "p50_ns") / 1000, position(i),
                              table.number(i, "max_ns") / 1000});
    }
    panel.series.push_back(spans);
    for (const Mark& mark : marks) {
        if (std::isnan(table.number(0, mark.column))) continue;
        panel.series.push_back(
            {Draw::points, mark.title, mark.look, microseconds(table, mark.column, 1e-3)});
    }
    return panel;
}

}  // namespace

Figure performance_figure(const Table& table) {
    Figure figure;
    figure.caption =
        "Time of a proxy update while a hand explores and touches as fast and as often as in each "
        "row of the paper's Table 1, at 1 kHz and 0.5 (LR) and 3 (HR) voxels per millimetre of "
        "hand: the exact method above, the paper's method in this implementation below. Stars: "
        "the means that the paper gives for its haptic loop, on its machine. Circles: the median "
        "when all caches were emptied before the update.";
    figure.height = 900;
    figure.panels = {panel_of(table.where("method", "exact"), "exact"),
                     panel_of(table.where("method", "paper"), "the paper's method")};
    return figure;
}

}  // namespace palpate::evaluation
