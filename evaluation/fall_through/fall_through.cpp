// fall-through: a hand moves straight through thin walls at all speeds; does the proxy end inside?
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <thread>

#include "evaluation/contestants.hpp"
#include "evaluation/experiment.hpp"
#include "evaluation/fall_through/crossing.hpp"
#include "evaluation/fall_through/figure.hpp"
#include "evaluation/fall_through/shell.hpp"
#include "scenes/random.hpp"

namespace palpate::evaluation {
namespace {

struct Plan {
    std::vector<double> thicknesses;  // [voxel]
    std::vector<double> speeds;       // [mm/s]
    std::vector<double> rates;        // [Hz]
    std::size_t crossings;            // in each cell
};

/// A subject and the lines through it, the same for every method, speed and rate.
struct Wall {
    Subject subject;
    Outside outside;
    std::vector<Crossing> crossings;

    Wall(Subject s, Target target, std::size_t count, const Options& options)
        : subject(std::move(s)),
          outside(subject.field, subject.isovalue, [&] { options.progress(0); }),
          crossings(draw_crossings(subject, outside, target, count, options.seed)) {}
};

/// The walls of one row of the figure.
struct Row {
    std::string name;  // as the table has it
    double thickness;  // [voxel]; NaN for a volume of the user
    std::vector<Wall> walls;
    std::vector<Wall> smooth;  // as thick, on the smooth field; none for a volume of the user

    const std::vector<Wall>& walls_for(const Contestant& contestant) const {
        return contestant.interpolation == Interpolation::cubic ? smooth : walls;
    }
};

/// The median path in the solid [voxel]; NaN where most crossings end in it.
double median_wall(const Wall& wall) {
    std::vector<double> lengths;
    for (const Crossing& crossing : wall.crossings) lengths.push_back(crossing.wall);
    const double median = quantile(std::move(lengths), 0.5);
    if (std::isinf(median)) return std::nan("");
    return median / wall.subject.field.geometry().spacing.minCoeff();
}

std::vector<Row> rows_of(const Options& options, const Plan& plan) {
    std::vector<Row> rows;
    for (const Subject& subject : options.subjects) {
        const auto namesakes =
            std::count_if(options.subjects.begin(), options.subjects.end(),
                          [&](const Subject& other) { return other.name == subject.name; });
        const std::string level =
            namesakes > 1 ? fmt::format(" at {:g}", subject.isovalue) : std::string();
        Row row{subject.name + level, std::nan(""), {}, {}};
        row.walls.emplace_back(subject, Target::anywhere, plan.crossings, options);
        rows.push_back(std::move(row));
    }
    if (!rows.empty()) return rows;
    for (const double thickness : plan.thicknesses) {
        Row row{"box and ball", thickness, {}, {}};
        for (const Enclosed enclosed : {Enclosed::box, Enclosed::ball}) {
            const auto add = [&](std::vector<Wall>& walls, Interpolation interpolation) {
                walls.emplace_back(closed_shell(enclosed, thickness, interpolation),
                                   Target::behind_walls, plan.crossings / 2, options);
            };
            add(row.walls, Interpolation::linear);
            add(row.smooth, Interpolation::cubic);
        }
        rows.push_back(std::move(row));
    }
    return rows;
}

/// One of the table's rows: all lines through the walls of a row, at one speed and rate.
struct Case {
    const Row& row;
    const Contestant& contestant;
    double speed, rate;
};

/// Sums over crossings.
struct Shares {
    double crossings = 0, inside = 0, pressed = 0, inside_pressed = 0, unfelt = 0, ticks = 0;
    double worst = 0;

    Shares() = default;
    explicit Shares(const Passage& p)
        : crossings(1),
          inside(p.inside),
          pressed(p.pressed),
          inside_pressed(p.inside_pressed),
          unfelt(!p.felt),
          ticks(p.ticks),
          worst(p.worst) {}
    void add(const Shares& other) {
        crossings += other.crossings;
        inside += other.inside;
        pressed += other.pressed;
        inside_pressed += other.inside_pressed;
        unfelt += other.unfelt;
        ticks += other.ticks;
        worst = std::max(worst, other.worst);
    }
};

/// All lines through one wall, spread over the processors: all sums are of whole numbers, so their
/// order does not matter. `alive` is called in between and may throw.
Shares go_through(const Wall& wall, const Case& c, scenes::Random& random,
                  const std::function<void()>& alive) {
    constexpr std::size_t batch = 1000;
    const double step = c.speed / c.rate;
    std::vector<double> phases;
    for (std::size_t i = 0; i < wall.crossings.size(); ++i) phases.push_back(1 - random.uniform());
    const std::size_t threads = std::clamp(std::thread::hardware_concurrency(), 1U, 16U);
    Shares shares;
    for (std::size_t first = 0; first < phases.size(); first += batch) {
        alive();
        const std::size_t last = std::min(first + batch, phases.size());
        std::vector<Shares> parts(threads);
        {
            std::vector<std::jthread> running;
            for (std::size_t t = 0; t < threads; ++t) {
                running.emplace_back([&, t] {
                    for (std::size_t i = first + t; i < last; i += threads) {
                        parts[t].add(Shares(cross(wall.subject, wall.outside, wall.crossings[i],
                                                  c.contestant.method, step, phases[i])));
                    }
                });
            }
        }
        for (const Shares& part : parts) shares.add(part);
    }
    return shares;
}

Shares go_through(const Case& c, std::uint64_t seed, const std::function<void()>& alive) {
    scenes::Random random(seed);
    Shares shares;
    for (const Wall& wall : c.row.walls_for(c.contestant))
        shares.add(go_through(wall, c, random, alive));
    return shares;
}

/// How long a case takes, about: ticks of one crossing.
double effort(const Plan& plan, double speed, double rate) {
    return double(plan.crossings) * (4 + 4 * rate / speed);
}

Table measured(const std::vector<Row>& rows, const Plan& plan, const Options& options) {
    Table table;
    double total = 0, done = 0;
    for (const double speed : plan.speeds) {
        for (const double rate : plan.rates) total += effort(plan, speed, rate);
    }
    total *= double(rows.size() * contestants().size());
    std::uint64_t cell = 0;
    for (const Row& row : rows) {
        for (const double speed : plan.speeds) {
            for (const double rate : plan.rates) {
                ++cell;  // every method meets the same phases
                for (const Contestant& contestant : contestants()) {
                    const std::vector<Wall>& walls = row.walls_for(contestant);
                    if (walls.empty()) continue;
                    double path = 0;
                    for (const Wall& wall : walls) path += median_wall(wall) / double(walls.size());
                    const Shares shares =
                        go_through({row, contestant, speed, rate}, options.seed + 1000 * cell,
                                   [&] { options.progress(std::min(1.0, done / total)); });
                    done += effort(plan, speed, rate);
                    const double crossings = shares.crossings;
                    table.add({{"wall", row.name},
                               {"thickness_voxel", row.thickness},
                               {"median_path_in_wall_voxel", path},
                               {"method", contestant.name},
                               {"speed_mm_s", speed},
                               {"rate_hz", rate},
                               {"step_mm", speed / rate},
                               {"crossings", crossings},
                               {"inside_share", shares.inside / crossings},
                               {"pressed_share", shares.pressed / crossings},
                               {"inside_while_pressed_share",
                                shares.pressed > 0 ? shares.inside_pressed / shares.pressed
                                                   : std::nan("")},
                               {"unfelt_share", shares.unfelt / crossings},
                               {"worst_excess_of_range", shares.worst},
                               {"ticks_per_crossing", shares.ticks / crossings}});
                }
            }
        }
    }
    return table;
}

double most(const Table& table, const std::string& method, const std::string& column) {
    return largest(table.where("method", method).numbers(column));
}
double least(const Table& table, const std::string& method, const std::string& column) {
    return smallest(table.where("method", method).numbers(column), 1);
}

/// Whether nothing inside any of the walls can be reached, by the flood from outside.
bool are_closed(const std::vector<Row>& rows) {
    return std::all_of(rows.begin(), rows.end(), [](const Row& row) {
        return std::none_of(row.walls.begin(), row.walls.end(), [](const Wall& wall) {
            return wall.outside.holds(physical_centre(wall.subject.field.geometry()));
        });
    });
}

std::vector<Claim> claims_of(const Table& table, const std::vector<Row>& rows, bool own_walls) {
    std::vector<Claim> claims;
    for (const char* method : {"exact", "paper", "smooth"}) {
        const auto counts = table.where("method", method).numbers("crossings");
        if (counts.empty()) continue;
        const double crossings = std::accumulate(counts.begin(), counts.end(), 0.0);
        const double inside = most(table, method, "inside_share");
        claims.push_back(
            {fmt::format("{} never ends inside, in any of the crossings", method), inside == 0,
             fmt::format("largest share {:g} over {:.0f} crossings", inside, crossings)});
        const double worst = most(table, method, "worst_excess_of_range");
        claims.push_back({fmt::format("{} is never in the solid by more than {:g} of the data's "
                                      "range, in any tick",
                                      method, granted),
                          worst <= granted, fmt::format("largest {:.2g}", worst)});
    }
    if (!own_walls) return claims;
    claims.push_back({"the walls are closed: no free path through the lattice leads in",
                      are_closed(rows), fmt::format("{} thicknesses, two shapes", rows.size())});
    for (const char* method : {"gradient", "gradient-improved"}) {
        const double inside = least(table, method, "inside_share");
        claims.push_back({fmt::format("{} ends inside in every crossing", method), inside == 1,
                          fmt::format("smallest share {:g}", inside)});
    }
    return claims;
}

std::string paragraph_of(const Table& table, const Plan& plan, bool own_walls) {
    const auto every = [&](const char* column) {
        std::string text;
        for (const std::string& method : table.distinct("method")) {
            text +=
                fmt::format("{}{} {:.3g} to {:.3g} %", text.empty() ? "" : ", ", method,
                            100 * least(table, method, column), 100 * most(table, method, column));
        }
        return text;
    };
    return fmt::format(
        "{} The hand moves at {:g} to {:g} mm/s and {:g} to {:g} Hz, {} crossings a cell. It "
        "starts a random part of a step before the surface, because ticks in free space decide "
        "nothing, and rests for a tick at the end. The proxy is inside if it is in the solid by "
        "more than a hundredth of the data's range, or where no free path leads from outside: that "
        "is decided on the lattice's connectivity, exactly. Ends inside, from the best cell to the "
        "worst: {}. Is inside when the hand is still in the solid: {}. Touches nothing in any "
        "tick, "
        "so that the wall is not felt at all: {}. exact and paper look at the whole step of a "
        "tick. "
        "The gradient methods look at the density where the hand is: if it is free there, they "
        "take the hand to be free, on whichever side.",
        own_walls
            ? "A hand goes straight through closed shells, a flat one (box) and a stepped one "
              "(ball of voxels), on random lines, to 3 voxels or 50 ticks behind the wall. "
              "The shells are layers of full samples, and the level sets their thickness on "
              "each flat face; a ramp sampled thinner than a voxel would have real holes. "
              "\"smooth\" "
              "is the exact method on the smooth field, on walls as thick there."
            : "A hand goes straight into the user's volumes on random lines, to behind the "
              "wall where it cannot be reached otherwise, else into the solid.",
        plan.speeds.front(), plan.speeds.back(), plan.rates.front(), plan.rates.back(),
        plan.crossings, every("inside_share"), every("inside_while_pressed_share"),
        every("unfelt_share"));
}

}  // namespace

Result fall_through(const Options& options) {
    const Plan plan = options.quick ? Plan{{2, 0.5, 0.25}, {10, 100, 1e4}, {100, 1000}, 60}
                                    : Plan{{3, 2, 1.5, 1, 0.75, 0.5, 0.25},
                                           {10, 100, 500, 1000, 2000, 5000, 1e4},
                                           {100, 250, 1000, 4000},
                                           10000};
    const bool own_walls = options.subjects.empty();
    const std::vector<Row> rows = rows_of(options, plan);
    Result result;
    result.table = measured(rows, plan, options);
    result.figures = fall_through_figures(result.table);
    result.claims = claims_of(result.table, rows, own_walls);
    result.paragraph = paragraph_of(result.table, plan, own_walls);
    return result;
}

}  // namespace palpate::evaluation
