// Looks at chords by the density at places on them.
#include "evaluation/tools/judge.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "palpate/density.hpp"

namespace palpate::evaluation {
namespace {

constexpr std::size_t most_judged = 60;  // chords a pose

struct Poses {
    std::vector<Pose> all;
};

double distance(const Tool& tool, const Pose& from, const Pose& to) {
    const double turn =
        tool.turns() ? tool.gyration() * rotation_between(from.orientation, to.orientation).norm()
                     : 0;
    return std::hypot((to.position - from.position).norm(), turn);
}

}  // namespace

double greatest_on_chord(const Field& field, double isovalue, const Vec3& from, const Vec3& to) {
    const auto excess = [&](double part) {
        const Vec3 at = from + part * (to - from);
        return field.sign() * (value_at(field, at) - isovalue) / field.range();
    };
    constexpr int places = 8;
    double best = 0, most = excess(0);
    for (int i = 1; i <= places; ++i) {
        const double here = excess(double(i) / places);
        if (here > most) most = here, best = double(i) / places;
    }
    for (double step = 0.5 / places; step > 1e-4; step *= 0.5) {
        for (const double part : {best - step, best + step}) {
            if (part < 0 || part > 1) continue;
            const double here = excess(part);
            if (here > most) most = here, best = part;
        }
    }
    return most;
}

ToolUpdate judged_update(ToolProxy& proxy, const Field& field, const Pose& hand,
                         ToolVerdict& verdict) {
    const Pose before = proxy.pose;
    const bool was_placed = proxy.placed && !verdict.recovering;
    Poses poses;
    const PoseObserver observer{
        [](const Pose& pose, void* to) { static_cast<Poses*>(to)->all.push_back(pose); }, &poses};
    const ToolUpdate update = update_tool(proxy, field, hand, {}, observer);
    verdict.unfinished += update.status != UpdateStatus::done;
    verdict.recovering = update.status == UpdateStatus::recovering;
    verdict.rounds += update.rounds;
    verdict.work += update.work;
    verdict.most_rounds = std::max(verdict.most_rounds, update.rounds);
    verdict.most_work = std::max(verdict.most_work, update.work);
    if (!was_placed) return update;
    const auto points = proxy.tool().points();
    const std::size_t step = 1 + (points.size() - 1) / most_judged;
    Pose from = before;
    for (const Pose& to : poses.all) {
        for (std::size_t i = static_cast<std::size_t>(verdict.chords) % step; i < points.size();
             i += step) {
            verdict.worst_excess = std::max(
                verdict.worst_excess,
                greatest_on_chord(field, proxy.isovalue, physical_from_tool(from, points[i]),
                                  physical_from_tool(to, points[i])));
            ++verdict.chords;
        }
        from = to;
    }
    const double growth =
        distance(proxy.tool(), update.proxy, hand) - distance(proxy.tool(), before, hand);
    verdict.worst_growth =
        std::max(verdict.worst_growth, growth / field.geometry().spacing.minCoeff());
    return update;
}

}  // namespace palpate::evaluation
