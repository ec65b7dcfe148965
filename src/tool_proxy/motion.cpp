// Motion of a whole tool. Each point travels a chord, and the shortest free part of all counts. The
// chords of the shorter motion are tested again, because a turning point's chord is not part of its
// longer one.
#include "tool_proxy/motion.hpp"

#include <algorithm>
#include <cmath>
#include <span>

namespace palpate::tool {

namespace {

/// Of a motion: less counts as none.
constexpr double least_part = 1e-12;
constexpr int most_tries = 16;

/// How far the tool has come, of which a point's travel follows.
struct Odometer {
    double moved, turned;  // [mm], [rad]

    double travel(double arm) const { return moved + turned * arm; }
};

}  // namespace

void Motion::hit(int point) {
    if (point >= 0 && hit_count < static_cast<int>(hits.size())) hits[hit_count++] = point;
}

void Motion::arrive(const Pose& at, double moved, double turned) {
    proxy.pose = at;
    proxy.kept().moved = moved;
    proxy.kept().turned = turned;
    if (observer.on_pose) observer.on_pose(at, observer.context);
}

double Motion::free_part_of(int point, const Pose& to, double level) {
    const Vec3& place = proxy.tool().points()[point];
    return around.free_part(physical_from_tool(proxy.pose, place), physical_from_tool(to, place),
                            level);
}

double Motion::go(const Vec3& translation, const Vec3& rotation, const Pose* exact) {
    hit_count = 0;
    Kept& kept = proxy.kept();
    const auto points = proxy.tool().points();
    around.spend(1 + static_cast<int>(points.size()) / 64);  // to pass over those with clearance
    const double far = std::sqrt(dot(translation, translation));
    const double angle = std::sqrt(dot(rotation, rotation));
    const auto pose_at = [&](double part) {
        return exact && part == 1 ? *exact : moved(proxy.pose, translation, rotation, part);
    };
    const auto odometer_at = [&](double part) {
        return Odometer{kept.moved + part * far, kept.turned + part * angle};
    };
    // Points that may meet something on the way. What one meets shortens the way of the next ones;
    // those before have to be tested again.
    std::size_t suspect_count = 0, outdated = 0;
    double part = 1;
    Pose to = pose_at(1);
    Odometer end = odometer_at(1);
    int first = -1;
    const auto shorten = [&](double to_part) {
        part *= to_part;
        to = pose_at(part);
        end = odometer_at(part);
        outdated = suspect_count;
    };
    const auto is_clear = [&](int i) { return end.travel(kept.arms[i]) <= kept.expiry[i]; };
    for (int i = 0; i < static_cast<int>(points.size()) && part > least_part; ++i) {
        if (is_clear(i)) continue;
        const Around::Probe probe = around.probe(physical_from_tool(proxy.pose, points[i]),
                                                 physical_from_tool(to, points[i]));
        if (around.is_exhausted()) return 0;
        kept.expiry[i] = odometer_at(0).travel(kept.arms[i]) + probe.clearance * (1 - 1e-12);
        if (is_clear(i)) continue;
        kept.suspects[suspect_count++] = i;
        if (probe.part == 1) continue;
        shorten(probe.part);
        first = i;
    }
    for (int tries = 0; tries < most_tries && part > least_part; ++tries) {
        double least = 1;
        for (const int i : std::span(kept.suspects.data(), outdated)) {
            if (is_clear(i)) continue;
            const bool is_free = free_part_of(i, to, Around::verified) == 1;
            const double free = is_free ? 1 : free_part_of(i, to, Around::blocked);
            if (around.is_exhausted()) return 0;
            if (free >= least) continue;
            least = free;
            first = i;
        }
        if (least == 1) {
            hit(first);
            arrive(to, end.moved, end.turned);
            return part;
        }
        shorten(least);
    }
    hit(first);
    return 0;
}

}  // namespace palpate::tool
