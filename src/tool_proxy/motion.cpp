// Motion of a whole tool. Each point travels a chord, and the shortest free part of all counts. The
// chords of the shorter motion are tested again, because a turning point's chord is not part of its
// longer one.
#include "tool_proxy/motion.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace palpate::tool {

namespace {

/// A smaller part of a motion counts as none.
constexpr double least_part = 1e-12;
constexpr int most_tries = 16;

/// How far the tool has come, of which a point's travel follows.
struct Odometer {
    double moved, turned;  // [mm], [rad]

    double travel(double arm) const { return moved + turned * arm; }
};

}  // namespace

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
    Kept::Pass& pass = proxy.kept().pass;
    pass = {.translation = translation, .rotation = rotation, .exact = {}, .part = 1};
    if (exact) pass.exact = *exact;
    return test_points();
}

double Motion::go_on() {
    Kept::Pass& pass = proxy.kept().pass;
    const int next = pass.next, tries = pass.tries, again = pass.again;
    const double part = test_points();
    const bool got_on = pass.next != next || pass.tries != tries || pass.again != again;
    if (around.is_exhausted() && !got_on) pass.part = 0;  // one chord takes more than the budget
    return part;
}

Pose Motion::pose_at(double part) const {
    const Kept::Pass& pass = proxy.kept().pass;
    if (pass.exact && part == 1) return *pass.exact;
    return moved(proxy.pose, pass.translation, pass.rotation, part);
}

/// From the point at which the last budget ended. Returns how far the tool has moved.
double Motion::test_points() {
    hit = -1;
    Kept& kept = proxy.kept();
    Kept::Pass& pass = kept.pass;
    const auto points = proxy.tool().points();
    const int count = static_cast<int>(points.size());
    around.spend(1 + count / 64);  // to pass over those with clearance
    const double far = std::sqrt(dot(pass.translation, pass.translation));
    const double angle = std::sqrt(dot(pass.rotation, pass.rotation));
    const auto odometer_at = [&](double part) {
        return Odometer{kept.moved + part * far, kept.turned + part * angle};
    };
    Pose to = end();
    Odometer there = odometer_at(pass.part);
    const auto shorten = [&](double to_part) {
        pass.part *= to_part;
        to = end();
        there = odometer_at(pass.part);
        pass.outdated = pass.suspects;
    };
    const auto is_clear = [&](int i) { return there.travel(kept.arms[i]) <= kept.expiry[i]; };
    // Points that may meet something on the way. What one meets shortens the way of the next ones;
    // those before have to be tested again.
    for (; pass.next < count && pass.part > least_part; ++pass.next) {
        const int i = pass.next;
        if (is_clear(i)) continue;
        const Around::Probe probe = around.probe(physical_from_tool(proxy.pose, points[i]),
                                                 physical_from_tool(to, points[i]));
        if (around.is_exhausted()) return 0;
        kept.expiry[i] = odometer_at(0).travel(kept.arms[i]) + probe.clearance * (1 - 1e-12);
        if (is_clear(i)) continue;
        kept.suspects[pass.suspects++] = i;
        if (probe.part == 1) continue;
        shorten(probe.part);
        pass.first = i;
    }
    for (; pass.tries < most_tries && pass.part > least_part; ++pass.tries) {
        for (; pass.again < pass.outdated; ++pass.again) {
            const int i = kept.suspects[pass.again];
            if (is_clear(i)) continue;
            const bool is_free = free_part_of(i, to, Around::verified) == 1;
            const double free = is_free ? 1 : free_part_of(i, to, Around::blocked);
            if (around.is_exhausted()) return 0;
            if (free >= pass.least) continue;
            pass.least = free;
            pass.first = i;
        }
        if (pass.least == 1) {
            hit = pass.first;
            arrive(to, there.moved, there.turned);
            return std::exchange(pass.part, 0);
        }
        shorten(pass.least);
        pass.least = 1;
        pass.again = 0;
    }
    hit = pass.first;
    pass.part = 0;
    return 0;
}

}  // namespace palpate::tool
