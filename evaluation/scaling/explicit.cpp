// Measures both approaches over the same trajectories.
#include "evaluation/scaling/explicit.hpp"

#include <malloc.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>

#include "evaluation/table.hpp"
#include "evaluation/timing.hpp"
#include "io/process/helper_process.hpp"

namespace palpate::evaluation {
namespace {

using Clock = std::chrono::steady_clock;

constexpr io::HelperProgram explicit_helper{
    "palpate-explicit-helper", "VTK", "use a smaller volume",
    "close other programs, or use a smaller volume", "use a smaller volume"};

double nanoseconds_since(Clock::time_point begin) {
    return std::chrono::duration<double, std::nano>(Clock::now() - begin).count();
}

/// What the program has from the heap [bytes].
double heap_in_use() {
    const auto info = mallinfo2();
    return static_cast<double>(info.uordblks) + static_cast<double>(info.hblkhd);
}

/// The level a tenth of the range away, inside the data.
double changed(const Field& field, double isovalue, bool up) {
    const Volume& volume = field.volume();
    const double margin = 0.01 * volume.range();
    return std::clamp(isovalue + (up ? 0.1 : -0.1) * volume.range(), volume.minimum() + margin,
                      volume.maximum() - margin);
}

/// Changes the level every now and then while the hand goes on, and gives each changed update to
/// `note` with its time [ns].
template <class Note>
void change_levels(const Subject& subject, const std::vector<Trajectory>& trajectories,
                   Note&& note) {
    constexpr std::size_t every = 25;
    bool up = false;
    follow(subject, trajectories, [&](Proxy& proxy, const Trajectory& hand, std::size_t i) {
        const bool changes = i % every == 0, away = proxy.isovalue == subject.isovalue;
        if (changes) {
            if (away) up = !up;
            proxy.isovalue = away ? changed(subject.field, subject.isovalue, up) : subject.isovalue;
        }
        const auto begin = Clock::now();
        const ProxyUpdate update = update_exact(proxy, subject.field, hand[i]);
        if (changes) note(update, nanoseconds_since(begin));
    });
}

void time_changes(const Subject& subject, const std::vector<Trajectory>& trajectories, int passes,
                  DynamicCost& cost) {
    std::vector<std::vector<double>> times;  // [ns], of each change the passes
    for (int pass = 0; pass < passes; ++pass) {
        std::size_t number = 0;
        change_levels(subject, trajectories, [&](const ProxyUpdate& update, double ns) {
            if (number == times.size()) times.emplace_back();
            times[number++].push_back(ns);
            if (pass > 0) return;
            ++cost.changes;
            const double off = subject.field.sign() * (update.density - update.isovalue);
            const bool touches = update.mode == Mode::constrained;
            cost.unfinished_changes += update.status != UpdateStatus::done;
            if (update.status != UpdateStatus::done) return;
            cost.worst_deviation = std::max(
                cost.worst_deviation, (touches ? std::abs(off) : off) / subject.field.range());
        });
    }
    std::vector<double> medians;
    for (const auto& readings : times) medians.push_back(quantile(readings, 0.5));
    cost.change_p50_ns = quantile(medians, 0.5);
    cost.change_p99_ns = quantile(medians, 0.99);
    cost.change_max_ns = largest(medians);
}

double segment_time(const Subject& subject, const std::vector<Segment>& segments, int passes) {
    std::vector<double> means;
    for (int pass = 0; pass < passes; ++pass) {
        const auto begin = Clock::now();
        for (const Segment& s : segments) cast_ray(subject.field, subject.isovalue, s.from, s.to);
        means.push_back(nanoseconds_since(begin) /
                        static_cast<double>(std::max<std::size_t>(1, segments.size())));
    }
    return quantile(means, 0.5);
}

/// [mm] in the grid's axes, from sample (0, 0, 0).
Vec3 in_grid(const Geometry& geometry, const Vec3& physical) {
    return grid_axes_from_physical(geometry, physical - geometry.origin);
}

}  // namespace

std::vector<Segment> segments_of(const Subject& subject,
                                 const std::vector<Trajectory>& trajectories, std::size_t most) {
    const double above = 0.5 * subject.field.geometry().spacing.minCoeff();
    std::vector<Segment> all;
    follow(subject, trajectories, [&](Proxy& proxy, const Trajectory& hand, std::size_t i) {
        const ProxyUpdate update = update_exact(proxy, subject.field, hand[i]);
        if (update.mode != Mode::constrained) return;
        all.push_back({update.scp + above * normal_at(proxy, subject.field), hand[i]});
    });
    if (all.size() <= most) return all;
    std::vector<Segment> some;
    for (std::size_t i = 0; i < most; ++i) some.push_back(all[i * all.size() / most]);
    return some;
}

DynamicCost dynamic_cost(const Subject& subject, const std::vector<Trajectory>& trajectories,
                         const std::vector<Segment>& segments, int passes) {
    DynamicCost cost;
    cost.update_ns = time_updates(subject, &update_exact, trajectories, {passes, 0}).mean_ns;
    cost.segment_ns = segment_time(subject, segments, passes);
    time_changes(subject, trajectories, passes, cost);
    cost.state_bytes = sizeof(Proxy);
    const double before = heap_in_use();
    double most = before;
    change_levels(subject, trajectories,
                  [&](const ProxyUpdate&, double) { most = std::max(most, heap_in_use()); });
    cost.heap_growth_bytes = most - before;
    return cost;
}

ExplicitAnswer explicit_cost(const Subject& subject, const std::vector<Segment>& segments,
                             int repeats, const std::function<void()>& progress) {
    const Volume& volume = subject.field.volume();
    const ExplicitRequest request{volume.geometry(), volume.type(), subject.isovalue, repeats,
                                  segments.size()};
    const io::Descriptor memory = io::shared_memory(request.bytes());
    const auto shared = io::map_shared(memory, request.bytes());
    auto* const bytes = static_cast<char*>(shared.get());
    std::memcpy(bytes, volume.data(), volume.bytes());
    auto* const ends = reinterpret_cast<double*>(bytes + request.segments_at());
    for (std::size_t i = 0; i < segments.size(); ++i) {
        const Vec3 from = in_grid(request.geometry, segments[i].from);
        const Vec3 to = in_grid(request.geometry, segments[i].to);
        std::copy_n(from.data(), 3, ends + 6 * i);
        std::copy_n(to.data(), 3, ends + 6 * i + 3);
    }
    nlohmann::json asked = json_from(request);
    asked["caller"] = getpid();
    const io::HelperResult result = io::run_helper({explicit_helper,
                                                    {},
                                                    {"extract", asked.dump()},
                                                    &memory,
                                                    [&](double) { progress(); },
                                                    600});
    ExplicitAnswer answer;
    answer.failure = result.failure;
    if (!answer.failure.empty()) return answer;
    answer.cost = result.done.get<ExplicitCost>();
    const auto* const hits = reinterpret_cast<const double*>(bytes + request.hits_at());
    answer.hits.assign(hits, hits + segments.size());
    return answer;
}

Difference difference_of(const Subject& subject, const std::vector<Segment>& segments,
                         const std::vector<double>& hits) {
    const double voxel = subject.field.geometry().spacing.minCoeff();
    Difference difference;
    std::size_t one_sided = 0;
    for (std::size_t i = 0; i < segments.size(); ++i) {
        const Segment& s = segments[i];
        const RayHit ours = cast_ray(subject.field, subject.isovalue, s.from, s.to);
        if (ours.hit == std::isnan(hits[i])) {
            ++one_sided;
        } else if (ours.hit) {
            const Vec3 theirs = s.from + hits[i] * (s.to - s.from);
            difference.worst_voxel =
                std::max(difference.worst_voxel, (theirs - ours.point).norm() / voxel);
        }
    }
    difference.one_sided_share =
        double(one_sided) / double(std::max<std::size_t>(1, segments.size()));
    return difference;
}

}  // namespace palpate::evaluation
