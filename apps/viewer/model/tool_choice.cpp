// Sizes and spacings of tools for a grid.
#include "apps/viewer/model/tool_choice.hpp"

#include <cmath>
#include <stdexcept>
#include <variant>

namespace palpate::viewer {
namespace {

/// The next of 1, 2, 5, 10, 20, ...
double rounded_up(double length) {
    const double decade = std::pow(10, std::floor(std::log10(length)));
    for (const double step : {1.0, 2.0, 5.0}) {
        if (step * decade >= length) return step * decade;
    }
    return 10 * decade;
}

}  // namespace

std::vector<io::ToolSpec> built_in_tools(const Geometry& geometry) {
    const double unit = rounded_up(3 * geometry.spacing.minCoeff());  // [mm]
    return {io::PointSpec{},        io::SphereSpec{unit},
            io::RodSpec{10 * unit}, io::NeedleSpec{20 * unit, 0.25 * unit},
            io::BurrSpec{unit},     io::BoxSpec{{4 * unit, 2 * unit, unit}},
            io::FingertipSpec{}};
}

MadeTool made_tool(const io::ToolSpec& spec, double scale, const Geometry& geometry) {
    constexpr std::size_t most_points = 2000;
    if (std::holds_alternative<io::PointSpec>(spec)) return {};
    const io::ToolSpec scaled = io::scaled(spec, scale);
    MadeTool made{nullptr, io::usual_spacing(geometry)};
    constexpr int tries = 60;
    for (int i = 0;; ++i) {
        try {
            made.tool = io::make_tool(scaled, made.spacing);
        } catch (const std::invalid_argument&) {  // most likely far too many points
            if (i == tries) throw;
            made.spacing *= 2;
            continue;
        }
        const std::size_t count = made.tool->points().size();
        const bool given = std::holds_alternative<io::PointsSpec>(spec);
        if (count <= most_points || given || i == tries) return made;
        made.spacing *= 1.02 * std::sqrt(double(count) / double(most_points));
    }
}

}  // namespace palpate::viewer
