// Force over depth, with the layers' names where their surfaces are.
#include "evaluation/layers/figure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

#include "evaluation/layers/insertion.hpp"
#include "evaluation/layers/needle.hpp"

namespace palpate::evaluation {
namespace {

constexpr double shallowest = 5;         // [mm] where insertions begin
constexpr std::size_t most_columns = 3;  // of heads
constexpr std::string_view through = "through ";

/// Every other layer in grey, and its name above.
void add_layers(Panel& panel, const Layers& layers, double deepest) {
    Rows bands, names;
    std::vector<std::string> texts;
    for (std::size_t i = 0; i < layers.layers.size(); ++i) {
        const double begin = layers.layers[i].level;
        const double end =
            i + 1 < layers.layers.size() ? layers.layers[i + 1].level : std::max(begin, deepest);
        if (i % 2 == 0) bands.push_back({begin, end, panel.y.low, panel.y.high});
        names.push_back({0.5 * (begin + end), panel.y.high});
        texts.push_back(layers.layers[i].name);
    }
    panel.add(Draw::boxes, "", {"#efefef"}, std::move(bands));
    Series& text = panel.add(Draw::text, "", {colours::dark_grey}, std::move(names));
    text.labels = std::move(texts);
    text.text = {.size = 11, .up = -0.8};
}

const Look closed_form_look{.colour = "#c0c0c0", .width = 6};

}  // namespace

Figure insertion_figure(const Table& table) {
    Figure figure;
    figure.columns = 1;
    figure.height = 760;
    figure.caption =
        "Force on a hand that goes straight in, on the linear field: the closed form (grey, wide) "
        "and what is rendered, at 5 mm/s (line) and at 1 m/s, where a tick is a millimetre (each "
        "circle a tick). Bands are the layers.";
    const Table curves = table.where("part", "insertion curve").where("field", "linear");
    for (const std::string& body : curves.distinct("body")) {
        const Table of_body = curves.where("body", body);
        const Table slow = of_body.where("speed_mm_s", insertion_speeds[0]);
        Panel panel;
        panel.title = body == "flat" ? "flat layers" : "concentric balls";
        panel.x = {.title = "depth of the hand [mm]", .low = shallowest, .high = phantom_depth};
        panel.y = {.title = "force [N]", .low = 0, .high = 2.6};
        add_layers(panel, five_tissues(), phantom_depth);
        panel.add(Draw::line, "closed form", closed_form_look,
                  slow.rows_of({"depth_mm", "closed_form_n"}));
        panel.add(Draw::line, "5 mm/s", {.colour = colours::blue, .width = 1.5},
                  slow.rows_of({"depth_mm", "force_n"}));
        panel.add(
            Draw::points, "1 m/s, a circle a tick",
            {.colour = colours::vermilion, .marker = Marker::open_circle, .size = 0.9},
            of_body.where("speed_mm_s", insertion_speeds[3]).rows_of({"depth_mm", "force_n"}));
        figure.panels.push_back(std::move(panel));
    }
    if (figure.panels.size() > 1) {
        figure.panels.front().x.has_labels = false;
        figure.panels.front().x.title.clear();
    }
    return figure;
}

Figure puncture_figure(const Table& table) {
    Figure figure;
    figure.suffix = "puncture";
    figure.width = 800;
    figure.height = 480;
    figure.caption =
        "The last force rendered before a surface gave way (balls, linear field, mean of all "
        "insertions), as a part of the surface's puncture force: the faster the hand, the farther "
        "apart its ticks. Dashed: the same forces extended along the spring to where the surface "
        "gave way, all four.";
    const Table punctures =
        table.where("part", "puncture").where("field", "linear").where("body", "balls");
    Panel panel;
    panel.x = {.title = "speed of the hand [mm/s]",
               .is_logarithmic = true,
               .low = 4,
               .high = 1250,
               .ticks = ticks_at({5, 50, 250, 1000})};
    panel.y = {.title = "part of the puncture force [%]", .low = 70, .high = 103};
    Rows extended;
    for (const std::string& layer : punctures.distinct("layer")) {
        Rows sampled;
        for (const auto& row : punctures.where("layer", layer)
                                   .rows_of({"speed_mm_s", "greatest_sampled_mean_n",
                                             "extrapolated_mean_n", "puncture_force_n"})) {
            sampled.push_back({row[0], 100 * row[1] / row[3]});
            extended.push_back({row[0], 100 * row[2] / row[3]});
        }
        extended.emplace_back();
        panel.add(Draw::line_points, layer, look_of(panel.series.size()), std::move(sampled));
    }
    panel.add(Draw::line, "extended",
              {.colour = colours::black, .width = 1.5, .dash = Dash::dashed}, std::move(extended));
    figure.panels.push_back(std::move(panel));
    return figure;
}

Figure needle_figure(const Table& table) {
    Figure figure;
    figure.suffix = "needle";
    figure.caption = fmt::format(
        "Force along a needle that goes in at {:g} mm/s, rests on the bone and is withdrawn; "
        "positive resists going in. Peaks: the tip on a surface until it gives way; slopes "
        "between them: drag of the layers on the shaft. Coming out, friction pulls the other way. "
        "Grey, wide: the closed form.",
        needle_speed);
    const Table curves = table.where("part", "needle curve");
    if (curves.rows().empty()) return figure;
    const Table shown =
        curves.where("body", curves.text(0, "body")).where("field", curves.text(0, "field"));
    Panel panel;
    panel.x = {.title = "depth of the hand [mm]", .low = shallowest, .high = 63};
    panel.y = {.title = "force [N]", .low = -1.8, .high = 3.4};
    add_layers(panel, needle_tissues(), 63);
    panel.add_level(0, "", {.colour = colours::grey, .width = 1});
    const Look looks[] = {{.colour = colours::blue, .width = 2},
                          {.colour = colours::black, .marker = Marker::square, .size = 0.8},
                          {.colour = colours::vermilion, .width = 2}};
    for (const std::string& phase : shown.distinct("phase")) {
        panel.add(Draw::line, "closed form", closed_form_look,
                  shown.where("phase", phase).rows_of({"depth_mm", "closed_form_n"}));
    }
    for (const std::string& phase : shown.distinct("phase")) {
        const bool rests = phase == "rest";
        const Look& look = looks[rests ? 1 : phase == "insertion" ? 0 : 2];
        panel.add(rests ? Draw::points : Draw::line, phase, look,
                  shown.where("phase", phase).rows_of({"depth_mm", "force_n"}));
    }
    figure.panels.push_back(std::move(panel));
    return figure;
}

namespace {

/// Density above, force below.
std::pair<Panel, Panel> head_panels(const Table& table, const LayeredHead& head, bool is_first) {
    const Table of_head = table.where("body", head.name);
    const Table curves = of_head.where("part", "head curve");
    const Volume& data = head.field.volume();
    const double room = 0.06 * (data.maximum() - data.minimum());
    Panel density, force;
    density.title = head.name;
    density.x = {.low = -3, .high = head.depth, .has_labels = false};
    density.y = {.title = is_first ? "density at the hand [data units]" : "",
                 .low = data.minimum() - room,
                 .high = data.maximum() + room};
    Table longest = curves.where("surfaces", head_sets[1]);
    density.add(Draw::area, "data at the hand", {"#dcdcdc"},
                longest.rows_of({"depth_mm", "density_at_hand"}));
    density.add_level(head.skin, "skin's level",
                      {.colour = colours::orange, .width = 1.5, .dash = Dash::dashed});
    density.add_level(head.bone, "bone's level",
                      {.colour = colours::purple, .width = 1.5, .dash = Dash::dashed});
    force.x = {.title = "depth of the hand [mm]", .low = -3, .high = head.depth};
    force.y = {.title = is_first ? "force [N]" : "", .low = 0, .high = 5.2};
    const Look looks[] = {{.colour = colours::vermilion, .width = 4},
                          {.colour = colours::blue, .width = 1.8}};
    for (std::size_t set = 0; set < 2; ++set) {
        force.add(Draw::line, set == 0 ? "skin, bone" : "drilling: bone gives way", looks[set],
                  curves.where("surfaces", head_sets[set]).rows_of({"depth_mm", "force_n"}));
    }
    // What gave way, at its peak.
    const Table events = of_head.where("part", "head event").where("surfaces", head_sets[1]);
    for (std::size_t i = 0; i < events.rows().size(); ++i) {
        const std::string& what = events.text(i, "order");
        if (!what.starts_with(through)) continue;
        // Left of the first peak there is room, right of the others.
        const bool is_leftmost = what == std::string(through) + "skin";
        Series& name = force.add(Draw::text, "", {colours::dark_grey},
                                 {{events.number(i, "depth_mm"), events.number(i, "force_n")}});
        name.labels = {what.substr(through.size())};
        name.text = {.size = 11,
                     .align = is_leftmost ? Align::right : Align::left,
                     .right = is_leftmost ? -0.6 : 0.6,
                     .up = 0.3};
    }
    return {std::move(density), std::move(force)};
}

}  // namespace

Figure head_figure(const Table& table, const std::vector<LayeredHead>& heads) {
    Figure figure;
    figure.suffix = "heads";
    figure.columns = std::min(heads.size(), most_columns);
    figure.width = figure.columns == 1 ? 1000 : 140 + 480 * int(figure.columns);
    figure.height = 760;
    figure.caption =
        "From the skin through the bone in one stroke. Above: the data at the hand and the levels "
        "of the two surfaces. Below: the force; with bone that holds the hand stops at 5 N, with "
        "bone that gives way, as for a drill, it breaks through both sides of the skull.";
    figure.panels.resize(2 * figure.columns);
    for (std::size_t i = 0; i < figure.columns; ++i) {
        auto [density, force] = head_panels(table, heads[i], i == 0);
        figure.panels[i] = std::move(density);
        figure.panels[figure.columns + i] = std::move(force);
    }
    return figure;
}

}  // namespace palpate::evaluation
