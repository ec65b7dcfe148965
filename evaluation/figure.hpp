// A figure as a gnuplot script with its data inside, and the look that all figures share: the
// colours of Okabe and Ito, which colour-blind readers can tell apart, and one line style a method.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "io/plot.hpp"

namespace palpate::evaluation {

struct Figure {
    std::string suffix;   ///< empty: the experiment's own figure; else EXPERIMENT-SUFFIX
    std::string caption;  ///< what is seen, in a sentence or two
    std::string script;   ///< gnuplot, after preamble(); data as blocks
    io::PlotSize size;
};

/// Grid, borders, line types 1 to 8 (Okabe and Ito: blue, vermilion, green, purple, orange, sky
/// blue, black, yellow), numbers formatted alike. draw() puts it before the script.
std::string preamble();

/// "$NAME << EOD ... EOD": one row a line, NaN as a gap. Use it as `plot $NAME using 1:2`.
std::string block(std::string_view name, const std::vector<std::vector<double>>& rows);
/// The same with the x of a row and any text, as for labels: quotes are taken care of.
std::string gnuplot_text(std::string_view text);

/// "lt 1 pt 7 ..." of a method, the same in every figure; markers differ as well as colours.
std::string method_style(std::string_view method);

/// Draws it as an SVG or a PNG, by the extension. Throws io::OutputError.
void draw(const Figure& figure, const std::filesystem::path& path);

}  // namespace palpate::evaluation
