// A figure as plain values: panels in a grid, each with axes and series, above a key. gnuplot.cpp
// draws it; nothing else knows gnuplot.
#pragma once

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace palpate::evaluation {

using Rows = std::vector<std::vector<double>>;

/// Okabe and Ito's colours, which colour-blind readers can tell apart, and greys.
namespace colours {
inline constexpr const char *blue = "#0072B2", *vermilion = "#D55E00", *green = "#009E73",
                            *purple = "#CC79A7", *orange = "#E69F00", *sky = "#56B4E9",
                            *black = "#000000", *yellow = "#F0E442";
inline constexpr const char *dark_grey = "#404040", *grey = "#808080", *light_grey = "#b0b0b0";
}  // namespace colours

enum class Marker : std::uint8_t {
    none,
    plus,
    cross,
    star,
    open_square,
    square,
    open_circle,
    circle,
    open_triangle,
    triangle,
    open_triangle_down,
    triangle_down,
    open_diamond,
    diamond,
};

enum class Dash : std::uint8_t { solid, dashed, dotted, dash_dotted };

struct Look {
    const char* colour = colours::blue;
    Marker marker = Marker::none;
    double size = 1;   ///< of the marker, relative
    double width = 2;  ///< of the line [pixels]
    Dash dash = Dash::solid;
};

/// What the columns of a series' rows are, and how they are drawn.
enum class Draw : std::uint8_t {
    line,         ///< x, y; an empty row is a gap
    points,       ///< x, y
    line_points,  ///< x, y
    level,        ///< y of a horizontal line through the whole panel
    area,         ///< x, y; filled down to the low end of the y axis, which has to be given
    boxes,        ///< low x, high x, low y, high y; filled
    segments,     ///< x, y, x, y
    cells,        ///< x, y, value on a regular grid, in the colours of the panel's scale
    text,         ///< x, y of `labels`
};

enum class Align : std::uint8_t { left, centre, right };

struct TextLook {
    int size = 12;  ///< [points]
    Align align = Align::centre;
    double right = 0, up = 0;  ///< offset [characters]
};

struct Series {
    Draw draw = Draw::line_points;
    std::string title = {};  ///< in the key; empty: not there. A key shows each title once
    Look look = {};
    Rows rows = {};                        ///< NaN: not drawn
    std::vector<std::string> labels = {};  ///< of Draw::text, one a row
    TextLook text = {};
    bool on_right_axis = false;
};

struct AxisTick {
    double at = 0;
    std::string text;  ///< may have several lines
};

struct Axis {
    std::string title = {};
    bool is_logarithmic = false;
    double low = std::nan(""), high = std::nan("");  ///< NaN: from the data. low > high: reversed
    std::vector<AxisTick> ticks = {};                ///< empty: chosen by gnuplot
    std::string format = "%g";                       ///< of those that gnuplot chooses
    bool has_labels = true;  ///< false where the panel beside or below has them
    int turned = 0;          ///< [degrees] of tick labels on the x axis: 0 to 90
};

/// Colours of Draw::cells, from white to dark blue.
struct ColourScale {
    std::string title = {};
    double low = 0, high = 1;
    bool is_logarithmic = false;
};

struct Panel {
    std::string title = {};
    Axis x, y;
    std::optional<Axis> right;
    std::vector<Series> series;  ///< later ones on top, text above all
    std::optional<ColourScale> scale;
    bool has_grid = true;
    double height = 1;  ///< of its row, relative to the others

    /// Adds a series on top of the others.
    Series& add(Draw draw, std::string title, const Look& look, Rows rows);
    Series& add_level(double y, std::string title, const Look& look);
};

struct Figure {
    std::string suffix;              ///< empty: the experiment's own figure; else EXPERIMENT-SUFFIX
    std::string caption;             ///< what is seen, in a sentence or two
    int width = 1200, height = 560;  ///< [pixels]
    std::size_t columns = 1;
    std::vector<Panel> panels;  ///< row by row
};

/// Ticks at these values with the values as text.
std::vector<AxisTick> ticks_at(const std::vector<double>& values);
/// An axis with these texts at 0, 1, 2 ..., and half a unit more at both ends.
Axis axis_named(const std::vector<std::string>& names);

/// The `number`-th look of lines with markers, from 0; colours and markers differ.
Look look_of(std::size_t number);
/// Of a method, the same in every figure.
Look look_of_method(std::string_view method);

/// Draws it as an SVG or a PNG, by the extension. Throws io::OutputError.
void draw(const Figure& figure, const std::filesystem::path& path);

}  // namespace palpate::evaluation
