// fidelity: how far the rendered force is from that of the true surface, and how much of the error
// comes from the linear pieces, how much from the 8 bits.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "evaluation/experiment.hpp"
#include "evaluation/fidelity/bodies.hpp"
#include "evaluation/fidelity/figure.hpp"
#include "evaluation/fidelity/trajectory.hpp"

namespace palpate::evaluation {
namespace {

/// What was measured of the incumbent on this protocol, on the 8-bit ball; given, not run here.
struct Incumbent {
    int grid;
    double mean, p99;  // angle between the rendered force and the true normal [deg]
    double update_us;  // median
};
constexpr std::array<Incumbent, 3> incumbents{
    {{128, 14, 34, 2.8}, {256, 11, 25, 10}, {512, 8, 19, 41}}};
constexpr const char* incumbent_name = "incumbent (measured)";
/// Not a method: where the whole 8-bit isosurface is nearest to the hand.
constexpr const char* nearest_name = "nearest point (reference)";

using MakeBody = std::function<Body()>;

/// One body at a time exists, for the largest takes half a gigabyte.
std::vector<MakeBody> bodies_of(const Options& options) {
    std::vector<MakeBody> bodies;
    for (const Subject& subject : options.subjects) {
        bodies.emplace_back([&subject] { return body_of(subject); });
    }
    if (!bodies.empty()) return bodies;
    using Maker = Body (*)(int, Samples);
    const auto add = [&](Maker maker, std::vector<int> grids) {
        for (const int grid : grids) {
            for (const Samples samples :
                 {Samples::uint8, Samples::smoothed, Samples::dequantized, Samples::float32}) {
                bodies.emplace_back([=] { return maker(grid, samples); });
            }
        }
    };
    if (options.quick) {
        add(ball_by_circle, {64, 128});
        add(torus_by_helix, {40, 80});
        add(ripples_by_spiral, {41, 81});
    } else {
        add(ball_by_circle, {128, 256, 512});
        add(ball_by_spiral, {128, 256, 512});
        add(torus_by_helix, {80, 160, 320});
        add(ripples_by_spiral, {41, 81, 161, 321});
    }
    return bodies;
}

void add_row(Table& table, const Body& body, const std::string& method, int steps,
             const TrajectoryResult& measured) {
    const double voxel = body.subject.field.geometry().spacing.minCoeff();
    table.add({{"body", body.subject.name},
               {"trajectory", body.trajectory},
               {"grid", double(body.grid)},
               {"samples", body.samples},
               {"method", method},
               {"steps", double(steps)},
               {"depth_voxel", body.depth / voxel},
               {"step_voxel", measured.step / voxel},
               {"contact_share", measured.contact_share},
               {"angle_mean_deg", measured.angle.mean},
               {"angle_p99_deg", measured.angle.p99},
               {"angle_max_deg", measured.angle.max},
               {"off_ideal_mean_deg", measured.off_ideal.mean},
               {"off_ideal_p99_deg", measured.off_ideal.p99},
               {"off_ideal_max_deg", measured.off_ideal.max},
               {"surface_error_mean_voxel", measured.surface_error.mean / voxel},
               {"surface_error_max_voxel", measured.surface_error.max / voxel},
               {"turn_mean_deg", measured.turn.mean},
               {"turn_p99_deg", measured.turn.p99},
               {"turn_max_deg", measured.turn.max},
               {"jump_p99_share", measured.jump.p99},
               {"jump_max_share", measured.jump.max},
               {"update_median_us", measured.update_us.median},
               {"worst_deviation_of_range", measured.worst_deviation}});
}

void add_incumbent(Table& table, int grid) {
    for (const Incumbent& known : incumbents) {
        if (known.grid != grid) continue;
        table.add({{"body", "ball"},
                   {"trajectory", "circle"},
                   {"grid", double(grid)},
                   {"samples", "uint8"},
                   {"method", incumbent_name},
                   {"steps", 20000.0},
                   {"depth_voxel", 0.03 * grid},
                   {"angle_mean_deg", known.mean},
                   {"angle_p99_deg", known.p99},
                   {"off_ideal_mean_deg", known.mean},
                   {"off_ideal_p99_deg", known.p99},
                   {"update_median_us", known.update_us}});
    }
}

/// Of the exact method or another: its rows on the ball.
Table ball_rows(const Table& table, const std::string& samples, const char* trajectory = "circle",
                const char* method = "exact") {
    return table.where("body", "ball")
        .where("trajectory", trajectory)
        .where("samples", samples)
        .where("method", method);
}

/// A number of one of them; NaN where that was not run.
double number_of(const Table& rows, const char* column, int grid) {
    const Table found = rows.where("grid", double(grid));
    return found.rows().empty() ? std::nan("") : found.number(0, column);
}

/// The grids on which the incumbent's numbers are known and ours are, too.
std::vector<Incumbent> rivals(const Table& table) {
    std::vector<Incumbent> met;
    for (const Incumbent& known : incumbents) {
        if (!ball_rows(table, "uint8").where("grid", double(known.grid)).rows().empty()) {
            met.push_back(known);
        }
    }
    return met;
}

/// Whether exact is below the incumbent in mean and p99, by the normal at the SCP and by the ideal
/// force, on every trajectory.
bool is_below(const Table& table, const Incumbent& known, const char* samples) {
    bool below = true;
    for (const char* trajectory : {"circle", "spiral"}) {
        const Table rows = ball_rows(table, samples, trajectory);
        const auto worse = [&](const char* column, double theirs) {
            return number_of(rows, column, known.grid) >= theirs;  // false for NaN
        };
        below &= !worse("angle_mean_deg", known.mean) && !worse("off_ideal_mean_deg", known.mean) &&
                 !worse("angle_p99_deg", known.p99) && !worse("off_ideal_p99_deg", known.p99);
    }
    return below;
}

/// "128 (4.3 against 14), 256 (...)": means, with the larger of the two angles.
std::string comparison(const Table& table, const std::vector<Incumbent>& grids,
                       const char* samples) {
    std::string text;
    const Table rows = ball_rows(table, samples);
    for (const Incumbent& known : grids) {
        text += fmt::format("{}{} ({:.2g} against {:g}, p99 {:.2g} against {:g})",
                            text.empty() ? "" : ", ", known.grid,
                            number_of(rows, "off_ideal_mean_deg", known.grid), known.mean,
                            number_of(rows, "off_ideal_p99_deg", known.grid), known.p99);
    }
    return text;
}

Claim stays_on_surface(const Table& table) {
    double worst = 0;
    for (const char* method : {"exact", "paper", "smooth"}) {
        const Table rows = table.where("method", method);
        worst = std::max(worst, largest(rows.numbers("worst_deviation_of_range")));
    }
    return {
        fmt::format("exact, paper and smooth stay on the sampled isosurface to {:g} of the data's "
                    "range",
                    granted),
        worst <= granted, fmt::format("largest deviation {:.2g}", worst)};
}

/// Twice the grid, half the angle: the facets of linear pieces, where nothing is rounded.
Claim converges(const Table& table, const std::string& body) {
    double last = std::nan(""), least = 1e9;
    int doublings = 0;
    const Table rows =
        table.where("body", body).where("samples", "float32").where("method", "exact");
    for (std::size_t i = 0; i < rows.rows().size(); ++i) {
        if (rows.text(i, "trajectory") == "spiral") continue;
        const double mean = rows.number(i, "angle_mean_deg");
        if (!std::isnan(last)) {
            least = std::min(least, last / mean);
            ++doublings;
        }
        last = mean;
    }
    return {fmt::format("{}, not rounded: the exact method's mean angle falls by at least 1.7 with "
                        "each doubling of the grid",
                        body),
            least >= 1.7, fmt::format("least factor {:.3g} over {} doublings", least, doublings)};
}

/// Of the smooth field on the ball, felt along the circle: the largest of a number over the grids
/// from 128 on.
double largest_of_smooth(const Table& table, const char* samples, const char* column) {
    double worst = 0;
    const Table rows = ball_rows(table, samples, "circle", "smooth");
    for (const auto& row : rows.rows_of({"grid", column})) {
        if (row[0] >= 128) worst = std::max(worst, row[1]);
    }
    return worst;
}

std::vector<Claim> claims_of_smooth(const Table& table, int steps) {
    const auto claim = [&](const std::string& what, const char* samples, const char* column,
                           double most) {
        const double worst = largest_of_smooth(table, samples, column);
        return Claim{fmt::format("ball, {}, smooth field: {} is at most {:.3g} degrees from grid "
                                 "128 on",
                                 samples, what, most),
                     worst <= most, fmt::format("largest {:.2g}", worst)};
    };
    return {
        claim("the mean angle", "float32", "off_ideal_mean_deg", 0.005),
        claim("the mean angle", "uint8 dequantized", "off_ideal_mean_deg", 0.03),
        claim("the 99th percentile of the angle", "uint8 dequantized", "off_ideal_p99_deg", 0.1),
        claim("the turn of the force in a tick, p99 (the ball's own and 10 %),", "float32",
              "turn_p99_deg", 1.1 * 360 / steps)};
}

std::vector<Claim> claims_of(const Table& table, bool own_bodies, int steps) {
    std::vector<Claim> claims{stays_on_surface(table)};
    if (!own_bodies) return claims;
    claims.push_back(converges(table, "ball"));
    claims.push_back(converges(table, "torus"));
    const std::vector<Incumbent> met = rivals(table);
    const auto all_below = [&](const char* samples, int largest) {
        return std::all_of(met.begin(), met.end(), [&](const Incumbent& known) {
            return known.grid > largest || is_below(table, known, samples);
        });
    };
    claims.push_back({"8-bit ball, grid 128: exact is below the incumbent in mean and p99 angle",
                      all_below("uint8", 128), comparison(table, {incumbents[0]}, "uint8")});
    claims.push_back(
        {"8-bit ball, smoothed once: exact is below the incumbent in mean and p99 angle "
         "on every grid",
         all_below("uint8 smoothed", 512), comparison(table, met, "uint8 smoothed")});
    for (Claim& claim : claims_of_smooth(table, steps)) claims.push_back(std::move(claim));
    return claims;
}

std::string against_incumbent(const Table& table) {
    std::vector<Incumbent> below, above;
    for (const Incumbent& known : rivals(table)) {
        (is_below(table, known, "uint8") ? below : above).push_back(known);
    }
    std::string text;
    if (!below.empty()) {
        text += fmt::format(" On the raw 8-bit samples exact is below the incumbent at grid {}.",
                            comparison(table, below, "uint8"));
    }
    if (!above.empty()) {
        std::string nearest;
        for (const Incumbent& known : above) {
            nearest += fmt::format("{}{:.2g}", nearest.empty() ? "" : " and ",
                                   number_of(ball_rows(table, "uint8", "circle", nearest_name),
                                             "off_ideal_mean_deg", known.grid));
        }
        text += fmt::format(
            " It is not at grid {}: there the ramp rises by at most 1.4 levels a voxel and the "
            "8-bit isosurface is a terrace. Its point nearest to the hand is off by {} on average; "
            "a proxy that only ever comes nearer rests in a dent before it gets there.",
            comparison(table, above, "uint8"), nearest);
    }
    return text;
}

/// "0.43 at grid 64, 0.21 at grid 128": the mean angles of a method.
std::string means_of(const Table& table, const char* method, const char* samples) {
    std::string text;
    for (const auto& row :
         ball_rows(table, samples, "circle", method).rows_of({"off_ideal_mean_deg", "grid"})) {
        text += fmt::format("{}{:.2g} at grid {:g}", text.empty() ? "" : ", ", row[0], row[1]);
    }
    return text;
}

std::string paragraph_of(const Table& table, int steps) {
    const std::vector<Incumbent> met = rivals(table);
    const int grid = incumbents.front().grid;
    const auto number = [&](const char* column, int at, const char* samples) {
        return number_of(ball_rows(table, samples), column, at);
    };
    return fmt::format(
        "A ball of radius 0.35 in a unit box, density 1/2 + 1.4 (0.35 - r) in 8 bits, felt at 1/2; "
        "a hand goes round it 0.03 below the surface on a tilted great circle in {} steps. Angle "
        "between the force and the direction that a perfect force would have, mean and p99 in "
        "degrees.{} How much of it is the linear pieces' shows where the samples are not rounded: "
        "their facets leave {} on average. On the smooth field (\"smooth\") the mean angle is {}; "
        "from 8-bit samples that were dequantized it is {}, from raw ones {}. One pass of "
        "smoothing over the 8-bit "
        "samples brings exact to: grid {}; the incumbent's are without smoothing. The SCP is off "
        "the true "
        "sphere by {:.2g} voxels on average where nothing is rounded, and by {:.2g} in 8 bits; "
        "from one tick to the next the force turns by at most {:.2g} degrees, and by {:.2g} in 8 "
        "bits (grid {}). On torus and Marschner-Lobb ripples the force is compared with the true "
        "normal at the SCP; ripples near the Nyquist limit need more than their classic 41 "
        "samples.",
        steps, against_incumbent(table), means_of(table, "exact", "float32"),
        means_of(table, "smooth", "float32"), means_of(table, "smooth", "uint8 dequantized"),
        means_of(table, "smooth", "uint8"), comparison(table, met, name_of(Samples::smoothed)),
        number("surface_error_mean_voxel", grid, "float32"),
        number("surface_error_mean_voxel", grid, "uint8"), number("turn_max_deg", grid, "float32"),
        number("turn_max_deg", grid, "uint8"), grid);
}

std::string paragraph_of_users(const Table& table) {
    std::string text =
        "A hand goes round each of the user's volumes, 0.03 of the shortest axis below the "
        "surface. How much the force of the exact method turns from one tick to the next on the "
        "linear field (exact) and on the smooth one (smooth), p99 and at most:";
    for (std::size_t i = 0; i < table.rows().size(); ++i) {
        const std::string& method = table.text(i, "method");
        if (method != "exact" && method != "smooth") continue;
        text += fmt::format(" {} ({}) {:.2g} and {:.2g} degrees", table.text(i, "body"), method,
                            table.number(i, "turn_p99_deg"), table.number(i, "turn_max_deg"));
        const double angle = table.number(i, "angle_mean_deg");
        text += std::isnan(angle)
                    ? std::string(";")
                    : fmt::format(", {:.2g} degrees from the true normal on average;", angle);
    }
    text.back() = '.';
    return text;
}

}  // namespace

Result fidelity(const Options& options) {
    const int steps = options.quick ? 1500 : 20000;
    const bool own_bodies = options.subjects.empty();
    Result result;
    const std::vector<MakeBody> bodies = bodies_of(options);
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        options.progress(double(i) / double(bodies.size()));
        const Body body = bodies[i]();
        const bool is_protocol = own_bodies && body.subject.name == "ball" &&
                                 body.trajectory == "circle" &&
                                 body.samples == name_of(Samples::uint8);
        for (const Contestant& contestant : contestants()) {
            options.progress(double(i) / double(bodies.size()));
            add_row(result.table, body, contestant.name, steps,
                    follow(body, contestant, steps, 0, 1));
        }
        if (!is_protocol) continue;
        const int hands = options.quick ? 20 : 100;  // each looks at the whole surface
        add_row(result.table, body, nearest_name, hands, follow_nearest(body, hands));
        add_incumbent(result.table, body.grid);
    }
    if (own_bodies) {
        result.figures = fidelity_figures(result.table, options.quick ? 64 : 128);
        result.paragraph = paragraph_of(result.table, steps);
    } else {
        result.figures = {fidelity_figure_of_users(result.table)};
        result.paragraph = paragraph_of_users(result.table);
    }
    result.claims = claims_of(result.table, own_bodies, steps);
    return result;
}

}  // namespace palpate::evaluation
