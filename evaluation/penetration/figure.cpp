// One column a volume: level felt, force and mode against depth. And the picture of the contact.
#include "evaluation/penetration/figure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "pictures/contact.hpp"
#include "pictures/levels.hpp"
#include "pictures/picture.hpp"

namespace palpate::evaluation {
namespace {

constexpr std::size_t most_columns = 3;

/// Of off, threshold and ranges; the second colour is for going out, in the strips.
struct Colours {
    const char *in, *out;
};
constexpr std::array<Colours, 3> strip_colours{
    {{colours::black, "#9a9a9a"}, {colours::blue, "#8cc0dd"}, {colours::vermilion, "#f0b98f"}}};

/// Threshold and ranges often agree: then the thin line lies within the wide one.
Look look_of_press(std::size_t function, bool is_inward) {
    constexpr std::array<double, 3> widths{2.5, 5, 2};
    return {.colour = strip_colours[function].in,
            .width = is_inward ? widths[function] : 1.5,
            .dash = is_inward ? Dash::solid : Dash::dashed};
}

/// Depth and level in contact, with gaps.
Rows levels_in(const Table& table) {
    Rows rows;
    for (std::size_t i = 0; i < table.rows().size(); ++i) {
        if (table.text(i, "mode") == "constrained") {
            rows.push_back({table.number(i, "depth_mm"), table.number(i, "isovalue")});
        } else if (!rows.empty() && !rows.back().empty()) {
            rows.emplace_back();
        }
    }
    return rows;
}

/// Stretches of contact as boxes in the strip at this height.
Rows contacts_in(const Table& table, double strip) {
    Rows boxes;
    double begin = std::nan("");
    for (std::size_t i = 0; i < table.rows().size(); ++i) {
        const bool touches = table.text(i, "mode") == "constrained";
        const double depth = table.number(i, "depth_mm");
        if (touches && std::isnan(begin)) begin = depth;
        if (std::isnan(begin) || (touches && i + 1 < table.rows().size())) continue;
        boxes.push_back(
            {std::min(begin, depth), std::max(begin, depth), strip - 0.36, strip + 0.36});
        begin = std::nan("");
    }
    return boxes;
}

/// Level, force and mode of one volume.
struct Column {
    Panel level, force, mode;
};

void add_press(Column& column, const Table& press, std::size_t function, bool is_inward) {
    const Look look = look_of_press(function, is_inward);
    const std::string title = is_inward ? pressing_functions[function] : "";
    column.level.add(Draw::line, title, look, levels_in(press));
    column.force.add(Draw::line, title, look, press.rows_of({"depth_mm", "force_n"}));
    const Colours& strip = strip_colours[function];
    column.mode.add(Draw::boxes, "", {.colour = is_inward ? strip.in : strip.out},
                    contacts_in(press, 6 - 2 * double(function) - !is_inward));
}

Column column_of(const Table& table, const PressingLine& line, const PressingPlan& plan) {
    const Volume& data = line.subject.field.volume();
    const double room = 0.06 * (data.maximum() - data.minimum());
    const double most = plan.stiffness * plan.threshold;
    Axis depth{.low = -plan.approach * pressing_scale(line), .high = line.depth};
    Column column;
    column.mode.x = depth;
    column.mode.x.title = "depth of the hand [mm]";
    depth.has_labels = false;
    column.level.x = column.force.x = depth;
    column.level.title = line.subject.name;
    column.level.y = {.low = data.minimum() - room, .high = data.maximum() + room};
    column.force.y = {.low = 0, .high = 3.2 * most};
    column.mode.y = {.low = 0.4, .high = 6.6};
    const char* const names[] = {"ranges, out",   "ranges, in", "threshold, out",
                                 "threshold, in", "off, out",   "off, in"};
    for (const char* const name : names) {
        column.mode.y.ticks.push_back({double(column.mode.y.ticks.size()) + 1, name});
    }
    column.level.height = 0.30;
    column.force.height = 0.25;
    column.mode.height = 0.2;
    for (std::size_t f = 0; f < 3; ++f) {
        const Table press = table.where("penetrability", pressing_functions[f]);
        const Table in = press.where("direction", "in"), out = press.where("direction", "out");
        if (f == 0) {
            column.level.add(Draw::area, "data at the hand", {"#e4e4e4"},
                             in.rows_of({"depth_mm", "density_at_hand"}));
        }
        add_press(column, in, f, true);
        add_press(column, out, f, false);
    }
    // For the key alone: every dashed line is for going out.
    column.level.add(Draw::line, "out again",
                     {.colour = colours::grey, .width = 1.5, .dash = Dash::dashed}, {});
    column.force.add_level(most, "", {.colour = colours::grey, .width = 1, .dash = Dash::dotted});
    return column;
}

}  // namespace

Figure penetration_figure(const Table& table, const std::vector<PressingLine>& lines,
                          const PressingPlan& plan) {
    Figure figure;
    figure.columns = std::min(lines.size(), most_columns);
    figure.width = figure.columns == 1 ? 1000 : 140 + 545 * int(figure.columns);
    figure.height = 900;
    figure.caption = fmt::format(
        "What the hand feels going straight in (solid) and out again (dashed), against its "
        "depth past the first surface. Above: the level felt, where there is contact; grey: the "
        "data at the hand. Middle: the spring's force, at most {:g} N where the surface gives way; "
        "with penetrability off it leaves the panel. Below: where the proxy is in contact.",
        plan.stiffness * plan.threshold);
    figure.panels.resize(3 * figure.columns);
    for (std::size_t i = 0; i < figure.columns; ++i) {
        Column column = column_of(table.where("volume", lines[i].subject.name), lines[i], plan);
        if (i == 0) {
            column.level.y.title = "level felt [data units]";
            column.force.y.title = "k |SCP - HIP| [N]";
        }
        column.mode.y.has_labels = i == 0;
        figure.panels[i] = std::move(column.level);
        figure.panels[figure.columns + i] = std::move(column.force);
        figure.panels[2 * figure.columns + i] = std::move(column.mode);
    }
    return figure;
}

namespace {

/// Line, hand, proxy and force, in the size of the picture.
void add_markers(pictures::PictureScene& scene, const PressingLine& line,
                 const PressingTick& tick) {
    const double before = 0.25 * scene.camera.half_height;
    scene.lines.push_back(
        {{line.entry - before * line.inward, line.entry + line.depth * line.inward},
         pictures::line_radius(scene, 2),
         pictures::spring_colour,
         "line of the hand"});
    const Vec3 pull = (tick.update.scp - tick.update.hip) / pressing_scale(line);
    pictures::Contact contact{tick.update.scp, tick.update.hip, {}};
    if (pull.norm() > 0) contact.force = tick.force / pull.norm() * pull;
    pictures::add_contact(scene, contact);
}

}  // namespace

Picture penetration_picture(const PressingLine& line, const PressingTick& tick, bool quick,
                            const std::function<void()>& waiting) {
    pictures::PictureScene scene;
    scene.width = quick ? 200 : 1000;
    scene.height = quick ? 160 : 800;
    scene.title = line.subject.name;
    std::vector<double> levels;
    std::string names;
    for (const NamedLevel& level : line.levels) {
        levels.push_back(level.isovalue);
        names +=
            fmt::format("{}{:g} ({})", names.empty() ? "" : " and ", level.isovalue, level.name);
    }
    pictures::add_levels(scene, line.subject.field, levels, [&](double) { waiting(); });
    for (std::size_t i = 0; i < scene.surfaces.size(); ++i) {
        scene.surfaces[i].label = fmt::format("{}, {:g}", line.levels[i].name, levels[i]);
    }
    pictures::frame(scene, line.view.value_or(pictures::natural_view(line.subject.field.geometry(),
                                                                     -line.inward)));
    add_markers(scene, line, tick);
    pictures::DrawOptions draw;
    draw.waiting = waiting;
    return {line.subject.name,
            fmt::format("{}: the surfaces at {}, the line of the hand, and hand and proxy where, "
                        "pressing with ranges, the level {:.4g} is felt, {:.3g} mm deep.",
                        line.subject.name, names, tick.update.isovalue, tick.depth),
            pictures::png_of(scene, draw)};
}

}  // namespace palpate::evaluation
