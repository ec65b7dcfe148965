// Motion of a whole tool. Each point travels a chord, and the shortest free part of all counts. The
// chords of the shorter motion are tested again, because a turning point's chord is not part of its
// longer one.
#include "tool_proxy/motion.hpp"

#include <algorithm>
#include <cmath>
#include <span>

namespace palpate::tool {

void Motion::hit(int point) {
    if (hit_count < static_cast<int>(hits.size())) hits[hit_count++] = point;
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
    // Points that may meet something, and what they meet on the way to the end.
    std::size_t suspect_count = 0;
    const Pose end = pose_at(1);
    double part = 1;
    int first = -1;
    const double moved_before = kept.moved, turned_before = kept.turned;
    const double moved_after = moved_before + far, turned_after = turned_before + angle;
    for (int i = 0; i < static_cast<int>(points.size()); ++i) {
        const double arm = kept.arms[i];
        const double after = moved_after + turned_after * arm;
        if (after <= kept.expiry[i]) continue;
        const double before = moved_before + turned_before * arm;
        const Around::Probe probe = around.probe(physical_from_tool(proxy.pose, points[i]),
                                                 physical_from_tool(end, points[i]));
        if (around.is_exhausted()) return 0;
        kept.expiry[i] = before + probe.clearance * (1 - 1e-12);
        if (after <= kept.expiry[i]) continue;
        kept.suspects[suspect_count++] = i;
        if (probe.part >= part) continue;
        part = probe.part;
        first = i;
    }
    constexpr int most_tries = 16;
    for (int tries = 0; tries < most_tries && part > 1e-12; ++tries) {
        const Pose to = pose_at(part);
        double least = 1;
        if (part < 1) {
            for (const int i : std::span(kept.suspects.data(), suspect_count)) {
                if (free_part_of(i, to, Around::verified) == 1) continue;
                const double free = free_part_of(i, to, Around::blocked);
                if (around.is_exhausted()) return 0;
                if (free >= least) continue;
                least = free;
                first = i;
            }
        }
        if (around.is_exhausted()) return 0;
        if (least == 1) {
            if (first >= 0) hit(first);
            proxy.pose = to;
            kept.moved += part * far;
            kept.turned += part * angle;
            if (observer.on_pose) observer.on_pose(to, observer.context);
            return part;
        }
        part *= least;
    }
    if (first >= 0) hit(first);
    return 0;
}

}  // namespace palpate::tool
