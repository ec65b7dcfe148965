// The common look, and text that gnuplot reads.
#include "evaluation/figure.hpp"

#include <fmt/format.h>

#include <cmath>

#include "palpate/baselines/methods.hpp"
#include "palpate/io/error.hpp"

namespace palpate::evaluation {

std::string preamble() {
    return "set encoding utf8\n"
           "set linetype 1 lc rgb '#0072B2' lw 2 pt 7 ps 0.8\n"
           "set linetype 2 lc rgb '#D55E00' lw 2 pt 5 ps 0.8\n"
           "set linetype 3 lc rgb '#009E73' lw 2 pt 9 ps 0.9\n"
           "set linetype 4 lc rgb '#CC79A7' lw 2 pt 13 ps 0.9\n"
           "set linetype 5 lc rgb '#E69F00' lw 2 pt 11 ps 0.9\n"
           "set linetype 6 lc rgb '#56B4E9' lw 2 pt 6 ps 0.9\n"
           "set linetype 7 lc rgb '#000000' lw 2 pt 4 ps 0.9\n"
           "set linetype 8 lc rgb '#F0E442' lw 2 pt 8 ps 0.9\n"
           "set grid lc rgb '#d8d8d8' lw 1\n"
           "set border lc rgb '#404040'\n"
           "set tics textcolor rgb '#202020'\n"
           "set datafile missing 'NaN'\n"
           "set key noenhanced\n";
}

std::string block(std::string_view name, const std::vector<std::vector<double>>& rows) {
    std::string text = fmt::format("${} << EOD\n", name);
    for (const auto& row : rows) {
        for (std::size_t i = 0; i < row.size(); ++i) {
            text += i ? " " : "";
            text += std::isfinite(row[i]) ? fmt::format("{}", row[i]) : "NaN";
        }
        text += '\n';  // an empty row parts a block, as gnuplot has it
    }
    return text + "EOD\n";
}

std::string gnuplot_text(std::string_view text) {
    std::string out = "'";
    for (const char c : text) out += c == '\'' ? "''" : std::string(1, c == '\n' ? ' ' : c);
    return out + "'";
}

std::string method_style(std::string_view method) {
    int number = 1;
    for (const auto& entry : baselines::methods()) {
        if (method == entry.name) break;
        ++number;
    }
    return fmt::format("lt {}", number);
}

void draw(const Figure& figure, const std::filesystem::path& path) {
    const std::string problem = io::plot(preamble() + figure.script, path, figure.size);
    if (problem.empty()) return;
    throw io::OutputError(path.string() + ": could not be drawn (" + problem +
                          "): is gnuplot installed, and is there room on the disk?");
}

}  // namespace palpate::evaluation
