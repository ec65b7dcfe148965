// performance (the paper's Table 1): the time of an update while a hand explores and touches, at
// two resolutions, on the paper's volumes or on similar ones where those are not available.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "evaluation/contestants.hpp"
#include "evaluation/experiment.hpp"
#include "evaluation/exploring_hand.hpp"
#include "evaluation/performance/paper_table.hpp"
#include "evaluation/timing.hpp"
#include "palpate/renderer.hpp"

namespace palpate::evaluation {
namespace {

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

/// "smooth" is the exact method on the smooth field.
constexpr std::array<const char*, 3> measured_methods{"exact", "paper", "smooth"};

/// How the hand moves on volumes that the paper does not have.
constexpr Behaviour our_target{50, 0.6};
constexpr double tolerance = 0.15;  // of the target, for speed and share

/// A volume and the row of the paper's table that it is measured for, if any.
struct Case {
    Subject subject;
    const PaperRow* row = nullptr;
};

std::vector<Case> cases_of(const Options& options) {
    std::vector<Case> cases;
    for (const Subject& subject : options.subjects) cases.push_back({subject, nullptr});
    if (!cases.empty()) return cases;
    cases.push_back({synthetic("cylinder", 0.53), paper_row("cylinder")});
    const auto stand_in = [&](Subject subject, const char* for_which) {
        if (subject.name != for_which) subject.note = fmt::format("stands in for {}", for_which);
        cases.push_back({std::move(subject), paper_row(for_which)});
    };
    if (options.quick) {
        stand_in(synthetic("shepp-logan:64x64x64"), "visible-male");
        return cases;
    }
    constexpr std::array<std::array<const char*, 2>, 5> wanted{{{"daisy-pollen", "daisy-pollen"},
                                                                {"ct-head", "visible-male"},
                                                                {"lobster", "lobster"},
                                                                {"neuron", "neuron"},
                                                                {"orange", "orange"}}};
    std::string missing;
    for (const auto& [name, for_which] : wanted) {
        if (auto subject = real(options.data, name)) {
            if (subject->name == "neuron") subject->name = "other-neuron";
            stand_in(std::move(*subject), for_which);
        } else {
            missing += (missing.empty() ? "" : ", ") + std::string(name);
        }
    }
    if (!missing.empty()) {
        options.note("performance: without " + missing +
                     " (not in the data folder, or there is none)");
    }
    return cases;
}

struct Effort {
    int trajectories;
    double trajectory_s;
    TimingPlan timing;
};

/// The rows of one volume at one resolution: the same trajectories for all contestants.
void measure(const Case& one, std::size_t which, const Effort& effort, std::uint64_t seed,
             Table& table) {
    const Resolution& resolution = resolutions[which];
    const Geometry& geometry = one.subject.field.geometry();
    const double scale = scale_for_voxels_per_mm(geometry, resolution.voxels_per_mm);
    const PaperCell* const paper = one.row ? &one.row->at[which] : nullptr;
    const Behaviour target =
        paper ? Behaviour{paper->speed_mm_s, paper->constrained_share} : our_target;
    ExploringHand hand;
    hand.depth_mm *= scale;
    hand.trajectories = effort.trajectories;
    hand.trajectory_s = effort.trajectory_s;
    hand.seed = seed;
    const TunedHand tuned =
        tuned_hand(one.subject, hand, {target.speed_mm_s * scale, target.constrained_share});
    const Index3& size = geometry.size;
    const double paper_us = paper ? paper->mean_us : unknown;
    for (const char* method : measured_methods) {
        const Contestant& measured = contestant(method);
        const UpdateTimes times = time_updates(as_felt_by(measured, one.subject), measured.method,
                                               tuned.trajectories, effort.timing);
        const auto updates = static_cast<double>(times.updates);
        table.add({{"volume", one.subject.name},
                   {"note", one.subject.note},
                   {"size", fmt::format("{}x{}x{}", size[0], size[1], size[2])},
                   {"resolution", resolution.name},
                   {"voxels_per_mm", resolution.voxels_per_mm},
                   {"method", method},
                   {"target_from", paper ? "paper" : "ours"},
                   {"paper_row", one.row ? one.row->volume : ""},
                   {"target_speed_mm_s", target.speed_mm_s},
                   {"speed_mm_s", tuned.behaviour.speed_mm_s / scale},
                   {"target_constrained_share", target.constrained_share},
                   {"constrained_share", double(times.constrained) / updates},
                   {"depth_mm", tuned.hand.depth_mm / scale},
                   {"updates", updates},
                   {"mean_ns", times.mean_ns},
                   {"p50_ns", times.p50_ns},
                   {"p99_ns", times.p99_ns},
                   {"p999_ns", times.p999_ns},
                   {"max_ns", times.max_ns},
                   {"interrupted_max_ns", times.interrupted_max_ns},
                   {"cold_p50_ns", times.cold_p50_ns},
                   {"clock_ns", times.clock_ns},
                   {"tetrahedra_per_update", double(times.tetrahedra) / updates},
                   {"unfinished_updates", double(times.unfinished)},
                   {"paper_mean_us", paper_us},
                   {"paper_over_ours", 1000 * paper_us / times.mean_ns}});
    }
}

/// The largest of a column over the rows of a method.
double most(const Table& table, const std::string& method, const std::string& column) {
    return largest(table.where("method", method).numbers(column));
}

/// How far the hand of any row is from its target, as a part of it.
double farthest_from_target(const Table& table) {
    double off = 0;
    const Table exact = table.where("method", "exact");
    for (const std::string what : {"speed_mm_s", "constrained_share"}) {
        for (const auto& row : exact.rows_of({what, "target_" + what})) {
            off = std::max(off, std::abs(row[0] / row[1] - 1));
        }
    }
    return off;
}

std::vector<Claim> claims_of(const Table& table, const Options& options) {
    std::vector<Claim> claims;
    for (const char* method : {"exact", "smooth"}) {
        const double unfinished = most(table, method, "unfinished_updates");
        claims.push_back({fmt::format("every update of {} is finished within its tick", method),
                          unfinished == 0, fmt::format("{:g} were not", unfinished)});
    }
    const double off = farthest_from_target(table);
    const std::string measured = fmt::format("largest distance {:.2g} %", 100 * off);
    if (options.subjects.empty()) {
        claims.push_back({fmt::format("the hand's mean speed and its share of contact by exact are "
                                      "within {:g} % of each row's target",
                                      100 * tolerance),
                          off <= tolerance, measured});
    } else if (off > tolerance) {
        options.note(
            "performance: the hand cannot keep to its targets on this volume, which is "
            "very small or very ragged (" +
            measured + " of the target)");
    }
    return claims;
}

/// The paper's Table 1 beside the same rows here.
Table summary_of(const Table& table) {
    Table summary;
    const Table exact = table.where("method", "exact").where("target_from", "paper");
    const Table paper = table.where("method", "paper").where("target_from", "paper");
    const Table smooth = table.where("method", "smooth").where("target_from", "paper");
    for (std::size_t i = 0; i < exact.rows().size(); ++i) {
        const auto number = [&](const char* column) { return exact.number(i, column); };
        const std::string &volume = exact.text(i, "volume"), &row = exact.text(i, "paper_row");
        summary.add(
            {{"volume", volume == row ? volume : volume + " for " + row},
             {"resolution", exact.text(i, "resolution")},
             {"size in the paper", paper_row(row)->size},
             {"size here", exact.text(i, "size")},
             {"hand in the paper [cm/s]", number("target_speed_mm_s") / 10},
             {"hand here [cm/s]", number("speed_mm_s") / 10},
             {"contact in the paper [%]", 100 * number("target_constrained_share")},
             {"contact here [%]", 100 * number("constrained_share")},
             {"haptic loop in the paper, mean [µs]", number("paper_mean_us")},
             {"update by exact, mean [µs]", number("mean_ns") / 1000},
             {"update by exact, p99.9 [µs]", number("p999_ns") / 1000},
             {"update by the paper's method here, mean [µs]", paper.number(i, "mean_ns") / 1000},
             {"update by exact on the smooth field, mean [µs]",
              smooth.number(i, "mean_ns") / 1000}});
    }
    return summary;
}

struct Mark {
    const char* column;
    const char* title;
    Look look;
};

constexpr std::array<Mark, 6> marks{
    {{"max_ns", "max", {colours::vermilion, Marker::diamond, 1.2}},
     {"cold_p50_ns", "p50, caches emptied", {colours::sky, Marker::open_circle, 1.1}},
     {"p999_ns", "p99.9", {colours::orange, Marker::triangle_down}},
     {"p99_ns", "p99", {colours::green, Marker::triangle}},
     {"mean_ns", "mean", {colours::black, Marker::cross}},
     {"p50_ns", "p50", {colours::blue, Marker::circle, 0.9}}}};

/// Where on the x axis the rows of a method stand: LR and HR of a volume side by side.
double position(std::size_t row) {
    return 2.6 * static_cast<double>(row / 2) + static_cast<double>(row % 2);
}

/// Microseconds of a column, each at its row's position.
Rows microseconds(const Table& table, const std::string& column, double scale) {
    Rows rows;
    for (const double value : table.numbers(column)) {
        rows.push_back({position(rows.size()), scale * value});
    }
    return rows;
}

Panel panel_of(const Table& table, const char* title) {
    Panel panel;
    panel.title = title;
    panel.y = {
        .title = "time of an update [µs]", .is_logarithmic = true, .low = 0.02, .high = 3000};
    const std::size_t rows = table.rows().size();
    panel.x.low = -0.8;
    panel.x.high = position(rows - 1) + 0.8;
    for (std::size_t i = 0; i < rows; ++i) {
        panel.x.ticks.push_back({position(i), table.text(i, "resolution")});
        if (i % 2 > 0) continue;
        panel.x.ticks.push_back({position(i) + 0.5, "\n" + table.text(i, "volume")});
    }
    panel.add_level(1000, "a tick at 1 kHz", {.colour = colours::dark_grey, .dash = Dash::dashed});
    const Rows paper = microseconds(table, "paper_mean_us", 1);
    if (std::any_of(paper.begin(), paper.end(), [](const auto& r) { return !std::isnan(r[1]); })) {
        panel.add(Draw::points, "mean of the haptic loop in the paper",
                  {colours::purple, Marker::star, 1.3}, paper);
    }
    Series& spans = panel.add(Draw::segments, "", {.colour = colours::light_grey}, {});
    for (std::size_t i = 0; i < rows; ++i) {
        spans.rows.push_back({position(i), table.number(i, "p50_ns") / 1000, position(i),
                              table.number(i, "max_ns") / 1000});
    }
    for (const Mark& mark : marks) {
        if (std::isnan(table.number(0, mark.column))) continue;
        panel.add(Draw::points, mark.title, mark.look, microseconds(table, mark.column, 1e-3));
    }
    return panel;
}

Figure figure_of(const Table& table) {
    Figure figure;
    figure.caption =
        "Time of a proxy update while a hand explores and touches as fast and as often as in each "
        "row of the paper's Table 1, at 1 kHz and 0.5 (LR) and 3 (HR) voxels per millimetre of "
        "hand: the exact method, the paper's method in this implementation, and exact on the "
        "smooth "
        "field. Stars: "
        "the means that the paper gives for its haptic loop, on its machine. Circles: the median "
        "when all caches were emptied before the update.";
    figure.height = 1300;
    figure.panels = {panel_of(table.where("method", "exact"), "exact"),
                     panel_of(table.where("method", "paper"), "the paper's method"),
                     panel_of(table.where("method", "smooth"), "exact on the smooth field")};
    return figure;
}

std::string paragraph_of(const Table& table, const TimingPlan& timing) {
    std::string text = fmt::format(
        "A simulated hand explores free space and then touches, at 1 kHz, {:g} mm below the "
        "surface (less on bodies too fine for that); 1 mm of hand is 0.5 voxel (LR) or 3 voxels "
        "(HR). Its mean speed and its share of contact are those of the same row of the paper's "
        "Table 1",
        ExploringHand().depth_mm);
    text += table.where("target_from", "ours").rows().empty()
                ? ". "
                : fmt::format("; on a volume that is not in it they are {:g} mm/s and {:g} %. ",
                              our_target.speed_mm_s, 100 * our_target.constrained_share);
    text += fmt::format(
        "The paper timed its whole haptic loop, here it is the proxy update, and the machines are "
        "many years apart; so compare the methods on this machine. Over all rows the largest "
        "mean of exact is {:.0f} ns (the paper's method {:.0f} ns, exact on the smooth field "
        "{:.0f} "
        "ns), the largest p99.9 {:.1f} µs ({:.1f} and {:.1f} µs), the longest update {:.1f} µs "
        "({:.1f} and {:.1f} µs) of the 1000 µs that a tick has. "
        "Each update was timed {} times and its median kept, since other programs share the "
        "machine; the largest single time, interruptions included, was {:.0f} µs.",
        most(table, "exact", "mean_ns"), most(table, "paper", "mean_ns"),
        most(table, "smooth", "mean_ns"), most(table, "exact", "p999_ns") / 1000,
        most(table, "paper", "p999_ns") / 1000, most(table, "smooth", "p999_ns") / 1000,
        most(table, "exact", "max_ns") / 1000, most(table, "paper", "max_ns") / 1000,
        most(table, "smooth", "max_ns") / 1000, timing.passes,
        largest(table.numbers("interrupted_max_ns")) / 1000);
    if (timing.cold_updates > 0) {
        text += fmt::format(
            " Caches are warm, since the updates follow one another; after something else has used "
            "all caches, the median update of exact takes up to {:.1f} µs.",
            most(table, "exact", "cold_p50_ns") / 1000);
    }
    return text;
}

}  // namespace

Result performance(const Options& options) {
    const Effort effort = options.quick ? Effort{4, 1.5, {3, 0}} : Effort{24, 5, {5, 200}};
    Result result;
    options.progress(0);
    const std::vector<Case> cases = cases_of(options);
    double done = 0;
    for (const Case& one : cases) {
        for (std::size_t which = 0; which < resolutions.size(); ++which) {
            options.progress(done / double(cases.size() * resolutions.size()));
            measure(one, which, effort, options.seed, result.table);
            done += 1;
        }
    }
    if (options.subjects.empty()) result.summary = summary_of(result.table);
    result.figures.push_back(figure_of(result.table));
    result.claims = claims_of(result.table, options);
    result.paragraph = paragraph_of(result.table, effort.timing);
    return result;
}

}  // namespace palpate::evaluation
