// Panels: one column a volume; level felt, force and mode against depth.
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

/// Of the ways to press: black, blue, vermilion.
constexpr std::array<const char*, 3> colours{"#000000", "#0072B2", "#D55E00"};

/// What was felt on one way of one stroke.
struct Way {
    std::vector<std::vector<double>> data;   ///< depth, density at the hand
    std::vector<std::vector<double>> level;  ///< depth, level; a gap where there is no contact
    std::vector<std::vector<double>> force;  ///< depth, force
    std::vector<std::vector<double>> mode;   ///< depth, 1 in contact
};

Way way_of(const Table& table, const std::string& volume, const std::string& function,
           const std::string& direction) {
    Way way;
    for (std::size_t i = 0; i < table.rows().size(); ++i) {
        if (table.text(i, "volume") != volume || table.text(i, "penetrability") != function ||
            table.text(i, "way") != direction) {
            continue;
        }
        const bool contact = table.text(i, "mode") == "constrained";
        const double depth = table.number(i, "depth_mm");
        way.data.push_back({depth, table.number(i, "density_at_hand")});
        way.force.push_back({depth, table.number(i, "force_n")});
        way.mode.push_back({depth, contact ? 1.0 : 0.0});
        if (contact) {
            way.level.push_back({depth, table.number(i, "isovalue")});
        } else if (!way.level.empty() && !way.level.back().empty()) {
            way.level.emplace_back();
        }
    }
    return way;
}

/// Stretches of contact as boxes of a strip: from, to, row.
std::vector<std::vector<double>> stretches(const std::vector<std::vector<double>>& rows,
                                           double strip) {
    std::vector<std::vector<double>> boxes;
    double begin = std::nan("");
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const bool contact = rows[i][1] > 0;
        if (contact && std::isnan(begin)) begin = rows[i][0];
        if (!std::isnan(begin) && (!contact || i + 1 == rows.size())) {
            const double end = rows[i][0];
            boxes.push_back({0.5 * (begin + end), strip, std::min(begin, end), std::max(begin, end),
                             strip - 0.36, strip + 0.36});
            begin = std::nan("");
        }
    }
    return boxes;
}

struct Column {
    std::string blocks, level, force, mode;
};

/// Threshold and ranges often agree: then the second lies within the first.
std::string line_style(std::size_t function, bool in) {
    constexpr std::array<double, 3> widths{2.5, 5, 2};
    return fmt::format("lw {} dt {} lc rgb '{}'", in ? widths[function] : 1.5,
                       in ? "solid" : "(8,5)", colours[function]);
}

/// The plots of one volume, with its data blocks.
Column column_of(const Table& table, const std::string& volume, std::size_t number) {
    Column column;
    for (std::size_t f = 0; f < 3; ++f) {
        for (const std::string direction : {"in", "out"}) {
            const bool in = direction == "in";
            const Way way = way_of(table, volume, pressing_functions[f], direction);
            const std::string name = fmt::format("v{}f{}{}", number, f, direction);
            column.blocks += block(name + "l", way.level) + block(name + "f", way.force);
            if (f == 0 && in) {
                column.blocks += block(name + "d", way.data);
                column.level +=
                    fmt::format("${}d with filledcurves y=lowest fc rgb '#e4e4e4', ", name);
            }
            const std::string style = line_style(f, in);
            column.level += fmt::format("${}l with lines {}, ", name, style);
            column.force += fmt::format("${}f with lines {}, ", name, style);
            const auto boxes = stretches(way.mode, 6 - 2 * double(f) - (in ? 0 : 1));
            if (boxes.empty()) continue;
            column.blocks += block(name + "b", boxes);
            column.mode += fmt::format(
                "${}b using 1:2:3:4:5:6 with boxxyerror fs solid {} noborder fc rgb '{}', ", name,
                in ? 0.9 : 0.45, colours[f]);
        }
    }
    return column;
}

struct Place {
    std::size_t column, columns;
};

constexpr int margin = 135, gap = 75;  // [pixels]

/// [pixels]; a single one is wide enough for the key.
int width_of_column(std::size_t columns) {
    return columns == 1 ? 865 : 545;
}

std::string panel(const Place& place, double bottom, double top) {
    const int column = width_of_column(place.columns);
    const double width = margin + column * double(place.columns);
    const double left = margin + column * double(place.column);
    return fmt::format(
        "set lmargin at screen {:.4f}\nset rmargin at screen {:.4f}\n"
        "set bmargin at screen {}\nset tmargin at screen {}\n",
        left / width, (left + column - gap) / width, bottom, top);
}

/// A panel of its own, for a key is never wider than its panel.
std::string key() {
    std::string plots;
    for (std::size_t f = 0; f < 3; ++f) {
        plots += fmt::format("NaN with lines {} title '{}', ", line_style(f, true),
                             pressing_functions[f]);
    }
    return "set lmargin at screen 0\nset rmargin at screen 1\nset bmargin at screen 0.95\n"
           "set tmargin at screen 1\nunset border\nunset tics\nunset grid\nset xrange [0:1]\n"
           "set yrange [0:1]\nset key center center horizontal maxcols 5 width 2\nplot " +
           plots +
           "NaN with lines lw 1.5 dt (8,5) lc rgb '#606060' title 'out again', NaN with "
           "filledcurves fc rgb '#e4e4e4' title 'data at the hand'\nset border\nset tics\n" +
           std::string("set grid lc rgb '#d8d8d8' lw 1\n");
}

/// The three panels of one volume.
std::string panels(const Table& table, const PressingCourse& course, const PressingPlan& plan,
                   const Place& place) {
    const bool first = place.column == 0;
    const auto label = [&](const char* text) {
        return first ? fmt::format("set ylabel '{}' offset 1\n", text)
                     : std::string("unset ylabel\n");
    };
    const Volume& data = course.subject.field.volume();
    const Column column = column_of(table, course.subject.name, place.column);
    const double room = 0.06 * (data.maximum() - data.minimum());
    const double most = plan.stiffness * plan.threshold;
    std::string script = column.blocks;
    script += fmt::format("lowest = {}\nset xrange [{}:{}]\n", data.minimum() - room,
                          -plan.approach * pressing_scale(course), course.depth);
    script += "set format x ''\nunset xlabel\nset ytics auto\n" + panel(place, 0.60, 0.90) +
              label("level felt [data units]") +
              fmt::format("set title {} noenhanced\n", gnuplot_text(course.subject.name)) +
              fmt::format("set yrange [lowest:{}]\n", data.maximum() + room) + "plot " +
              column.level + "NaN\n";
    script += "unset title\n" + panel(place, 0.33, 0.575) + label("k |SCP - HIP| [N]") +
              fmt::format("set yrange [0:{}]\n", 3.2 * most) + "plot " + column.force +
              fmt::format("{} lw 1 dt 3 lc rgb '#606060'\n", most);
    script += panel(place, 0.10, 0.305) + "set format x '%g'\nset yrange [0.4:6.6]\n" +
              "set xlabel 'depth of the hand [mm]'\nunset ylabel\nset ytics (" +
              (first ? "'off, in' 6, 'off, out' 5, 'threshold, in' 4, 'threshold, out' 3, "
                       "'ranges, in' 2, 'ranges, out' 1"
                     : "'' 6, '' 5, '' 4, '' 3, '' 2, '' 1") +
              ")\nplot " + column.mode + "NaN\n";
    return script;
}

}  // namespace

Figure penetration_figure(const Table& table, const std::vector<PressingCourse>& courses,
                          const PressingPlan& plan) {
    const std::size_t columns = std::min(courses.size(), most_columns);
    Figure figure;
    figure.size = {margin + width_of_column(columns) * int(columns), 900};
    figure.caption = fmt::format(
        "What the hand feels on its way straight in (solid) and out again (dashed), against its "
        "depth past the first surface. Above: the level felt, where there is contact; grey: the "
        "data at the hand. Middle: the spring's force, at most {:g} N where the surface gives way; "
        "with penetrability off it leaves the panel. Below: where the proxy is in contact.",
        plan.stiffness * plan.threshold);
    figure.script = "set multiplot\n" + key() + "set key off\n";
    for (std::size_t i = 0; i < columns; ++i) {
        figure.script += panels(table, courses[i], plan, {i, columns});
    }
    figure.script += "unset multiplot\n";
    return figure;
}

namespace {

/// Line, hand, proxy and force, in the size of the picture.
void add_markers(pictures::PictureScene& scene, const PressingCourse& course,
                 const PressingTick& tick) {
    const double before = 0.25 * scene.camera.half_height;
    scene.lines.push_back(
        {{course.entry - before * course.inward, course.entry + course.depth * course.inward},
         pictures::line_radius(scene, 2),
         pictures::spring_colour,
         "line of the hand"});
    const Vec3 pull = (tick.update.scp - tick.update.hip) / pressing_scale(course);
    pictures::Contact contact{tick.update.scp, tick.update.hip, {}};
    if (pull.norm() > 0) contact.force = tick.force / pull.norm() * pull;
    pictures::add_contact(scene, contact);
}

}  // namespace

Picture penetration_picture(const PressingCourse& course, const PressingTick& tick, bool quick,
                            const std::function<void()>& waiting) {
    pictures::PictureScene scene;
    scene.width = quick ? 200 : 1000;
    scene.height = quick ? 160 : 800;
    scene.title = course.subject.name;
    std::vector<double> levels;
    std::string names;
    for (const NamedLevel& level : course.levels) {
        levels.push_back(level.isovalue);
        names +=
            fmt::format("{}{:g} ({})", names.empty() ? "" : " and ", level.isovalue, level.name);
    }
    pictures::add_levels(scene, course.subject.field, levels, [&](double) { waiting(); });
    for (std::size_t i = 0; i < scene.surfaces.size(); ++i) {
        scene.surfaces[i].label = fmt::format("{}, {:g}", course.levels[i].name, levels[i]);
    }
    pictures::frame(scene, course.view.value_or(pictures::natural_view(
                               course.subject.field.geometry(), -course.inward)));
    add_markers(scene, course, tick);
    pictures::DrawOptions draw;
    draw.waiting = waiting;
    return {course.subject.name,
            fmt::format("{}: the surfaces at {}, the line of the hand, and hand and proxy where, "
                        "pressing with ranges, the level {:.4g} is felt, {:.3g} mm deep.",
                        course.subject.name, names, tick.update.isovalue, tick.depth),
            pictures::png_of(scene, draw)};
}

}  // namespace palpate::evaluation
