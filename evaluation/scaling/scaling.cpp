// scaling: what the cost of an update grows with, and what it does not; and the explicit way, which
// extracts the whole isosurface first.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <map>

#include "evaluation/experiment.hpp"
#include "evaluation/scaling/bodies.hpp"
#include "evaluation/scaling/explicit.hpp"
#include "evaluation/scaling/figure.hpp"
#include "evaluation/scaling/report.hpp"
#include "evaluation/timing.hpp"
#include "palpate/renderer.hpp"

namespace palpate::evaluation {
namespace {

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
struct Plan {
    int ticks;
    int passes;
    std::vector<double> speeds;         // [mm/s]
    std::vector<double> voxels_per_mm;  // of hand
    std::vector<int> sizes;             // samples along an edge
    std::vector<double> noises;         // of the density's range
    std::vector<int> explicit_sizes;
    std::vector<const char*> real;
};

Plan plan_of(bool quick) {
    if (quick) {
        return {1500, 3, {20, 100, 500}, {0.5, 2}, {64, 80, 128}, {0, 0.1, 1}, {32, 64}, {}};
    }
    return {20000,
            5,
            {5, 10, 20, 50, 100, 200, 500, 1000, 2000},
            {0.25, 0.5, 1, 2, 3, 4, 6, 8},
            {64, 128, 256, 512, 768, 1024},
            {0, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1},
            {64, 128, 256, 512, 1024},
            {"lobster", "ct-head"}};
}

/// Adds a row with the cells that are given; the others are empty.
void add(Table& table, const std::map<std::string, Cell>& cells) {
    std::vector<Cell> row;
    for (const std::string& column : table.columns()) {
        const auto cell = cells.find(column);
        const bool is_text = column == "part" || column == "volume" || column == "size";
        row.push_back(cell != cells.end() ? cell->second
                      : is_text           ? Cell(std::string())
                                          : Cell(unknown));
    }
    table.add(std::move(row));
}

std::map<std::string, Cell> cells_of(const Subject& subject, const char* part) {
    const Geometry& geometry = subject.field.geometry();
    return {{"part", part},
            {"volume", subject.name},
            {"size", fmt::format("{}x{}x{}", geometry.size[0], geometry.size[1], geometry.size[2])},
            {"samples", double(sample_count(geometry))}};
}

/// Way of the hand [voxel, smallest spacing].
double way_of(const Subject& subject, const std::vector<Stroke>& strokes) {
    double way = 0;
    for (const Stroke& stroke : strokes) {
        for (std::size_t i = 1; i < stroke.size(); ++i) way += (stroke[i] - stroke[i - 1]).norm();
    }
    return way / subject.field.geometry().spacing.minCoeff();
}

void add_times(std::map<std::string, Cell> cells, const Subject& subject,
               const std::vector<Stroke>& strokes, int passes, Table& table) {
    const UpdateTimes times = time_updates(subject, &update_exact, strokes, {passes, 0});
    const auto updates = static_cast<double>(times.updates);
    cells["updates"] = updates;
    cells["mean_ns"] = times.mean_ns;
    cells["p50_ns"] = times.p50_ns;
    cells["p99_ns"] = times.p99_ns;
    cells["p999_ns"] = times.p999_ns;
    cells["max_ns"] = times.max_ns;
    cells["tetrahedra"] = double(times.tetrahedra);
    cells["tetrahedra_per_update"] = double(times.tetrahedra) / updates;
    cells["way_voxel"] = way_of(subject, strokes);
    cells["constrained_share"] = double(times.constrained) / updates;
    add(table, cells);
}

/// Round a ball at a depth, both as long as they are in voxels.
std::vector<Stroke> round(const Ball& shape, double depth, double step, int ticks) {
    return {round_the_ball(shape.radius - depth, step, ticks, shape.radius + 1)};
}

/// A hand on any body that hardly ever leaves it.
std::vector<Stroke> over(const Subject& subject, double speed, double voxels_per_mm, int ticks,
                         std::uint64_t seed) {
    const double scale = scale_for_voxels_per_mm(subject.field.geometry(), voxels_per_mm);
    HandAtWork hand;
    hand.speed_mm_s = speed * scale;
    hand.depth_mm = usual.depth_mm * scale;
    hand.touching = 0.95;
    hand.strokes = 4;
    hand.stroke_s = ticks / usual.rate_hz / hand.strokes;
    hand.seed = seed;
    return work(subject, hand);
}

constexpr double step_of(double speed, double voxels_per_mm) {
    return speed / usual.rate_hz * voxels_per_mm;
}

/// Whether there is room for so many times the samples of a cube; if not, says what is left out.
bool has_room(int size, double copies, const char* what, const Options& options) {
    std::ifstream file("/proc/meminfo");
    const double needed = copies * std::pow(double(size), 3);
    double kibibytes = 0;
    for (std::string word; file >> word;) {
        if (word != "MemAvailable:") continue;
        if (!(file >> kibibytes) || 1024 * kibibytes > needed) return true;
        options.note(fmt::format("scaling: {} at {}^3 left out, which takes {:.1f} GB of memory",
                                 what, size, 1e-9 * needed));
        return false;
    }
    return true;  // the system does not tell
}

/// What is going on, for progress between the cases of all parts.
class Course {
  public:
    Course(const Options& options, std::size_t cases) : options_(options), cases_(cases) {}
    void next() { options_.progress(double(done_++) / double(cases_)); }
    void wait() const { options_.progress(double(done_ - 1) / double(cases_)); }

  private:
    const Options& options_;
    std::size_t cases_;
    std::size_t done_ = 0;
};

void by_hand(const Plan& plan, const Options& options, Course& course, Table& table) {
    const auto measure = [&](const char* part, const Subject& subject, double speed, double voxels,
                             const std::vector<Stroke>& strokes) {
        auto cells = cells_of(subject, part);
        cells["speed_mm_s"] = speed;
        cells["voxels_per_mm"] = voxels;
        add_times(std::move(cells), subject, strokes, plan.passes, table);
    };
    const Ball same;
    const Subject body = ball(same);
    for (const double speed : plan.speeds) {
        course.next();
        for (const Subject& own : options.subjects) {
            measure("speed", own, speed, usual.voxels_per_mm,
                    over(own, speed, usual.voxels_per_mm, plan.ticks, options.seed));
        }
        if (!options.subjects.empty()) continue;
        measure("speed", body, speed, usual.voxels_per_mm,
                round(same, usual.depth_mm * usual.voxels_per_mm,
                      step_of(speed, usual.voxels_per_mm), plan.ticks));
    }
    for (const double voxels : plan.voxels_per_mm) {
        course.next();
        for (const Subject& own : options.subjects) {
            measure("voxels-per-mm", own, usual.speed_mm_s, voxels,
                    over(own, usual.speed_mm_s, voxels, plan.ticks, options.seed));
        }
        if (!options.subjects.empty()) continue;
        // The same ball of 20 mm in the hand, sampled ever more finely.
        const Ball shape{2 * static_cast<int>(23 * voxels + 6), 20 * voxels, 6 * voxels};
        measure(
            "voxels-per-mm", ball(shape), usual.speed_mm_s, voxels,
            round(shape, usual.depth_mm * voxels, step_of(usual.speed_mm_s, voxels), plan.ticks));
    }
}

void by_body(const Plan& plan, const Options& options, Course& course, Table& table) {
    const Ball same;
    const auto strokes = round(same, usual.depth_mm * usual.voxels_per_mm,
                               step_of(usual.speed_mm_s, usual.voxels_per_mm), plan.ticks);
    for (const int size : plan.sizes) {
        course.next();
        if (!has_room(size, 1.2, "the volume", options)) continue;
        Ball shape = same;
        shape.size = size;
        const Subject subject = ball(shape);
        add_times(cells_of(subject, "size"), subject, strokes, plan.passes, table);
    }
    for (const double noise : plan.noises) {
        course.next();
        const Subject subject = noisy_ball(same, noise, options.seed);
        auto cells = cells_of(subject, "noise");
        cells["noise_of_range"] = noise;
        add_times(std::move(cells), subject, strokes, plan.passes, table);
    }
}

/// Both ways on one volume; without the explicit one, and a note, if it cannot be gone.
void compare(const Subject& subject, const std::vector<Stroke>& strokes, int passes,
             const Options& options, Course& course, Table& table) {
    constexpr std::size_t most_segments = 4000;
    constexpr int repeats = 3;  // of which the fastest counts
    auto cells = cells_of(subject, "explicit");
    const auto segments = segments_of(subject, strokes, most_segments);
    const DynamicCost ours = dynamic_cost(subject, strokes, segments, passes);
    cells["mean_ns"] = ours.update_ns;
    cells["segment_ns"] = ours.segment_ns;
    cells["change_p50_ns"] = ours.change_p50_ns;
    cells["change_p99_ns"] = ours.change_p99_ns;
    cells["change_max_ns"] = ours.change_max_ns;
    cells["changes"] = double(ours.changes);
    cells["unfinished_changes"] = double(ours.unfinished_changes);
    cells["worst_deviation_of_range"] = ours.worst_deviation;
    cells["state_bytes"] = ours.state_bytes;
    cells["heap_growth_bytes"] = ours.heap_growth_bytes;
    cells["samples_bytes"] = double(subject.field.volume().bytes());
    const ExplicitAnswer theirs = explicit_cost(subject, segments, repeats, [&] { course.wait(); });
    if (!theirs.failure.empty()) {
        options.note("scaling: without the explicit way on " + subject.name + ": " +
                     theirs.failure);
    } else {
        const ExplicitCost& cost = theirs.cost;
        cells["explicit_triangles"] = double(cost.triangles);
        cells["explicit_extraction_s"] = cost.extraction_s;
        cells["explicit_tree_s"] = cost.tree_s;
        cells["explicit_cpu_s"] = cost.cpu_s;
        cells["explicit_mesh_bytes"] = cost.mesh_bytes;
        cells["explicit_tree_bytes"] = cost.tree_bytes;
        cells["explicit_peak_bytes"] = cost.peak_bytes;
        cells["explicit_segment_ns"] = cost.query_ns;
        const Difference difference = difference_of(subject, segments, theirs.hits);
        cells["one_sided_hits_share"] = difference.one_sided_share;
        cells["hit_difference_voxel"] = difference.worst_voxel;
    }
    add(table, cells);
}

void by_way(const Plan& plan, const Options& options, Course& course, Table& table) {
    for (const Subject& own : options.subjects) {
        course.next();
        const auto strokes =
            over(own, usual.speed_mm_s, usual.voxels_per_mm, plan.ticks, options.seed);
        compare(own, strokes, plan.passes, options, course, table);
    }
    if (!options.subjects.empty()) return;
    for (const int size : plan.explicit_sizes) {
        course.next();
        // Ours, the one that is shared, and what extraction takes at its peak.
        if (!has_room(size, 3.6, "the explicit way", options)) continue;
        // Grows with the grid, with the blur of its edge in voxels as a scanner has it.
        const Ball shape{size, 0.35 * size, 16};
        const auto strokes =
            round(shape, 3, step_of(usual.speed_mm_s, usual.voxels_per_mm), plan.ticks);
        compare(ball(shape), strokes, plan.passes, options, course, table);
    }
    for (const char* name : plan.real) {
        course.next();
        const auto subject = real(options.data, name);
        if (!subject) {
            options.note(fmt::format(
                "scaling: without {} (--data FOLDER says where the real volumes are)", name));
            continue;
        }
        compare(*subject,
                over(*subject, usual.speed_mm_s, usual.voxels_per_mm, plan.ticks, options.seed),
                plan.passes, options, course, table);
    }
}

Table empty_table() {
    return Table({"part",
                  "volume",
                  "size",
                  "samples",
                  "samples_bytes",
                  "speed_mm_s",
                  "voxels_per_mm",
                  "noise_of_range",
                  "updates",
                  "way_voxel",
                  "constrained_share",
                  "tetrahedra",
                  "tetrahedra_per_update",
                  "mean_ns",
                  "p50_ns",
                  "p99_ns",
                  "p999_ns",
                  "max_ns",
                  "segment_ns",
                  "change_p50_ns",
                  "change_p99_ns",
                  "change_max_ns",
                  "changes",
                  "unfinished_changes",
                  "worst_deviation_of_range",
                  "state_bytes",
                  "heap_growth_bytes",
                  "explicit_triangles",
                  "explicit_extraction_s",
                  "explicit_tree_s",
                  "explicit_cpu_s",
                  "explicit_mesh_bytes",
                  "explicit_tree_bytes",
                  "explicit_peak_bytes",
                  "explicit_segment_ns",
                  "one_sided_hits_share",
                  "hit_difference_voxel"});
}

}  // namespace

Result scaling(const Options& options) {
    const Plan plan = plan_of(options.quick);
    const bool own_volumes = options.subjects.empty();
    if (!own_volumes) {
        options.note(
            "scaling: a given volume has one size and its own noise: those parts are left "
            "out");
    }
    const std::size_t cases = plan.speeds.size() + plan.voxels_per_mm.size() +
                              (own_volumes ? plan.sizes.size() + plan.noises.size() +
                                                 plan.explicit_sizes.size() + plan.real.size()
                                           : options.subjects.size());
    Course course(options, cases);
    Result result;
    result.table = empty_table();
    by_hand(plan, options, course, result.table);
    if (own_volumes) by_body(plan, options, course, result.table);
    by_way(plan, options, course, result.table);
    result.figures = scaling_figures(result.table);
    result.claims = scaling_claims(result.table, own_volumes);
    result.paragraph = scaling_paragraph(result.table, own_volumes);
    return result;
}

}  // namespace palpate::evaluation
