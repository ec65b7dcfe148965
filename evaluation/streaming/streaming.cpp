// streaming: hands go through a volume of 1.9 TB that is read as it is felt; how often they wait.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "evaluation/experiment.hpp"
#include "evaluation/streaming/stroke.hpp"

namespace palpate::evaluation {
namespace {

struct Plan {
    std::vector<double> latencies;  // [ms]
    std::vector<double> speeds;     // [mm/s]
    double seconds;                 // of a stroke
    double rate;                    // [Hz]
};

constexpr double failures = 0.05;  // of the requests of a network
constexpr std::uint64_t memory = 128'000'000;
constexpr double voxels_per_mm = 1 / ball_voxel;

constexpr const char* finest = "finest level";
constexpr const char* coarse_first = "coarse first";

double share(std::int64_t count, std::int64_t of) {
    return static_cast<double>(count) / static_cast<double>(std::max<std::int64_t>(1, of));
}

/// NaN for what did not happen.
double known(double value, double least) {
    return value < least ? std::nan("") : value;
}

void add(Table& table, const Stroke& stroke, const StrokeResult& felt) {
    table.add({{"levels", stroke.coarse_first ? coarse_first : finest},
               {"latency_ms", 1e3 * stroke.network.latency_s},
               {"speed_voxel_s", stroke.speed * voxels_per_mm},
               {"ticks", double(felt.ticks)},
               {"touching_share", share(felt.touching, felt.ticks)},
               {"waiting_share", share(felt.waiting, felt.ticks)},
               {"coarse_share", share(felt.coarse, felt.ticks)},
               {"deepest_voxel", known(felt.deepest, -1e8)},
               {"beyond_allowed_voxel", known(felt.beyond, -1e8)},
               {"first_contact_s", known(felt.first_contact_s, 0)},
               {"most_mb", 1e-6 * double(felt.most_bytes)},
               {"requests", double(felt.traffic.requests)},
               {"retries", double(felt.traffic.retries)},
               {"read_mb", 1e-6 * double(felt.traffic.bytes)}});
}

/// A line for each latency, against the hand's speed.
Panel panel_of(const Table& table, const Plan& plan, const char* levels, const char* column,
               double factor) {
    Panel panel;
    panel.title = levels;
    panel.x = {.title = "speed of the hand [voxel/s]",
               .is_logarithmic = true,
               .low = 0.7 * voxels_per_mm * plan.speeds.front(),
               .high = 1.4 * voxels_per_mm * plan.speeds.back()};
    const Table shown = table.where("levels", levels);
    for (std::size_t i = 0; i < plan.latencies.size(); ++i) {
        Rows rows = shown.where("latency_ms", plan.latencies[i]).rows_of({"speed_voxel_s", column});
        for (auto& row : rows) row[1] *= factor;
        panel.add(Draw::line_points, fmt::format("{:g} ms a request", plan.latencies[i]),
                  look_of(i), rows);
    }
    return panel;
}

std::vector<Figure> figures_of(const Table& table, const Plan& plan) {
    Figure waiting;
    waiting.caption =
        "Ticks that wait for samples, against the hand's speed, for four latencies of the network. "
        "Left: only the finest level is felt. Right: a coarser one where it has not come or the "
        "hand is too fast for it.";
    waiting.columns = 2;
    Figure traffic;
    traffic.suffix = "traffic";
    traffic.caption =
        "Samples read in a stroke (above) and the most memory that bricks and decoded pieces took "
        "(below), with the bound as a dotted line.";
    traffic.columns = 2;
    traffic.height = 900;
    for (const char* levels : {finest, coarse_first}) {
        Panel panel = panel_of(table, plan, levels, "waiting_share", 100);
        panel.y = {.title = "ticks that wait [%]", .low = 0, .high = 100};
        waiting.panels.push_back(panel);
        Panel read = panel_of(table, plan, levels, "read_mb", 1);
        read.y = {.title = "read [MB]", .low = 0};
        traffic.panels.push_back(read);
    }
    for (const char* levels : {finest, coarse_first}) {
        Panel held = panel_of(table, plan, levels, "most_mb", 1);
        held.y = {.title = "memory [MB]", .low = 0, .high = 1.25e-6 * double(memory)};
        held.add_level(1e-6 * double(memory), "bound",
                       {.colour = colours::grey, .dash = Dash::dotted});
        traffic.panels.push_back(held);
    }
    return {waiting, traffic};
}

/// Ticks that wait [%], a row for each latency.
Table summary_of(const Table& table, const Plan& plan) {
    Table summary;
    for (const char* levels : {finest, coarse_first}) {
        for (const double latency : plan.latencies) {
            std::vector<NamedCell> row{{"levels", levels}, {"request [ms]", latency}};
            const Table shown = table.where("levels", levels).where("latency_ms", latency);
            for (const double speed : plan.speeds) {
                const double waiting =
                    shown.where("speed_voxel_s", speed * voxels_per_mm).number(0, "waiting_share");
                row.emplace_back(fmt::format("waits at {:g} voxel/s [%]", speed * voxels_per_mm),
                                 std::round(1000 * waiting) / 10);
            }
            summary.add(row);
        }
    }
    return summary;
}

std::vector<Claim> claims_of(const Table& table) {
    const double beyond = largest(table.numbers("beyond_allowed_voxel"));
    const double most = largest(table.numbers("most_mb"));
    double ticks = 0;
    for (const double one : table.numbers("ticks")) ticks += one;
    return {
        {"no point of the proxy's path lies in a ball deeper than the samples' rounding and the "
         "interpolation at the level felt may take",
         beyond <= 0, fmt::format("at most {:.2f} voxel beyond, {:.0f} ticks", beyond, ticks)},
        {"bricks and decoded pieces never take more memory than they may",
         most <= 1e-6 * double(memory),
         fmt::format("at most {:.1f} of {:.0f} MB", most, 1e-6 * double(memory))}};
}

double of(const Table& table, const char* levels, double latency, double speed,
          const char* column) {
    return table.where("levels", levels)
        .where("latency_ms", latency)
        .where("speed_voxel_s", speed)
        .number(0, column);
}

std::string paragraph_of(const Table& table, const Plan& plan) {
    const double slowest = plan.speeds.front() * voxels_per_mm, latency = plan.latencies.back();
    const double fastest = plan.speeds.back() * voxels_per_mm;
    double contact = 0;
    for (const double one : table.where("latency_ms", latency)
                                .where("speed_voxel_s", fastest)
                                .numbers("first_contact_s")) {
        if (std::isfinite(one)) contact = std::max(contact, one);
    }
    return fmt::format(
        "A hand goes to and fro through a row of balls of 256 voxels in a volume of 12288^3 "
        "samples, which are computed when they are asked for, after the latency of a network that "
        "fails in {:.0f} % of the requests. It starts with nothing in memory; bricks and pieces "
        "may take {:.0f} MB. At {:g} ms a request and {:g} voxel/s, {:.0f} % of the ticks wait for "
        "samples where only the finest level is felt, and {:.0f} % where coarser ones are allowed; "
        "at {:g} voxel/s {:.0f} and {:.0f} %. The first contact at that speed came within {:.1f} s "
        "of opening the store.",
        100 * failures, 1e-6 * double(memory), latency, slowest,
        100 * of(table, finest, latency, slowest, "waiting_share"),
        100 * of(table, coarse_first, latency, slowest, "waiting_share"), fastest,
        100 * of(table, finest, latency, fastest, "waiting_share"),
        100 * of(table, coarse_first, latency, fastest, "waiting_share"), contact);
}

}  // namespace

Result streaming(const Options& options) {
    if (!options.subjects.empty()) {
        throw std::invalid_argument("streaming: has a volume of its own; leave --volume out");
    }
    const Plan plan = options.quick ? Plan{{0, 50}, {0.3, 3}, 1.5, 1000}
                                    : Plan{{0, 20, 100, 200}, {0.1, 0.3, 1, 5, 20}, 10, 2500};
    Result result;
    const double strokes = 2.0 * double(plan.latencies.size() * plan.speeds.size());
    double done = 0;
    for (const bool coarse : {false, true}) {
        for (const double latency : plan.latencies) {
            for (const double speed : plan.speeds) {
                const Stroke stroke{.network = {1e-3 * latency, latency > 0 ? failures : 0},
                                    .speed = speed,
                                    .coarse_first = coarse,
                                    .seconds = plan.seconds,
                                    .rate = plan.rate,
                                    .memory = memory,
                                    .seed = options.seed};
                add(result.table, stroke, feel(stroke, [&] { options.progress(done / strokes); }));
                done += 1;
            }
        }
    }
    result.summary = summary_of(result.table, plan);
    result.figures = figures_of(result.table, plan);
    result.claims = claims_of(result.table);
    result.paragraph = paragraph_of(result.table, plan);
    return result;
}

}  // namespace palpate::evaluation
