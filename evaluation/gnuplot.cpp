// Draws figures with gnuplot: lays the panels out in pixels, and writes each as a script.
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "evaluation/contestants.hpp"
#include "evaluation/figure.hpp"
#include "io/recording/plot.hpp"
#include "palpate/io/error.hpp"

namespace palpate::evaluation {
namespace {

constexpr const char* preamble =
    "set encoding utf8\nset border lc rgb '#404040'\nset tics textcolor rgb '#202020'\n"
    "set style textbox opaque noborder margins 0.6,0.6\n"
    "set palette defined (0 '#ffffff', 0.35 '#9ecae1', 0.7 '#3182bd', 1 '#08306b')\n"
    "set multiplot\n";

/// A quoted string. Single quotes, for in double ones gnuplot would run what is in backquotes.
std::string in_quotes(std::string_view text) {
    std::string out = "'";
    for (const char c : text) {
        out += c == '\'' ? "''" : c == '\n' ? "'.\"\\n\".'" : std::string(1, c);
    }
    return out + "'";
}

std::string number(double value) {
    return std::isfinite(value) ? fmt::format("{}", value) : "NaN";
}

// Layout, in pixels from the top left corner.

constexpr double character = 7.6, line_height = 18;

struct Size {
    double width = 0, height = 0;
};

Size size_of(const std::vector<AxisTick>& ticks) {
    double characters = 0, lines = 1;
    for (const AxisTick& tick : ticks) {
        double length = 0, height = 1;
        for (const char c : tick.text) {
            height += c == '\n';
            length = c == '\n' ? 0 : length + ((c & 0xC0) != 0x80);  // not within a UTF-8 character
            characters = std::max(characters, length);
        }
        lines = std::max(lines, height);
    }
    return {character * characters, line_height * lines};
}

/// Room that an axis at the side takes, and one at the bottom. Numbers that gnuplot chooses are as
/// long as 0.0001.
double side_room(const Axis& axis) {
    const double labels = axis.ticks.empty() ? 66 : size_of(axis.ticks).width + 22;
    return (axis.has_labels ? labels : 12) + (axis.title.empty() ? 0 : 32);
}
double bottom_room(const Axis& axis) {
    const Size size = size_of(axis.ticks);
    const double turned = std::sin(axis.turned * 3.14159 / 180);
    const double labels = axis.turned > 0 ? turned * size.width + 26 : size.height + 14;
    return (axis.has_labels ? labels : 12) + (axis.title.empty() ? 0 : 36);
}

struct Box {
    double left = 0, right = 0, top = 0, bottom = 0;
};

constexpr double scale_room = 125;

/// Series with a title, each title once.
std::vector<const Series*> key_entries(const Figure& figure) {
    std::vector<const Series*> found;
    for (const Panel& panel : figure.panels) {
        for (const Series& series : panel.series) {
            const bool is_known = std::any_of(found.begin(), found.end(), [&](const Series* other) {
                return other->title == series.title;
            });
            if (!series.title.empty() && !is_known) found.push_back(&series);
        }
    }
    return found;
}

bool has_scale(const Figure& figure) {
    return std::any_of(figure.panels.begin(), figure.panels.end(),
                       [](const Panel& panel) { return panel.scale.has_value(); });
}

/// As many entries a line as fit.
std::size_t key_columns(const Figure& figure) {
    double longest = 1;
    for (const Series* series : key_entries(figure)) {
        longest = std::max(longest, size_of({{0, series->title}}).width);
    }
    return static_cast<std::size_t>(std::max(1.0, 0.95 * figure.width / (longest + 90)));
}

double key_height(const Figure& figure) {
    const std::size_t entries = key_entries(figure).size(), columns = key_columns(figure);
    return entries > 0 ? 22.0 * double((entries + columns - 1) / columns) + 14 : 0;
}

/// The inner box of every panel: each column and row gets the room that its axes need, and what is
/// left is shared.
std::vector<Box> layout(const Figure& figure) {
    const std::size_t columns = figure.columns,
                      rows = (figure.panels.size() + columns - 1) / columns;
    std::vector<Box> rooms(columns + rows);  // left and right of columns; top and bottom of rows
    for (std::size_t i = 0; i < figure.panels.size(); ++i) {
        const Panel& panel = figure.panels[i];
        Box &column = rooms[i % columns], &row = rooms[columns + i / columns];
        column.left = std::max(column.left, side_room(panel.y));
        column.right = std::max(column.right, panel.right ? side_room(*panel.right) : 18);
        row.top = std::max(row.top, panel.title.empty() ? 14.0 : 44.0);
        row.bottom = std::max(row.bottom, bottom_room(panel.x));
    }
    if (has_scale(figure)) rooms[columns - 1].right += scale_room;
    double width = figure.width, height = figure.height - key_height(figure), heights = 0;
    for (const Box& room : rooms) {
        width -= room.left + room.right;
        height -= room.top + room.bottom;
    }
    for (std::size_t r = 0; r < rows; ++r) heights += figure.panels[r * columns].height;
    std::vector<Box> boxes;
    double top = 0;
    for (std::size_t r = 0; r < rows; ++r) {
        const Box& row = rooms[columns + r];
        const double bottom = top + row.top + figure.panels[r * columns].height / heights * height;
        double left = 0;
        for (std::size_t c = 0; c < columns; ++c) {
            left += rooms[c].left;
            boxes.push_back({left, left + width / double(columns), top + row.top, bottom});
            left += width / double(columns) + rooms[c].right;
        }
        top = bottom + row.bottom;
    }
    return boxes;
}

std::string margins(const Figure& figure, const Box& box) {
    return fmt::format(
        "set lmargin at screen {:.5f}\nset rmargin at screen {:.5f}\n"
        "set tmargin at screen {:.5f}\nset bmargin at screen {:.5f}\n",
        box.left / figure.width, box.right / figure.width, 1 - box.top / figure.height,
        1 - box.bottom / figure.height);
}

// One panel.

/// `name`: x, y or y2.
std::string script_of(const Axis& axis, const std::string& name) {
    std::string ticks = "autofreq enhanced";
    if (!axis.ticks.empty()) {
        ticks.clear();
        for (const AxisTick& tick : axis.ticks) {
            ticks += (ticks.empty() ? "(" : ", ") +
                     (axis.has_labels ? in_quotes(tick.text) : "''") + " " + number(tick.at);
        }
        ticks += ") noenhanced";
    }
    const auto end = [](double at) { return std::isnan(at) ? std::string("*") : number(at); };
    return fmt::format(
        "{0} logscale {1}\nset {1}label {2} noenhanced\nset {1}range [{3}:{4}]\n"
        "set format {1} {5}\nset {1}tics {6} {7}\n",
        axis.is_logarithmic ? "set" : "unset", name, in_quotes(axis.title), end(axis.low),
        end(axis.high), in_quotes(axis.has_labels ? axis.format : ""), ticks,
        axis.turned > 0 ? fmt::format("rotate by {} right", axis.turned) : "norotate");
}

std::string style_of(const Look& look) {
    return fmt::format("lc rgb {} lw {} dt {} pt {} ps {}", in_quotes(look.colour), look.width,
                       std::array{"1", "(14,8)", "(3,6)", "(12,5,3,5)"}[std::size_t(look.dash)],
                       int(look.marker), look.size);
}

std::string filled(const Look& look) {
    return "fs solid 1 noborder fc rgb " + in_quotes(look.colour);
}

/// How gnuplot draws the data block `data`.
std::string plot_of(const Series& series, const std::string& data, const Axis& y) {
    const std::string style = style_of(series.look);
    const std::string axes = series.on_right_axis ? " axes x1y2 " : " ";
    switch (series.draw) {
        case Draw::line:
            return data + axes + "with lines " + style;
        case Draw::points:
            return data + axes + "with points " + style;
        case Draw::line_points:
            return data + axes + "with linespoints " + style;
        case Draw::level:
            return number(series.rows.at(0).at(0)) + axes + "with lines " + style;
        case Draw::area:
            return data + " with filledcurves y=" + number(y.low) + " " + filled(series.look);
            return data + " with filledcurves closed " + filled(series.look);
        case Draw::boxes:
            return data + " using (($1+$2)/2):(($3+$4)/2):1:2:3:4 with boxxyerror " +
                   filled(series.look);
        case Draw::segments:
            return data + " using 1:2:($3-$1):($4-$2) with vectors nohead " + style;
        case Draw::cells:
            return data + " using 1:2:3 with image";
        case Draw::text:
            break;
    }
    return "NaN";
}

std::string labels_of(const Series& series) {
    const TextLook& text = series.text;
    std::string script;
    for (std::size_t i = 0; i < series.rows.size(); ++i) {
        script += fmt::format(
            "set label {} at {}, {} {} offset {},{} front font ',{}' tc rgb {} noenhanced\n",
            in_quotes(series.labels.at(i)), number(series.rows[i].at(0)),
            number(series.rows[i].at(1)),
            std::array{"left", "center", "right"}[std::size_t(text.align)], text.right, text.up,
            text.size, in_quotes(series.look.colour));
    }
    return script;
}

/// "$NAME << EOD ... EOD"; a row without finite numbers is a gap.
std::string block(const std::string& name, const Rows& rows) {
    std::string text = name + " << EOD\n";
    for (const auto& row : rows) {
        for (const double value : row) text += number(value) + " ";
        text += '\n';
    }
    return text + "EOD\n";
}

std::string script_of(const Panel& panel, const std::string& name) {
    std::string blocks, plots;
    std::string script =
        "set title " + in_quotes(panel.title) +
        " noenhanced\nunset label\nunset key\nset border\n" + script_of(panel.x, "x") +
        script_of(panel.y, "y") +
        (panel.right ? "set ytics nomirror\n" + script_of(*panel.right, "y2")
                     : "set ytics mirror\nunset y2tics\nset y2label ''\n") +
        (panel.has_grid ? "set grid lc rgb '#d8d8d8' lw 1 lt 1\n" : "unset grid\n");
    if (panel.scale) {
        script += fmt::format("{} logscale cb\nset cbrange [{}:{}]\nset cblabel {} noenhanced\n",
                              panel.scale->is_logarithmic ? "set" : "unset", panel.scale->low,
                              panel.scale->high, in_quotes(panel.scale->title));
    }
    for (const Series& series : panel.series) {
        if (series.rows.empty()) continue;
        const std::string data = fmt::format("${}s{}", name, &series - panel.series.data());
        if (series.draw == Draw::text) {
            script += labels_of(series);
            continue;
        }
        if (series.draw != Draw::level) blocks += block(data, series.rows);
        plots += plot_of(series, data, panel.y) + " notitle, ";
    }
    return blocks + script + "plot " + plots + "NaN notitle\n";
}

std::string key_entry(const Series& series) {
    const Draw draw = series.draw;
    std::string style = "points " + style_of(series.look);
    if (draw == Draw::line || draw == Draw::level || draw == Draw::segments) {
        style = "lines " + style_of(series.look);
    } else if (draw == Draw::line_points) {
        style = "linespoints " + style_of(series.look);
    } else if (draw == Draw::area || draw == Draw::boxes) {
        style = "boxes " + filled(series.look);
    }
    return "keyentry with " + style + " title " + in_quotes(series.title);
}

/// In an empty panel of its own, for gnuplot makes no key wider than its panel.
std::string key_script(const Figure& figure) {
    const double width = figure.width, height = figure.height;
    std::string script =
        margins(figure, {0, width, height - key_height(figure), height}) +
        "unset border\nunset tics\nunset y2tics\nunset grid\nunset label\nunset logscale\n"
        "set title ''\nset xlabel ''\nset ylabel ''\nset y2label ''\nset xrange [0:1]\n"
        "set yrange [0:1]\nset size noratio\nset key noenhanced center center horizontal Left "
        "reverse maxcols " +
        std::to_string(key_columns(figure)) + " width 2 samplen 3\nplot -1 notitle";
    for (const Series* series : key_entries(figure)) script += ", " + key_entry(*series);
    return script + "\n";
}

std::string script_of(const Figure& figure) {
    std::string script = preamble;
    const std::vector<Box> boxes = layout(figure);
    for (std::size_t i = 0; i < figure.panels.size(); ++i) {
        // One scale of colours serves all panels.
        script += has_scale(figure) && i == 0
                      ? fmt::format(
                            "set colorbox user origin screen {:.5f}, screen 0.3 size "
                            "screen {:.5f}, screen 0.45\n",
                            1 - (scale_room - 10) / figure.width, 18.0 / figure.width)
                      : std::string("unset colorbox\n");
        script += margins(figure, boxes[i]) + script_of(figure.panels[i], fmt::format("p{}", i));
    }
    if (key_height(figure) > 0) script += key_script(figure);
    return script + "unset multiplot\n";
}

}  // namespace

std::vector<AxisTick> ticks_at(const std::vector<double>& values) {
    std::vector<AxisTick> ticks;
    for (const double value : values) ticks.push_back({value, fmt::format("{:g}", value)});
    return ticks;
}

Axis axis_named(const std::vector<std::string>& names) {
    Axis axis{.low = -0.5, .high = double(names.size()) - 0.5};
    for (const std::string& name : names) axis.ticks.push_back({double(axis.ticks.size()), name});
    return axis;
}

Look look_of(std::size_t number) {
    static const std::array<Look, 8> looks{{{colours::blue, Marker::circle},
                                            {colours::vermilion, Marker::square},
                                            {colours::green, Marker::triangle},
                                            {colours::purple, Marker::diamond},
                                            {colours::orange, Marker::triangle_down},
                                            {colours::sky, Marker::open_circle},
                                            {colours::black, Marker::open_square},
                                            {colours::yellow, Marker::open_triangle}}};
    return looks[number % looks.size()];
}

Look look_of_method(std::string_view method) {
    const auto all = contestants();
    const auto found = std::ranges::find(all, method, &Contestant::name);
    return look_of(static_cast<std::size_t>(found - all.begin()));
}

Series& Panel::add(Draw draw, std::string name, const Look& look, Rows rows) {
    return series.emplace_back(Series{draw, std::move(name), look, std::move(rows)});
}

Series& Panel::add_level(double at, std::string name, const Look& look) {
    return add(Draw::level, std::move(name), look, {{at}});
}

void draw(const Figure& figure, const std::filesystem::path& path) {
    const std::string problem = io::plot(script_of(figure), path, {figure.width, figure.height});
    if (problem.empty()) return;
    throw io::OutputError(path.string() + ": could not be drawn (" + problem +
                          "): is gnuplot installed, and is there room on the disk?");
}

}  // namespace palpate::evaluation
