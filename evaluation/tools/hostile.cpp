// Counts what goes through, and how deep.
#include "evaluation/tools/hostile.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "evaluation/tools/judge.hpp"
#include "evaluation/tools/scenes.hpp"
#include "palpate/baselines/penalty_tool.hpp"
#include "palpate/density.hpp"

namespace palpate::evaluation {
namespace {

struct NamedTool {
    std::string name;
    std::shared_ptr<const Tool> tool;
};

std::vector<NamedTool> tools_of(const HostilePlan& plan) {
    std::vector<NamedTool> tools;
    for (const int points : plan.points) {
        const auto tool = tool_of(points);
        tools.push_back({points == 1 ? "point" : points <= 10 ? "rod" : "cube", tool});
    }
    tools.push_back({"scalpel", scalpel()});
    return tools;
}

/// [mm] How far the hand goes from the middle: farther than the scene.
double reach_of(const ToolScene& scene) {
    return scene.wall > 0 ? 2 * scene.wall : 24;
}

/// Where the tool starts in free space: in the shell, or beside the scene.
Pose start_of(const ToolScene& scene) {
    return {scene.wall > 0 ? Vec3::Zero() : Vec3(0, 0, 40)};
}

/// Whether any point is beyond the wall.
bool is_through(const ToolScene& scene, const Tool& tool, const Pose& pose) {
    return scene.wall > 0 && std::ranges::any_of(tool.points(), [&](const Vec3& point) {
               return physical_from_tool(pose, point).norm() > scene.wall;
           });
}

/// [voxel] How deep the deepest point is, by the field's slope, at most as deep as its excess could
/// be; in the shell, beyond its inner side.
double depth_of(const ToolScene& scene, const Tool& tool, const Pose& pose) {
    double deepest = 0;
    for (const Vec3& point : tool.points()) {
        const Vec3 at = physical_from_tool(pose, point);
        const double excess = scene.field.sign() * (value_at(scene.field, at) - scene.isovalue);
        if (scene.wall > 0) {
            deepest = std::max(deepest, at.norm() - (scene.wall - 0.75));
        } else if (excess > 0) {
            const double slope = gradient_at(scene.field, at).norm();
            deepest = std::max(deepest, std::min(excess / std::max(slope, 1e-9), 10.0));
        }
    }
    return deepest;
}

void add_exact(Table& table, const ToolScene& scene, const NamedTool& named, int ticks,
               std::uint64_t seed) {
    ToolProxy proxy(named.tool);
    proxy.isovalue = scene.isovalue;
    ToolVerdict verdict;
    judged_update(proxy, scene.field, start_of(scene), verdict);
    WildHand hand(reach_of(scene), seed);
    std::int64_t through = 0;
    double deepest = 0;
    for (int i = 0; i < ticks; ++i) {
        const ToolUpdate update = judged_update(proxy, scene.field, hand.next(), verdict);
        through += is_through(scene, *named.tool, update.proxy);
        if (i % 64 == 0) {
            deepest = std::max(deepest, depth_of(scene, *named.tool, update.proxy));
        }
    }
    table.add({{"part", "hostile"},
               {"scene", scene.name},
               {"method", "exact"},
               {"tool", named.name},
               {"points", double(named.tool->points().size())},
               {"ticks", double(ticks)},
               {"through_share", double(through) / ticks},
               {"deepest_voxel", std::max(0.0, deepest)},
               {"chords", double(verdict.chords)},
               {"worst_excess_of_range", verdict.worst_excess},
               {"worst_growth_voxel", verdict.worst_growth},
               {"unfinished_share", double(verdict.unfinished) / ticks},
               {"rounds_mean", double(verdict.rounds) / ticks},
               {"rounds_most", double(verdict.most_rounds)},
               {"work_mean", double(verdict.work) / ticks},
               {"work_most", double(verdict.most_work)}});
}

void add_penalty(Table& table, const ToolScene& scene, const NamedTool& named, int ticks,
                 std::uint64_t seed) {
    baselines::PenaltyTool state{named.tool, scene.isovalue};
    baselines::update_penalty(state, scene.field, start_of(scene));
    WildHand hand(reach_of(scene), seed);
    std::int64_t through = 0;
    double deepest = 0;
    for (int i = 0; i < ticks; ++i) {
        baselines::update_penalty(state, scene.field, hand.next());
        through += is_through(scene, *named.tool, state.pose);
        deepest = std::max(deepest, depth_of(scene, *named.tool, state.pose));
    }
    table.add({{"part", "hostile"},
               {"scene", scene.name},
               {"method", "penalty"},
               {"tool", named.name},
               {"points", double(named.tool->points().size())},
               {"ticks", double(ticks)},
               {"through_share", double(through) / ticks},
               {"deepest_voxel", deepest}});
}

}  // namespace

void add_hostile(Table& table, const HostilePlan& plan,
                 const std::function<void(double)>& progress) {
    const std::vector<ToolScene> scenes = hostile_scenes(plan.seed);
    const std::vector<NamedTool> tools = tools_of(plan);
    double done = 0;
    for (const ToolScene& scene : scenes) {
        for (const NamedTool& named : tools) {
            progress(done++ / double(scenes.size() * tools.size()));
            add_exact(table, scene, named, plan.ticks, plan.seed);
            add_penalty(table, scene, named, plan.penalty_ticks, plan.seed);
        }
    }
}

std::vector<Claim> hostile_claims(const Table& table) {
    const Table exact = table.where("part", "hostile").where("method", "exact");
    double chords = 0;
    for (const double count : exact.numbers("chords")) chords += count;
    const double excess = largest(exact.numbers("worst_excess_of_range"), -1);
    const double through = largest(exact.numbers("through_share"));
    const double growth = largest(exact.numbers("worst_growth_voxel"));
    return {{"no point of a tool is anywhere on its way more than 1e-9 of the range in the solid",
             excess <= granted, fmt::format("at most {:.1e} on {:.3g} chords", excess, chords)},
            {"no point of a tool ever gets through a closed shell of 1.5 voxels", through == 0,
             fmt::format("{:.3g} of the ticks", through)},
            {"the distance to the hand never grows in a tick", growth <= 1e-10,
             fmt::format("at most by {:.1e} voxel", growth)}};
}

std::string hostile_sentences(const Table& table) {
    const Table rows = table.where("part", "hostile");
    const Table exact = rows.where("method", "exact"), penalty = rows.where("method", "penalty");
    return fmt::format(
        " Wild hands, up to 3 m/s and 20 rad/s, carry tools of 1 to {:.0f} points and a scalpel "
        "through white noise, salt and a closed shell of 1.5 voxels, {:.0f} ticks each: nothing "
        "gets through, and no point is anywhere more than {:.1e} of the range in the solid; at "
        "most {:.1f} % of an exact tool's updates go on in the next tick. The penalty method "
        "({:.0f} ticks each) has a point beyond the shell in up to {:.0f} % of the ticks, and "
        "points up to {:.1f} voxels deep.",
        largest(exact.numbers("points")), largest(exact.numbers("ticks")),
        std::max(0.0, largest(exact.numbers("worst_excess_of_range"), -1)),
        100 * largest(exact.numbers("unfinished_share")), largest(penalty.numbers("ticks")),
        100 * largest(penalty.numbers("through_share")), largest(penalty.numbers("deepest_voxel")));
}

Figure hostile_figure(const Table& table) {
    const Table rows = table.where("part", "hostile");
    Figure figure;
    figure.columns = 3;
    figure.height = 460;
    figure.caption =
        "Depth of the deepest point of a tool, for tools of more and more points (the scalpel has "
        "528), in three scenes: with the penalty method, and certified (exact). In noise and "
        "salt, depths are cut off at 10 voxels. In the shell, depth counts from the ideal inner "
        "radius, which the smooth field moves by up to 0.06 voxel. Certified points are nowhere "
        "in the solid by more than 1e-9 of the range.";
    for (const std::string& scene : rows.distinct("scene")) {
        Panel panel;
        panel.title = scene;
        panel.x = {.title = "points", .is_logarithmic = true, .low = 0.8, .high = 1500};
        panel.y = {.title = "deepest point [voxel]", .low = -0.5};
        for (const std::string& method : rows.distinct("method")) {
            Rows line = rows.where("scene", scene)
                            .where("method", method)
                            .rows_of({"points", "deepest_voxel"});
            std::ranges::sort(line);
            panel.add(Draw::line_points, method, look_of(method == "exact" ? 0 : 1),
                      std::move(line));
        }
        figure.panels.push_back(std::move(panel));
    }
    return figure;
}

}  // namespace palpate::evaluation
