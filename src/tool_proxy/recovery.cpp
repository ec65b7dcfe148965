// Recovery of a tool. It is pushed out along the normals of the points that are inside, deepest
// first. If that gets stuck, it goes to the nearest free place along 26 directions, and comes back
// from there as far as it is free.
#include "tool_proxy/recovery.hpp"

#include <algorithm>
#include <cmath>

#include "tool_proxy/motion.hpp"
#include "tool_proxy/nearest.hpp"

namespace palpate::tool {
namespace {

constexpr int most_pushes = 20;
/// A push moves no point farther than this [voxel].
constexpr double longest_push = 0.5;
/// Distance between two places of the search [voxel].
constexpr double search_step = 0.5;

struct Deep {
    int point;
    double excess;
};

/// The points that are inside, the deepest of them, at most as many as a push takes.
class Inside {
  public:
    Inside(const ToolProxy& proxy, const Pose& pose, Around& around) {
        const auto points = proxy.tool().points();
        for (int i = 0; i < static_cast<int>(points.size()); ++i) {
            is_whole = !around.is_exhausted();
            if (!is_whole) return;
            const Vec3 place = physical_from_tool(pose, points[i]);
            const double excess = around.excess(place);
            if (!(excess > Around::inside * around.range())) continue;
            sum += excess;
            add({i, excess});
        }
    }
    bool is_whole = true;  ///< false: the budget did not allow to look at all points
    double sum = 0;
    int count = 0;
    std::array<Deep, most_half_spaces> deepest;

  private:
    void add(const Deep& deep) {
        if (count < most_half_spaces) {
            deepest[count++] = deep;
            return;
        }
        auto least = std::ranges::min_element(deepest, {}, &Deep::excess);
        if (least->excess < deep.excess) *least = deep;
    }
};

/// True if pushing got all points out. Pushes go on in the next update where the budget ends.
bool push_out(ToolProxy& proxy, Around& around, PoseObserver observer) {
    const double gyration = proxy.tool().gyration(), voxel = around.shortest();
    Kept::Recovery& kept = proxy.kept().recovery;
    Inside inside(proxy, proxy.pose, around);
    if (inside.count > 0) proxy.contact_count = 0;
    for (; kept.pushes < most_pushes && inside.count > 0 && inside.is_whole; ++kept.pushes) {
        const double push = kept.push * longest_push * voxel;
        std::array<HalfSpace6, most_half_spaces> rows;
        int count = 0;
        for (int k = 0; k < inside.count; ++k) {
            const Vec3& point = proxy.tool().points()[inside.deepest[k].point];
            const Vec3 place = physical_from_tool(proxy.pose, point);
            const auto at = around.expand(place);
            const double slope = std::sqrt(dot(at.gradient, at.gradient));
            if (!(slope > 1e-9 * around.range() / voxel)) continue;
            const Vec3 normal = at.gradient / -slope;
            const Vec3 arm = place - proxy.pose.position;
            rows[count].row << normal,
                proxy.tool().turns() ? Vec3(arm.cross(normal) / gyration) : Vec3::Zero();
            rows[count++].bound = std::min(at.excess / slope, push);
        }
        if (count == 0) return false;
        const Nearest out = nearest(Six::Zero(), rows.data(), count, 1e-9 * voxel);
        around.spend(out.work);
        if (!out.found) return false;
        const double length = std::sqrt(dot(out.point, out.point));
        const Six step = out.point * std::min(1.0, 2 * push / length);
        const Pose next = moved(proxy.pose, step.head<3>(), step.tail<3>() / gyration, 1);
        const Inside after(proxy, next, around);
        if (!after.is_whole) return false;
        if (after.sum < inside.sum) {
            proxy.pose = next;
            inside = after;
            if (observer.on_pose) observer.on_pose(next, observer.context);
        } else {
            kept.push *= 0.5;
        }
    }
    return inside.count == 0 && inside.is_whole;
}

bool is_free(const ToolProxy& proxy, const Pose& pose, Around& around) {
    for (const Vec3& point : proxy.tool().points()) {
        if (around.is_exhausted() || around.is_inside(physical_from_tool(pose, point)))
            return false;
    }
    return true;
}

/// The `n`-th place of the search: shell after shell, 26 directions each.
Vec3 place_of_search(int n, double voxel) {
    const int direction = n % 26 < 13 ? n % 26 : n % 26 + 1;
    const Vec3 axes(direction % 3 - 1, direction / 3 % 3 - 1, direction / 9 - 1);
    return axes / std::sqrt(dot(axes, axes)) * ((n / 26 + 1) * search_step * voxel);
}

}  // namespace

double searched_so_far(const ToolProxy& proxy, const Around& around) {
    const int next = proxy.kept().recovery.search;
    return next > 0 ? place_of_search(next - 1, around.shortest()).norm() : 0;
}

bool recover(ToolProxy& proxy, Around& around, PoseObserver observer) {
    int& search = proxy.kept().recovery.search;
    if (search == 0) {
        if (push_out(proxy, around, observer)) return true;
        if (around.is_exhausted()) return false;
        search = 1;
    }
    const Geometry& grid = around.field().geometry();
    const double across = grid.size.cast<double>().cwiseProduct(grid.spacing).norm();
    const double farthest = std::min((2 * across + 4 * proxy.tool().radius()) / around.shortest(),
                                     4 * farthest_hip);  // [voxel]
    const int places = static_cast<int>(26 * farthest / search_step);
    while (!around.is_exhausted()) {
        const Vec3 aside = place_of_search(search - 1, around.shortest());
        const Pose there{proxy.pose.position + aside, proxy.pose.orientation};
        const bool free = is_free(proxy, there, around);
        if (around.is_exhausted()) return false;
        if (free) {
            proxy.pose = there;
            search = 0;
            if (observer.on_pose) observer.on_pose(there, observer.context);
            Motion{proxy, around, observer}.go(-aside, Vec3::Zero());
            return true;
        }
        if (++search > places) search = 1;  // nowhere free: look again
    }
    return false;
}

}  // namespace palpate::tool
