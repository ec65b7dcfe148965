// scaling: what the cost of an update grows with, and what it does not; and the explicit approach,
// which extracts the whole isosurface first.
#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <limits>

#include "evaluation/contestants.hpp"
#include "evaluation/experiment.hpp"
#include "evaluation/scaling/bodies.hpp"
#include "evaluation/scaling/explicit.hpp"
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

using Cells = std::vector<NamedCell>;

Cells cells_of(const Subject& subject, const char* part) {
    const Geometry& geometry = subject.field.geometry();
    return {{"part", part},
            {"volume", subject.name},
            {"size", fmt::format("{}x{}x{}", geometry.size[0], geometry.size[1], geometry.size[2])},
            {"samples", double(sample_count(geometry))}};
}

/// Length of the hand's path [voxel, smallest spacing].
double path_of(const Subject& subject, const std::vector<Trajectory>& trajectories) {
    double path = 0;
    for (const Trajectory& trajectory : trajectories) {
        for (std::size_t i = 1; i < trajectory.size(); ++i)
            path += (trajectory[i] - trajectory[i - 1]).norm();
    }
    return path / subject.field.geometry().spacing.minCoeff();
}

void add_times(Cells cells, const Subject& given, const std::vector<Trajectory>& trajectories,
               int passes, const char* method, Table& table) {
    const Subject subject = as_felt_by(contestant(method), given);
    const UpdateTimes times = time_updates(subject, &update_exact, trajectories, {passes, 0});
    cells.emplace_back("method", method);
    const auto updates = static_cast<double>(times.updates);
    const Cells measured{{"updates", updates},
                         {"path_voxel", path_of(subject, trajectories)},
                         {"constrained_share", double(times.constrained) / updates},
                         {"tetrahedra", double(times.tetrahedra)},
                         {"tetrahedra_per_update", double(times.tetrahedra) / updates},
                         {"mean_ns", times.mean_ns},
                         {"p50_ns", times.p50_ns},
                         {"p99_ns", times.p99_ns},
                         {"p999_ns", times.p999_ns},
                         {"max_ns", times.max_ns}};
    cells.insert(cells.end(), measured.begin(), measured.end());
    table.add(cells);
}

/// The exact method on the linear and on the smooth field.
void add_times(const Cells& cells, const Subject& subject,
               const std::vector<Trajectory>& trajectories, int passes, Table& table) {
    for (const char* method : {"exact", "smooth"}) {
        add_times(cells, subject, trajectories, passes, method, table);
    }
}

/// Round a ball at a depth, both as long as they are in voxels.
std::vector<Trajectory> round(const Ball& shape, double depth, double step, int ticks) {
    return {round_the_ball(shape.radius - depth, step, ticks, shape.radius + 1)};
}

/// A hand on any body that hardly ever leaves it.
std::vector<Trajectory> over(const Subject& subject, double speed, double voxels_per_mm, int ticks,
                             std::uint64_t seed) {
    const double scale = scale_for_voxels_per_mm(subject.field.geometry(), voxels_per_mm);
    ExploringHand hand;
    hand.speed_mm_s = speed * scale;
    hand.depth_mm = usual.depth_mm * scale;
    hand.touching = 0.95;
    hand.trajectories = 4;
    hand.trajectory_s = ticks / usual.rate_hz / hand.trajectories;
    hand.seed = seed;
    return explore(subject, hand);
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

/// Reports progress between the cases of all parts.
class Progress {
  public:
    Progress(const Options& options, std::size_t cases) : options_(options), cases_(cases) {}
    void next() { options_.progress(double(done_++) / double(cases_)); }
    void wait() const { options_.progress(double(done_ - 1) / double(cases_)); }

  private:
    const Options& options_;
    std::size_t cases_;
    std::size_t done_ = 0;
};

/// Speed and voxels per millimetre of the hand, each alone.
void by_hand(const Plan& plan, const Options& options, Progress& progress, Table& table) {
    const auto measure = [&](const char* part, const Ball& shape, double speed, double voxels) {
        const auto add = [&](const Subject& subject, const std::vector<Trajectory>& trajectories) {
            auto cells = cells_of(subject, part);
            cells.emplace_back("speed_mm_s", speed);
            cells.emplace_back("voxels_per_mm", voxels);
            add_times(cells, subject, trajectories, plan.passes, table);
        };
        progress.next();
        for (const Subject& own : options.subjects) {
            add(own, over(own, speed, voxels, plan.ticks, options.seed));
        }
        if (!options.subjects.empty()) return;
        add(ball(shape), round(shape, usual.depth_mm * voxels, step_of(speed, voxels), plan.ticks));
    };
    for (const double speed : plan.speeds) measure("speed", {}, speed, usual.voxels_per_mm);
    for (const double voxels : plan.voxels_per_mm) {
        // The same ball of 20 mm in the hand, sampled ever more finely.
        const Ball shape{2 * static_cast<int>(23 * voxels + 6), 20 * voxels, 6 * voxels};
        measure("voxels-per-mm", shape, usual.speed_mm_s, voxels);
    }
}

void by_body(const Plan& plan, const Options& options, Progress& progress, Table& table) {
    const Ball same;
    const auto trajectories = round(same, usual.depth_mm * usual.voxels_per_mm,
                                    step_of(usual.speed_mm_s, usual.voxels_per_mm), plan.ticks);
    for (const int size : plan.sizes) {
        progress.next();
        if (!has_room(size, 1.2, "the volume", options)) continue;
        Ball shape = same;
        shape.size = size;
        const Subject subject = ball(shape);
        add_times(cells_of(subject, "size"), subject, trajectories, plan.passes, table);
    }
    for (const double noise : plan.noises) {
        progress.next();
        const Subject subject = noisy_ball(same, noise, options.seed);
        auto cells = cells_of(subject, "noise");
        cells.emplace_back("noise_of_range", noise);
        add_times(cells, subject, trajectories, plan.passes, table);
    }
}

/// Both approaches on one volume; without the explicit one, and a note, if its helper fails.
void compare(const Subject& subject, const std::vector<Trajectory>& trajectories, int passes,
             const Options& options, Progress& progress, Table& table) {
    constexpr std::size_t most_segments = 4000;
    constexpr int repeats = 3;  // of which the fastest counts
    Cells cells = cells_of(subject, "explicit");
    const auto segments = segments_of(subject, trajectories, most_segments);
    const DynamicCost ours = dynamic_cost(subject, trajectories, segments, passes);
    const ExplicitAnswer theirs =
        explicit_cost(subject, segments, repeats, [&] { progress.wait(); });
    const ExplicitCost& cost = theirs.cost;
    Difference difference{unknown, unknown};
    if (theirs.failure.empty()) {
        difference = difference_of(subject, segments, theirs.hits);
    } else {
        options.note("scaling: without the explicit approach on " + subject.name + ": " +
                     theirs.failure);
    }
    const Cells measured{{"samples_bytes", double(subject.field.volume().bytes())},
                         {"mean_ns", ours.update_ns},
                         {"segment_ns", ours.segment_ns},
                         {"change_p50_ns", ours.change_p50_ns},
                         {"change_p99_ns", ours.change_p99_ns},
                         {"change_max_ns", ours.change_max_ns},
                         {"changes", double(ours.changes)},
                         {"unfinished_changes", double(ours.unfinished_changes)},
                         {"worst_deviation_of_range", ours.worst_deviation},
                         {"state_bytes", ours.state_bytes},
                         {"heap_growth_bytes", ours.heap_growth_bytes},
                         {"explicit_triangles", cost.triangles},
                         {"explicit_extraction_s", cost.extraction_s},
                         {"explicit_tree_s", cost.tree_s},
                         {"explicit_ready_s", cost.extraction_s + cost.tree_s},
                         {"explicit_cpu_s", cost.cpu_s},
                         {"explicit_mesh_bytes", cost.mesh_bytes},
                         {"explicit_tree_bytes", cost.tree_bytes},
                         {"explicit_kept_bytes", cost.mesh_bytes + cost.tree_bytes},
                         {"explicit_peak_bytes", cost.peak_bytes},
                         {"explicit_segment_ns", cost.query_ns},
                         {"one_sided_hits_share", difference.one_sided_share},
                         {"hit_difference_voxel", difference.worst_voxel}};
    cells.insert(cells.end(), measured.begin(), measured.end());
    table.add(cells);
}

void by_approach(const Plan& plan, const Options& options, Progress& progress, Table& table) {
    const auto compare_on = [&](const Subject& subject) {
        compare(subject,
                over(subject, usual.speed_mm_s, usual.voxels_per_mm, plan.ticks, options.seed),
                plan.passes, options, progress, table);
    };
    for (const Subject& own : options.subjects) {
        progress.next();
        compare_on(own);
    }
    if (!options.subjects.empty()) return;
    for (const int size : plan.explicit_sizes) {
        progress.next();
        // Our samples, the shared copy, and what extraction takes at its peak.
        if (!has_room(size, 3.6, "the explicit approach", options)) continue;
        // Grows with the grid, with the blur of its edge in voxels as a scanner has it.
        const Ball shape{size, 0.35 * size, 16};
        const auto trajectories =
            round(shape, 3, step_of(usual.speed_mm_s, usual.voxels_per_mm), plan.ticks);
        compare(ball(shape), trajectories, plan.passes, options, progress, table);
    }
    for (const char* name : plan.real) {
        progress.next();
        if (const auto subject = real(options.data, name)) {
            compare_on(*subject);
        } else {
            options.note(fmt::format(
                "scaling: without {} (not in the data folder, or there is none)", name));
        }
    }
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
    Progress progress(options, cases);
    Result result;
    by_hand(plan, options, progress, result.table);
    if (own_volumes) by_body(plan, options, progress, result.table);
    by_approach(plan, options, progress, result.table);
    result.figures = scaling_figures(result.table);
    result.claims = scaling_claims(result.table, own_volumes);
    result.paragraph = scaling_paragraph(result.table, own_volumes);
    return result;
}

}  // namespace palpate::evaluation
