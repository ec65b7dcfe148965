// drift (the paper's Fig. 10): the SCP is taken round a surface again and again; its density tells
// whether it is still on the isosurface.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "evaluation/contestants.hpp"
#include "evaluation/experiment.hpp"
#include "evaluation/ring.hpp"

namespace palpate::evaluation {
namespace {

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

struct Round {
    Subject subject;
    const Ring& ring;
    const Contestant& contestant;
    double speed, rate;
    int turns;
    bool shown;
    std::function<void()> alive;  ///< called every turn; may throw to stop
};

/// Adds the rows of one proxy that is taken round.
void go_round(const Round& round, Table& table) {
    const Field& field = round.subject.field;
    Proxy proxy;
    // Where the hand comes from: outside, so that every method starts in contact from the free
    // side.
    const Vec3 centre = physical_centre(field.geometry());
    place(proxy, field, centre + 2 * (round.ring.at(0) - centre), round.subject.isovalue);
    round.contestant.method(proxy, field, round.ring.at(0), {}, {});
    const double step = round.speed / round.rate;
    double arc = 0, worst = 0;
    for (int turn = 1; turn <= round.turns; ++turn) {
        round.alive();
        double density = 0;
        std::int64_t constrained = 0, ticks = 0;
        for (; arc < turn * round.ring.length(); arc += step, ++ticks) {
            const ProxyUpdate update =
                round.contestant.method(proxy, field, round.ring.at(arc), {}, {});
            density = update.density;
            constrained += update.mode == Mode::constrained;
            // In contact it has to be on the isosurface, and free it has to be outside.
            const double off = field.sign() * (density - round.subject.isovalue) / field.range();
            worst = std::max(worst, update.mode == Mode::constrained ? std::abs(off) : off);
        }
        if (!is_noted(turn, round.turns, round.shown)) continue;
        table.add({{"volume", round.subject.name},
                   {"method", round.contestant.name},
                   {"speed_mm_s", round.speed},
                   {"rate_hz", round.rate},
                   {"turn", double(turn)},
                   {"density", density},
                   {"isovalue", round.subject.isovalue},
                   {"worst_deviation_of_range", worst},
                   {"constrained_share",
                    double(constrained) / double(std::max<std::int64_t>(1, ticks))}});
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
        options.note("drift: without the lobster (no data folder with lobster.nrrd)");
    }
    return subjects;
}

double worst_of(const Table& table, const std::string& method) {
    return largest(table.where("method", method).numbers("worst_deviation_of_range"));
}

/// Density at the SCP after each turn, of the hand that is shown.
Panel density_panel(const Table& table, const Plan& plan) {
    Panel panel;
    const std::string volume = table.text(0, "volume");
    panel.title = fmt::format("{}, {} mm/s, {} Hz", volume, plan.shown_speed, plan.shown_rate);
    panel.x.title = "turns round the surface";
    panel.y.title = "density at the SCP";
    panel.x.low = 0;
    const Table shown = table.where("volume", volume)
                            .where("speed_mm_s", plan.shown_speed)
                            .where("rate_hz", plan.shown_rate);
    for (const auto& [name, method, interpolation] : contestants()) {
        panel.add(Draw::line_points, name, look_of_method(name),
                  shown.where("method", name).rows_of({"turn", "density"}));
    }
    panel.add_level(shown.number(0, "isovalue"), "isovalue",
                    {.colour = colours::grey, .dash = Dash::dashed});
    return panel;
}

/// The worst deviation of each method against the update rate, over all volumes and speeds.
Panel rate_panel(const Table& table, const Plan& plan) {
    Panel panel;
    panel.title = "all volumes and speeds";
    panel.x = {.title = "update rate [Hz]", .is_logarithmic = true};
    panel.y = {.title = "largest deviation / range of the data",
               .is_logarithmic = true,
               .low = 1e-17,
               .high = 10,
               .format = "10^{%L}"};
    for (const auto& [name, method, interpolation] : contestants()) {
        Rows rows;
        for (const double rate : plan.rates) {
            const double worst = worst_of(table.where("rate_hz", rate), name);
            rows.push_back({rate, std::max(worst, 1e-17)});  // a logarithm has no zero
        }
        panel.add(Draw::line_points, name, look_of_method(name), rows);
    }
    panel.add_level(granted, "tolerance (G2)", {.colour = colours::grey, .dash = Dash::dotted});
    return panel;
}

Figure figure_of(const Table& table, const Plan& plan) {
    Figure figure;
    figure.caption =
        "Left: density at the SCP after each turn. Right: the largest deviation from the isovalue "
        "in any update, as a part of the data's range, over all volumes and speeds.";
    figure.columns = 2;
    figure.panels = {density_panel(table, plan), rate_panel(table, plan)};
    return figure;
}

std::vector<Claim> claims_of(const Table& table, bool own_volumes) {
    std::vector<Claim> claims;
    for (const char* method : {"exact", "paper", "smooth"}) {
        const double worst = worst_of(table, method);
        claims.push_back({fmt::format("{} stays on the isosurface to {:g} of the data's range, at "
                                      "every rate and speed",
                                      method, granted),
                          worst <= granted, fmt::format("largest deviation {:.2g}", worst)});
    }
    if (own_volumes) {
        const double worst = worst_of(table.where("volume", "cylinder"), "gradient");
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
    const std::vector<Subject> subjects = subjects_of(options);
    const double cases = double(subjects.size() * plan.speeds.size() * plan.rates.size());
    double done = 0;
    for (const Subject& subject : subjects) {
        const Ring ring = ring_round(subject, 2 * subject.field.geometry().spacing.minCoeff());
        for (const double speed : plan.speeds) {
            for (const double rate : plan.rates) {
                for (const Contestant& contestant : contestants()) {
                    const auto alive = [&] { options.progress(done / cases); };
                    go_round(
                        {as_felt_by(contestant, subject), ring, contestant, speed, rate, plan.turns,
                         speed == plan.shown_speed && rate == plan.shown_rate, alive},
                        result.table);
                }
                done += 1;
            }
        }
    }
    result.figures.push_back(figure_of(result.table, plan));
    result.claims = claims_of(result.table, options.subjects.empty());
    result.paragraph = fmt::format(
        "A hand goes round each body {} times, 2 voxels below its surface, with penetrability off; "
        "the density at the SCP says how far the proxy has left the isosurface. Largest deviation "
        "over all {} volumes, {} hand speeds and {} update rates, as a part of the data's range: "
        "exact {:.1e}, paper {:.1e}, smooth {:.1e}, gradient {:.2g}, gradient-improved {:.2g}. The "
        "exact method and the paper's move inside linear pieces, so what is left is rounding, "
        "however far the hand moves in a tick; on the smooth field (exact method, its own "
        "isosurface) it is the accuracy of the roots. The gradient method follows a plane off the "
        "surface; putting the "
        "SCP back along the gradient helps where the gradient leads back to the same surface.",
        plan.turns, subjects.size(), plan.speeds.size(), plan.rates.size(),
        worst_of(result.table, "exact"), worst_of(result.table, "paper"),
        worst_of(result.table, "smooth"), worst_of(result.table, "gradient"),
        worst_of(result.table, "gradient-improved"));
    return result;
}

}  // namespace palpate::evaluation
