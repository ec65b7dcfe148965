// Writes gnuplot's script of a demo's figure: three panels above one another, with one time axis.
#include "apps/palpate/demo_figure.hpp"

#include <fmt/format.h>

#include <cmath>

#include "io/recording/plot.hpp"

namespace palpate::app {
namespace {

/// A point that is not finite is a gap.
std::string number(double value) {
    return std::isfinite(value) ? fmt::format("{}", value) : "NaN";
}

/// "$rows << EOD ... EOD": time, depth, force, density, isovalue.
std::string block_of(const std::vector<io::TraceRow>& rows) {
    constexpr std::size_t most_points = 20'000;  // gnuplot takes a minute for a million
    std::string text = "$rows << EOD\n";
    for (std::size_t i = 0; i < rows.size(); i += 1 + rows.size() / most_points) {
        const io::TraceRow& row = rows[i];
        text += number(row.t) + " " + number((row.scp - row.hip).norm()) + " " +
                number(row.force.norm()) + " " + number(row.density) + " " + number(row.isovalue) +
                "\n";
    }
    return text + "EOD\n";
}

constexpr const char* panels = R"(
set encoding utf8
set border lc rgb '#404040'
set grid lc rgb '#d8d8d8' lw 1 lt 1
set lmargin at screen 0.1
set rmargin at screen 0.97
unset key
set multiplot layout 3,1
set ylabel 'depth |SCP - HIP| [mm]'
plot $rows using 1:2 with lines lc rgb '#0072B2' lw 2
set ylabel 'force [N]'
plot $rows using 1:3 with lines lc rgb '#D55E00' lw 2
set ylabel 'density'
set xlabel 'time [s]'
set key outside above right horizontal
plot $rows using 1:4 with lines lc rgb '#009E73' lw 2 title 'density at the SCP', \
     $rows using 1:5 with lines lc rgb '#000000' lw 2 dt (14,8) title 'isovalue'
unset multiplot
)";

}  // namespace

bool plot_over_time(const std::vector<io::TraceRow>& rows, const std::filesystem::path& folder) {
    if (!io::can_plot()) return false;
    const std::string script = block_of(rows) + panels;
    return io::plot(script, folder / "session.png").empty() &&
           io::plot(script, folder / "session.svg").empty();
}

}  // namespace palpate::app
