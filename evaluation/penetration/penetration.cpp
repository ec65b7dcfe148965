// penetration (the paper's section 5, Fig. 8): a hand presses straight from the skin through the
// skull into the brain and out again; what it feels with a threshold, with ranges, and without.
#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <limits>

#include "evaluation/experiment.hpp"
#include "evaluation/penetration/figure.hpp"
#include "evaluation/penetration/pressing.hpp"
#include "palpate/io/error.hpp"

namespace palpate::evaluation {
namespace {

/// Of k PT [N].
constexpr double rounding = 1e-9;

/// What was felt in one press, over every tick.
struct Press {
    std::string volume, function;
    std::size_t ticks = 0, contacts = 0;
    double largest_force = 0;                                   ///< [N]
    double lowest = std::numeric_limits<double>::infinity();    ///< level felt in contact
    double highest = -std::numeric_limits<double>::infinity();  ///< level felt in contact
    double lowest_of_all = 0, highest_of_all = 0;               ///< the proxy's level in any tick
    double deepest_scp = 0;  ///< largest excess at the SCP over the first level, of the range
    std::size_t out_of_ranges = 0;      ///< ticks in contact with a level that is not of interest
    std::size_t below_minimum = 0;      ///< ticks in contact with a level above the free side's end
    std::optional<PressingTick> shown;  ///< the first with the largest force at the innermost level
};

Penetrability penetrability_of(const std::string& function, const PressingLine& line,
                               const PressingPlan& plan) {
    const Field& field = line.subject.field;
    if (function == "threshold") {
        return penetrability_threshold(plan.threshold, line.subject.isovalue, field.solid());
    }
    if (function == "ranges") {
        return penetrability_ranges(plan.threshold, line.ranges, field.solid());
    }
    return no_penetrability();
}

void meet(Press& felt, const PressingTick& tick, const PressingLine& line) {
    const Field& field = line.subject.field;
    const double level = tick.update.isovalue;
    if (felt.ticks == 0) felt.lowest_of_all = felt.highest_of_all = level;
    ++felt.ticks;
    felt.lowest_of_all = std::min(felt.lowest_of_all, level);
    felt.highest_of_all = std::max(felt.highest_of_all, level);
    felt.largest_force = std::max(felt.largest_force, tick.force);
    felt.deepest_scp =
        std::max(felt.deepest_scp,
                 field.sign() * (tick.update.density - line.subject.isovalue) / field.range());
    if (tick.update.mode != Mode::constrained) return;
    ++felt.contacts;
    felt.lowest = std::min(felt.lowest, level);
    felt.highest = std::max(felt.highest, level);
    const bool of_interest = std::ranges::any_of(line.ranges, [&](const DensityRange& range) {
        return range.low <= level && level <= range.high;
    });
    felt.out_of_ranges += !of_interest;
    felt.below_minimum += field.sign() * (level - line.subject.isovalue) < 0;
    const bool innermost = field.sign() * (level - line.levels.back().isovalue) >= 0;
    if (tick.inwards && innermost && (!felt.shown || tick.force > felt.shown->force + rounding)) {
        felt.shown = tick;
    }
}

/// Presses once and writes down every `each`-th tick.
Press press_of(const PressingLine& line, const std::string& function, const PressingPlan& plan,
               int each, Table& table) {
    Press felt;
    felt.volume = line.subject.name;
    felt.function = function;
    for (const PressingTick& tick : press(line, penetrability_of(function, line, plan), plan)) {
        const bool noted = felt.ticks % std::size_t(each) == 0;
        meet(felt, tick, line);
        if (!noted) continue;
        table.add({{"volume", felt.volume},
                   {"penetrability", function},
                   {"direction", tick.inwards ? "in" : "out"},
                   {"depth_mm", tick.depth},
                   {"isovalue", tick.update.isovalue},
                   {"density_at_scp", tick.update.density},
                   {"density_at_hand", tick.density_at_hand},
                   {"pull_device_mm", tick.pull},
                   {"force_n", tick.force},
                   {"mode", tick.update.mode == Mode::constrained ? "constrained" : "free"}});
    }
    return felt;
}

/// The sum over the presses of one function.
template <class Value>
std::size_t sum(const std::vector<Press>& presses, const std::string& function, Value value) {
    std::size_t all = 0;
    for (const Press& s : presses) all += s.function == function ? std::invoke(value, s) : 0;
    return all;
}

/// The largest over the presses of one function, at least 0.
template <class Value>
double over(const std::vector<Press>& presses, const std::string& function, Value value) {
    double most = 0;
    for (const Press& s : presses) {
        if (s.function == function) most = std::max(most, std::invoke(value, s));
    }
    return most;
}

Claim force_claim(const std::vector<Press>& presses, const std::string& function,
                  const PressingPlan& plan) {
    const double most = plan.stiffness * plan.threshold;
    const double largest = over(presses, function, &Press::largest_force);
    return {fmt::format("{}: the spring never pulls with more than k PT = {:g} N", function, most),
            largest <= most + rounding, fmt::format("largest {:.10g} N", largest)};
}

std::vector<Claim> claims_of(const std::vector<Press>& presses, const PressingPlan& plan) {
    std::vector<Claim> claims{force_claim(presses, "threshold", plan),
                              force_claim(presses, "ranges", plan)};
    const auto below = sum(presses, "threshold", &Press::below_minimum);
    claims.push_back({"threshold: no level on the free side of the minimum is ever felt",
                      below == 0,
                      fmt::format("{} of {} ticks in contact", below,
                                  sum(presses, "threshold", &Press::contacts))});
    const auto others = sum(presses, "ranges", &Press::out_of_ranges);
    claims.push_back({"ranges: only levels within the ranges are ever felt", others == 0,
                      fmt::format("{} of {} ticks in contact", others,
                                  sum(presses, "ranges", &Press::contacts))});
    const double moved =
        over(presses, "off", [](const Press& s) { return s.highest_of_all - s.lowest_of_all; });
    claims.push_back(
        {"off: the isovalue never changes", moved == 0, fmt::format("spread {:g}", moved)});
    const double inside = over(presses, "off", &Press::deepest_scp);
    claims.push_back(
        {fmt::format("off: the SCP never enters (to {:g} of the data's range)", granted),
         inside <= granted, fmt::format("largest excess {:.2g}", inside)});
    return claims;
}

/// What one volume's presses gave, in words.
std::string sentence_of(const PressingLine& line, const std::vector<Press>& presses) {
    const auto of = [&](const std::string& function) -> const Press& {
        return *std::ranges::find_if(presses, [&](const Press& s) {
            return s.volume == line.subject.name && s.function == function;
        });
    };
    const auto levels = [](const Press& s) {
        return s.contacts == 0 ? std::string("nothing")
                               : fmt::format("levels from {:.5g} to {:.5g}", s.lowest, s.highest);
    };
    const Press &off = of("off"), &threshold = of("threshold"), &ranges = of("ranges");
    return fmt::format(
        " {}, {:.3g} mm deep: off, the level stays {:g} and the spring reaches {:.3g} N; with the "
        "threshold {} are felt with at most {:.4g} N, in contact for {:.0f} % of the ticks; with "
        "ranges {} with at most {:.4g} N, in contact for {:.0f} %.",
        line.subject.name, line.depth, line.subject.isovalue, off.largest_force, levels(threshold),
        threshold.largest_force, 100.0 * double(threshold.contacts) / double(threshold.ticks),
        levels(ranges), ranges.largest_force,
        100.0 * double(ranges.contacts) / double(ranges.ticks));
}

void add_picture(Result& result, const PressingLine& line, const Press& felt,
                 const Options& options, double done) {
    if (!felt.shown) return;
    const auto waiting = [&] { options.progress(done); };
    try {
        result.pictures.push_back(penetration_picture(line, *felt.shown, options.quick, waiting));
    } catch (const io::OutputError& e) {
        waiting();  // Ctrl-C ends the helper as well, which is not its failure
        options.note(
            fmt::format("penetration: without the picture of {}: {}", line.subject.name, e.what()));
    }
}

}  // namespace

Result penetration(const Options& options) {
    const PressingPlan plan;
    Result result;
    const auto lines = pressing_lines(options.subjects, options.data, options.quick, options.note);
    std::vector<Press> presses;
    for (const PressingLine& line : lines) {
        const double done = double(presses.size()) / double(3 * lines.size());
        for (const char* const function : pressing_functions) {
            options.progress(done);
            presses.push_back(press_of(line, function, plan, options.quick ? 20 : 5, result.table));
        }
        add_picture(result, line, presses.back(), options, done);
    }
    result.figures.push_back(penetration_figure(result.table, lines, plan));
    result.claims = claims_of(presses, plan);
    result.paragraph = fmt::format(
        "A hand presses straight in at {:g} mm/s and comes out again, at {:g} Hz with k = {:g} "
        "N/mm; a millimetre of hand is a voxel. With the threshold the surface gives way at PT = "
        "{:g} mm and every level from the first one on may be felt; with ranges only some are.",
        plan.speed, plan.rate, plan.stiffness, plan.threshold);
    for (const PressingLine& line : lines) result.paragraph += sentence_of(line, presses);
    return result;
}

}  // namespace palpate::evaluation
