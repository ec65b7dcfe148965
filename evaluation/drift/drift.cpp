// drift (the paper's Fig. 10): the SCP is taken round a surface again and again; its density tells
// whether it is still on the isosurface.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>

#include "evaluation/experiment.hpp"
#include "evaluation/ring.hpp"
#include "palpate/baselines/methods.hpp"

namespace palpate::evaluation {
namespace {

/// Of G2 (proxy.hpp): what counts as on the isosurface, relative to the field's range.
constexpr double granted = 1e-9;

struct Plan {
    int turns;
    std::vector<double> speeds;  // [mm/s]
    std::vector<double> rates;   // [Hz]
    double shown_speed = 200, shown_rate = 1000;
};

/// What the figure shows turn by turn; of the rest the last turn is enough.
bool is_noted(int turn, int turns, bool shown) {
    return turn == turns || (shown && (turn <= 10 || turn % 2 == 0));
}

struct Course {
    const Subject& subject;
    const Ring& ring;
    const baselines::NamedMethod& method;
    double speed, rate;
    int turns;
    bool shown;
    std::function<void()> alive;  ///< called every turn; may throw to stop
};

/// Adds the rows of one proxy that is taken round.
void go_round(const Course& course, Table& table) {
    const Field& field = course.subject.field;
    Proxy proxy;
    // Where the hand comes from: outside, so that every method starts in contact from the free
    // side.
    const Vec3 centre = physical_centre(field.geometry());
    place(proxy, field, centre + 2 * (course.ring.at(0) - centre), course.subject.isovalue);
    course.method.method(proxy, field, course.ring.at(0), {}, {});
    const double step = course.speed / course.rate;
    double arc = 0, worst = 0;
    for (int turn = 1; turn <= course.turns; ++turn) {
        course.alive();
        double density = 0;
        std::int64_t constrained = 0, ticks = 0;
        for (; arc < turn * course.ring.length(); arc += step, ++ticks) {
            const ProxyUpdate update =
                course.method.method(proxy, field, course.ring.at(arc), {}, {});
            density = update.density;
            constrained += update.mode == Mode::constrained;
            // In contact it has to be on the isosurface, and free it has to be outside.
            const double off = field.sign() * (density - course.subject.isovalue) / field.range();
            worst = std::max(worst, update.mode == Mode::constrained ? std::abs(off) : off);
        }
        if (!is_noted(turn, course.turns, course.shown)) continue;
        table.add({course.subject.name, course.method.name, course.speed, course.rate, double(turn),
                   density, course.subject.isovalue, worst,
                   double(constrained) / double(std::max<std::int64_t>(1, ticks))});
    }
}

std::vector<Subject> subjects_of(const Options& options) {
    if (!options.subjects.empty()) return options.subjects;
    std::vector<Subject> subjects{synthetic("cylinder", 0.53)};
    if (options.quick) {
        subjects.push_back(synthetic("sphere:40x40x40"));
        return subjects;
    }
    for (const char* name : {"sphere", "torus", "marschner-lobb"}) {
        subjects.push_back(synthetic(name));
    }
    if (auto lobster = real(options.data, "lobster")) {
        subjects.push_back(std::move(*lobster));
    } else {
        options.note("drift: without the lobster (--data FOLDER says where lobster.nrrd is)");
    }
    return subjects;
}

double worst_of(const Table& table, const std::string& method, const std::string& subject = "") {
    double worst = 0;
    for (std::size_t i = 0; i < table.rows().size(); ++i) {
        if (table.text(i, "method") != method) continue;
        if (!subject.empty() && table.text(i, "volume") != subject) continue;
        worst = std::max(worst, table.number(i, "worst_deviation_of_range"));
    }
    return worst;
}

/// Density at the SCP after each turn, by the hand that is shown.
std::string density_panel(const Table& table, const std::string& subject, double speed,
                          double rate) {
    std::string blocks;
    std::string plots =
        fmt::format("set title {} noenhanced\n",
                    gnuplot_text(fmt::format("{}, {} mm/s, {} Hz", subject, speed, rate)));
    plots +=
        "set xlabel 'turns round the surface'\nset ylabel 'density at the SCP'\n"
        "set key outside below horizontal\nset xrange [0:*]\nplot ";
    double isovalue = 0;
    for (const auto& method : baselines::methods()) {
        std::vector<std::vector<double>> rows;
        for (std::size_t i = 0; i < table.rows().size(); ++i) {
            if (table.text(i, "volume") != subject || table.text(i, "method") != method.name ||
                table.number(i, "speed_mm_s") != speed || table.number(i, "rate_hz") != rate) {
                continue;
            }
            rows.push_back({table.number(i, "turn"), table.number(i, "density")});
            isovalue = table.number(i, "isovalue");
        }
        const std::string name = "d" + std::to_string(&method - baselines::methods().data());
        blocks += block(name, rows);
        plots += fmt::format("${} with linespoints {} title '{}', ", name,
                             method_style(method.name), method.name);
    }
    return blocks + plots + fmt::format("{} lc rgb '#808080' dt 2 title 'isovalue'\n", isovalue);
}

/// The worst deviation over everything else, against the update rate.
std::string rate_panel(const Table& table, const Plan& plan) {
    std::string blocks;
    std::string plots =
        "set title 'all volumes and speeds'\nset xlabel 'update rate [Hz]'\n"
        "set ylabel 'largest deviation / range of the data'\nset logscale xy\n"
        "set format x '%g'\nset format y '10^{%L}'\nset yrange [1e-17:10]\nset xrange [*:*]\nplot ";
    for (const auto& method : baselines::methods()) {
        std::vector<std::vector<double>> rows;
        for (const double rate : plan.rates) {
            double worst = 1e-17;  // a logarithm has no zero
            for (std::size_t i = 0; i < table.rows().size(); ++i) {
                if (table.text(i, "method") == method.name && table.number(i, "rate_hz") == rate) {
                    worst = std::max(worst, table.number(i, "worst_deviation_of_range"));
                }
            }
            rows.push_back({rate, worst});
        }
        const std::string name = "r" + std::to_string(&method - baselines::methods().data());
        blocks += block(name, rows);
        plots += fmt::format("${} with linespoints {} title '{}', ", name,
                             method_style(method.name), method.name);
    }
    return blocks + plots + fmt::format("{} lc rgb '#808080' dt 2 title 'granted (G2)'\n", granted);
}

Figure figure_of(const Table& table, const std::string& subject, const Plan& plan) {
    Figure figure;
    figure.caption =
        "Left: density at the SCP after each turn. Right: the largest deviation from the isovalue "
        "in any update, as a part of the data's range, over all volumes and speeds.";
    figure.size = {1200, 560};
    figure.script = "set multiplot layout 1,2\nset bmargin 7\n" +
                    density_panel(table, subject, plan.shown_speed, plan.shown_rate) +
                    rate_panel(table, plan) + "unset multiplot\n";
    return figure;
}

std::vector<Claim> claims_of(const Table& table, bool own_volumes) {
    std::vector<Claim> claims;
    for (const char* method : {"exact", "paper"}) {
        const double worst = worst_of(table, method);
        claims.push_back({fmt::format("{} stays on the isosurface to {:g} of the data's range, at "
                                      "every rate and speed",
                                      method, granted),
                          worst <= granted, fmt::format("largest deviation {:.2g}", worst)});
    }
    if (own_volumes) {
        const double worst = worst_of(table, "gradient", "cylinder");
        claims.push_back(
            {"gradient loses the cylinder's isosurface by more than a hundredth of "
             "the data's range",
             worst > 0.01, fmt::format("largest deviation {:.2g}", worst)});
    }
    return claims;
}

}  // namespace

Result drift(const Options& options) {
    const Plan plan = options.quick ? Plan{20, {200, 1000}, {100, 1000}}
                                    : Plan{200, {50, 200, 1000}, {100, 1000, 10000}};
    Result result;
    result.table = Table({"volume", "method", "speed_mm_s", "rate_hz", "turn", "density",
                          "isovalue", "worst_deviation_of_range", "constrained_share"});
    const std::vector<Subject> subjects = subjects_of(options);
    const double cases = double(subjects.size() * plan.speeds.size() * plan.rates.size());
    double done = 0;
    for (const Subject& subject : subjects) {
        const Ring ring = ring_round(subject, 2 * subject.field.geometry().spacing.minCoeff());
        for (const double speed : plan.speeds) {
            for (const double rate : plan.rates) {
                for (const auto& method : baselines::methods()) {
                    const auto alive = [&] { options.progress(done / cases); };
                    go_round({subject, ring, method, speed, rate, plan.turns,
                              speed == plan.shown_speed && rate == plan.shown_rate, alive},
                             result.table);
                }
                done += 1;
            }
        }
    }
    result.figures.push_back(figure_of(result.table, subjects.front().name, plan));
    result.claims = claims_of(result.table, options.subjects.empty());
    result.paragraph = fmt::format(
        "A hand goes round each body {} times, 2 voxels below its surface, with penetrability off; "
        "the density at the SCP says how far the proxy has left the isosurface. Largest deviation "
        "over all {} volumes, {} hand speeds and {} update rates, as a part of the data's range: "
        "exact {:.1e}, paper {:.1e}, gradient {:.2g}, gradient-improved {:.2g}. The exact method "
        "and the paper's move inside linear pieces, so what is left is rounding, however far the "
        "hand moves in a tick. The gradient method follows a plane off the surface; putting the "
        "SCP back along the gradient helps where the gradient leads back to the same surface.",
        plan.turns, subjects.size(), plan.speeds.size(), plan.rates.size(),
        worst_of(result.table, "exact"), worst_of(result.table, "paper"),
        worst_of(result.table, "gradient"), worst_of(result.table, "gradient-improved"));
    return result;
}

}  // namespace palpate::evaluation
