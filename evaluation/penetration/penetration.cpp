// penetration (the paper's section 5, Fig. 8): a hand presses straight from the skin through the
// skull into the brain and out again; what it feels with a threshold, with ranges, and without.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "evaluation/experiment.hpp"
#include "evaluation/penetration/course.hpp"
#include "evaluation/penetration/figure.hpp"
#include "palpate/io/error.hpp"

namespace palpate::evaluation {
namespace {

/// Of G1 and G2 (proxy.hpp), relative to the field's range.
constexpr double granted = 1e-9;
/// Of k PT [N].
constexpr double rounding = 1e-9;

/// What was met in one stroke, over every tick.
struct Stroke {
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

Penetrability penetrability_of(const std::string& function, const PressingCourse& course,
                               const PressingPlan& plan) {
    const Field& field = course.subject.field;
    if (function == "threshold") {
        return penetrability_threshold(plan.threshold, course.subject.isovalue, field.solid());
    }
    if (function == "ranges") {
        return penetrability_ranges(plan.threshold, course.ranges, field.solid());
    }
    return no_penetrability();
}

void meet(Stroke& stroke, const PressingTick& tick, const PressingCourse& course) {
    const Field& field = course.subject.field;
    const double level = tick.update.isovalue;
    if (stroke.ticks == 0) stroke.lowest_of_all = stroke.highest_of_all = level;
    ++stroke.ticks;
    stroke.lowest_of_all = std::min(stroke.lowest_of_all, level);
    stroke.highest_of_all = std::max(stroke.highest_of_all, level);
    stroke.largest_force = std::max(stroke.largest_force, tick.force);
    stroke.deepest_scp =
        std::max(stroke.deepest_scp,
                 field.sign() * (tick.update.density - course.subject.isovalue) / field.range());
    if (tick.update.mode != Mode::constrained) return;
    ++stroke.contacts;
    stroke.lowest = std::min(stroke.lowest, level);
    stroke.highest = std::max(stroke.highest, level);
    const bool of_interest = std::ranges::any_of(course.ranges, [&](const DensityRange& range) {
        return range.low <= level && level <= range.high;
    });
    stroke.out_of_ranges += !of_interest;
    stroke.below_minimum += field.sign() * (level - course.subject.isovalue) < 0;
    const bool innermost = field.sign() * (level - course.levels.back().isovalue) >= 0;
    if (tick.inwards && innermost &&
        (!stroke.shown || tick.force > stroke.shown->force + rounding)) {
        stroke.shown = tick;
    }
}

/// Presses once and writes down every `each`-th tick.
Stroke stroke_of(const PressingCourse& course, const std::string& function,
                 const PressingPlan& plan, int each, Table& table) {
    Stroke stroke;
    stroke.volume = course.subject.name;
    stroke.function = function;
    for (const PressingTick& tick : press(course, penetrability_of(function, course, plan), plan)) {
        const bool noted = stroke.ticks % std::size_t(each) == 0;
        meet(stroke, tick, course);
        if (!noted) continue;
        table.add({stroke.volume, function, tick.inwards ? "in" : "out", tick.depth,
                   tick.update.isovalue, tick.update.density, tick.density_at_hand, tick.pull,
                   tick.force, tick.update.mode == Mode::constrained ? "constrained" : "free"});
    }
    return stroke;
}

/// The sum over the strokes of one function.
template <class Value>
std::size_t sum(const std::vector<Stroke>& strokes, const std::string& function, Value value) {
    std::size_t all = 0;
    for (const Stroke& s : strokes) all += s.function == function ? value(s) : 0;
    return all;
}

/// The largest over the strokes of one function, at least 0.
template <class Value>
double over(const std::vector<Stroke>& strokes, const std::string& function, Value value) {
    double most = 0;
    for (const Stroke& s : strokes) {
        if (s.function == function) most = std::max(most, value(s));
    }
    return most;
}

Claim force_claim(const std::vector<Stroke>& strokes, const std::string& function,
                  const PressingPlan& plan) {
    const double most = plan.stiffness * plan.threshold;
    const double largest = over(strokes, function, [](const Stroke& s) { return s.largest_force; });
    return {fmt::format("{}: the spring never pulls with more than k PT = {:g} N", function, most),
            largest <= most + rounding, fmt::format("largest {:.10g} N", largest)};
}

std::vector<Claim> claims_of(const std::vector<Stroke>& strokes, const PressingPlan& plan) {
    std::vector<Claim> claims{force_claim(strokes, "threshold", plan),
                              force_claim(strokes, "ranges", plan)};
    const auto contacts = [](const Stroke& s) { return s.contacts; };
    const auto below = sum(strokes, "threshold", [](const Stroke& s) { return s.below_minimum; });
    claims.push_back(
        {"threshold: no level on the free side of the minimum is ever felt", below == 0,
         fmt::format("{} of {} ticks in contact", below, sum(strokes, "threshold", contacts))});
    const auto others = sum(strokes, "ranges", [](const Stroke& s) { return s.out_of_ranges; });
    claims.push_back(
        {"ranges: only levels within the ranges are ever felt", others == 0,
         fmt::format("{} of {} ticks in contact", others, sum(strokes, "ranges", contacts))});
    const double moved =
        over(strokes, "off", [](const Stroke& s) { return s.highest_of_all - s.lowest_of_all; });
    claims.push_back(
        {"off: the isovalue never changes", moved == 0, fmt::format("spread {:g}", moved)});
    const double inside = over(strokes, "off", [](const Stroke& s) { return s.deepest_scp; });
    claims.push_back(
        {fmt::format("off: the SCP never enters (to {:g} of the data's range)", granted),
         inside <= granted, fmt::format("largest excess {:.2g}", inside)});
    return claims;
}

/// What one volume's strokes gave, in words.
std::string sentence_of(const PressingCourse& course, const std::vector<Stroke>& strokes) {
    const auto of = [&](const std::string& function) -> const Stroke& {
        return *std::ranges::find_if(strokes, [&](const Stroke& s) {
            return s.volume == course.subject.name && s.function == function;
        });
    };
    const auto levels = [](const Stroke& s) {
        return s.contacts == 0 ? std::string("nothing")
                               : fmt::format("levels from {:.5g} to {:.5g}", s.lowest, s.highest);
    };
    const Stroke &off = of("off"), &threshold = of("threshold"), &ranges = of("ranges");
    return fmt::format(
        " {}, {:.3g} mm deep: off, the level stays {:g} and the spring reaches {:.3g} N; with the "
        "threshold {} are felt with at most {:.4g} N, in contact for {:.0f} % of the ticks; with "
        "ranges {} with at most {:.4g} N, in contact for {:.0f} %.",
        course.subject.name, course.depth, course.subject.isovalue, off.largest_force,
        levels(threshold), threshold.largest_force,
        100.0 * double(threshold.contacts) / double(threshold.ticks), levels(ranges),
        ranges.largest_force, 100.0 * double(ranges.contacts) / double(ranges.ticks));
}

void add_picture(Result& result, const PressingCourse& course, const Stroke& stroke,
                 const Options& options, double done) {
    if (!stroke.shown) return;
    const auto waiting = [&] { options.progress(done); };
    try {
        result.pictures.push_back(
            penetration_picture(course, *stroke.shown, options.quick, waiting));
    } catch (const io::OutputError& e) {
        waiting();  // Ctrl-C ends the helper as well, which is not its failure
        options.note(fmt::format("penetration: without the picture of {}: {}", course.subject.name,
                                 e.what()));
    }
}

}  // namespace

Result penetration(const Options& options) {
    const PressingPlan plan;
    Result result;
    result.table =
        Table({"volume", "penetrability", "way", "depth_mm", "isovalue", "density_at_scp",
               "density_at_hand", "pull_device_mm", "force_n", "mode"});
    const auto courses =
        pressing_courses(options.subjects, options.data, options.quick, options.note);
    std::vector<Stroke> strokes;
    for (const PressingCourse& course : courses) {
        const double done = double(strokes.size()) / double(3 * courses.size());
        for (const char* const function : pressing_functions) {
            options.progress(done);
            strokes.push_back(
                stroke_of(course, function, plan, options.quick ? 20 : 5, result.table));
        }
        add_picture(result, course, strokes.back(), options, done);
    }
    result.figures.push_back(penetration_figure(result.table, courses, plan));
    result.claims = claims_of(strokes, plan);
    result.paragraph = fmt::format(
        "A hand presses straight in at {:g} mm/s and comes out again, at {:g} Hz with k = {:g} "
        "N/mm; a millimetre of hand is a voxel. With the threshold the surface gives way at PT = "
        "{:g} mm and every level from the first one on may be felt; with ranges only some are.",
        plan.speed, plan.rate, plan.stiffness, plan.threshold);
    for (const PressingCourse& course : courses) result.paragraph += sentence_of(course, strokes);
    return result;
}

}  // namespace palpate::evaluation
