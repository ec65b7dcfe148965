// Coupling stiffness 1 N/mm, rotational stiffness the gyration squared: force is the way from hand
// to proxy, torque the rotation between them times the gyration squared.
#include "evaluation/tools/equilibrium.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "evaluation/tools/judge.hpp"
#include "evaluation/tools/scenes.hpp"
#include "palpate/density.hpp"

namespace palpate::evaluation {
namespace {

struct Felt {
    Vec3 force, torque;  // [N], [N mm]
    ToolUpdate update;
};

/// Presses a tool from above, until it rests.
Felt pressed(const ToolScene& scene, const Tool& tool, const Pose& hand) {
    ToolProxy proxy(std::make_shared<const Tool>(tool));
    proxy.isovalue = scene.isovalue;
    Pose above = hand;
    above.position[2] += 25;
    update_tool(proxy, scene.field, above);
    ToolUpdate update;
    for (int i = 0; i < 200; ++i) {
        update = update_tool(proxy, scene.field, hand);
        if (update.status == UpdateStatus::done) break;
    }
    const double gyration = tool.gyration();
    return {update.proxy.position - hand.position,
            gyration * gyration * rotation_between(hand.orientation, update.proxy.orientation),
            update};
}

void add_row(Table& table, const std::string& what, double parameter, const Felt& felt,
             const Vec3& force, const Vec3& torque) {
    const double off_force = (felt.force - force).norm() / force.norm();
    const double off_torque =
        torque.norm() > 0 ? (felt.torque - torque).norm() / torque.norm() : felt.torque.norm();
    table.add({{"part", "equilibrium"},
               {"scene", what},
               {"parameter", parameter},
               {"contacts", double(felt.update.contacts)},
               {"force_n", felt.force.norm()},
               {"closed_form_n", force.norm()},
               {"force_off_share", off_force},
               {"torque_nmm", felt.torque.norm()},
               {"closed_form_nmm", torque.norm()},
               {"torque_off_share", off_torque}});
}

/// A box pressed onto a plane, tilted and twisted: it lies flat, the rest of the rotation is felt.
void add_box(Table& table) {
    const ToolScene scene = plane_scene();
    const Tool box = box_tool({6, 4, 2}, 0.5);
    for (const double tilt : {0.02, 0.04, 0.06, 0.08}) {
        const Quaternion turn = turned(turned(Quaternion::Identity(), Vec3(tilt, -0.7 * tilt, 0)),
                                       Vec3(0, 0, 8 * tilt));
        constexpr double depth = 2;
        const Felt felt = pressed(scene, box, {Vec3(0, 0, 1 - depth), turn});
        // Flat orientations turn about z; the nearest has the same twist.
        const double twist = 2 * std::atan2(turn.z(), turn.w());
        const Quaternion flat(Eigen::AngleAxisd(twist, Vec3::UnitZ()));
        const double gyration = box.gyration();
        add_row(table, "box on a plane", tilt, felt, Vec3(0, 0, depth),
                gyration * gyration * rotation_between(turn, flat));
    }
}

/// A rod whose one end is on the plane, its middle pressed down and turned: k h = N,
/// k_r (turn - a) = N l / 2 cos(a), h = l / 2 sin(a).
void add_lever(Table& table) {
    const ToolScene scene = plane_scene();
    constexpr double length = 8, gyration = 4;
    std::vector<Vec3> points;
    for (int i = -16; i <= 16; ++i) points.emplace_back(i * length / 32, 0, 0);
    const Tool rod(points, gyration);
    for (double turn = 0.1; turn < 0.85; turn += 0.1) {
        const Felt felt =
            pressed(scene, rod, {Vec3::Zero(), turned(Quaternion::Identity(), Vec3(0, turn, 0))});
        double low = 0, high = turn;
        for (int i = 0; i < 100; ++i) {
            const double angle = 0.5 * (low + high);
            const double lift = 0.5 * length * std::sin(angle);
            const double torque = gyration * gyration * (turn - angle);
            (torque > lift * 0.5 * length * std::cos(angle) ? low : high) = angle;
        }
        add_row(table, "rod on its end", turn, felt, Vec3(0, 0, 0.5 * length * std::sin(low)),
                Vec3(0, gyration * gyration * (low - turn), 0));
    }
}

/// The nearest that a tool of points on a ball comes to a ball: between points it sinks by at most
/// this.
double sag(double spacing, double a, double b) {
    return 0.5 * spacing * spacing * (1 / a + 1 / b);
}

/// A ball pressed onto a ball: the force goes through both middles.
void add_balls(Table& table) {
    const ToolScene scene = round_scene();
    double low = 8, high = 16;
    for (int i = 0; i < 60; ++i) {
        const double radius = 0.5 * (low + high);
        (value_at(scene.field, Vec3(0, 0, radius)) > scene.isovalue ? low : high) = radius;
    }
    constexpr double radius = 3, spacing = 0.15, depth = 2;
    const Tool tool = sphere_tool(radius, spacing);
    for (double angle = 0; angle < 0.9; angle += 0.2) {
        const Vec3 out(std::sin(angle), 0.3 * std::sin(angle), std::cos(angle));
        const double apart = low + radius - depth;
        const Felt felt = pressed(scene, tool, {apart * out.normalized()});
        add_row(table, "ball on a ball", sag(spacing, radius, low), felt, depth * out.normalized(),
                Vec3::Zero());
    }
}

/// A round peg of these sizes [mm], rings of points half a voxel apart.
Tool peg(double radius, double length) {
    std::vector<Vec3> points;
    const int around = static_cast<int>(std::ceil(2 * std::acos(-1.0) * radius / 0.5));
    for (double z = -0.5 * length; z <= 0.5 * length + 1e-9; z += 0.5) {
        for (int i = 0; i < around; ++i) {
            const double angle = 2 * std::acos(-1.0) * i / around;
            points.emplace_back(radius * std::cos(angle), radius * std::sin(angle), z);
        }
    }
    return Tool(std::move(points));
}

}  // namespace

void add_equilibria(Table& table) {
    add_box(table);
    add_lever(table);
    add_balls(table);
}

/// A peg with a quarter of a voxel around it goes into its hole, is wiggled there, and comes out.
void add_fit(Table& table, bool quick) {
    const ToolScene scene = hole_scene();
    const Tool tool = peg(4.75, 10);
    ToolProxy proxy(std::make_shared<const Tool>(tool));
    proxy.isovalue = scene.isovalue;
    ToolVerdict verdict;
    const int ticks = quick ? 300 : 3000;
    double lowest = 1e9, end = 0;
    judged_update(proxy, scene.field, {Vec3(0, 0, 20)}, verdict);
    for (int i = 0; i <= 3 * ticks; ++i) {
        const double t = double(i) / ticks;  // in until 1, wiggled until 2, out until 3
        const double depth = t < 1 ? t : t < 2 ? 1 : 3 - t;
        const double wiggle = t > 1 && t < 2 ? 1 : 0.1;
        const double phase = 0.02 * i;
        const Pose hand{
            Vec3(wiggle * std::sin(phase), wiggle * std::sin(1.3 * phase), 20 - 24 * depth),
            turned(Quaternion::Identity(),
                   0.2 * wiggle * Vec3(std::sin(1.7 * phase), std::cos(phase), 0.5))};
        const ToolUpdate update = judged_update(proxy, scene.field, hand, verdict);
        lowest = std::min(lowest, update.proxy.position[2]);
        end = update.proxy.position[2];
    }
    table.add({{"part", "fit"},
               {"scene", "peg in a hole"},
               {"points", double(tool.points().size())},
               {"ticks", double(3 * ticks)},
               {"lowest_mm", lowest},
               {"end_mm", end},
               {"chords", double(verdict.chords)},
               {"worst_excess_of_range", verdict.worst_excess},
               {"unfinished_share", double(verdict.unfinished) / (3 * ticks)},
               {"rounds_most", double(verdict.most_rounds)}});
}

std::vector<Claim> equilibrium_claims(const Table& table) {
    const Table rest = table.where("part", "equilibrium"), fit = table.where("part", "fit");
    const double force = largest(rest.numbers("force_off_share"));
    const double torque = largest(rest.numbers("torque_off_share"));
    const bool in_and_out = fit.number(0, "lowest_mm") < -3.5 && fit.number(0, "end_mm") > 19;
    return {
        {"force and torque of a box on a plane, a rod on its end and a ball on a ball are within "
         "1 % of the closed form",
         force <= 0.01 && torque <= 0.01,
         fmt::format("at most {:.2g} % and {:.2g} % off", 100 * force, 100 * torque)},
        {"a peg with a quarter of a voxel around it goes into its hole, can be wiggled, and "
         "comes out, never in the solid",
         in_and_out && fit.number(0, "worst_excess_of_range") <= granted,
         fmt::format("from 20 to {:.2f} and back to {:.2f} mm, at most {:.1e} of the range",
                     fit.number(0, "lowest_mm"), fit.number(0, "end_mm"),
                     fit.number(0, "worst_excess_of_range"))}};
}

std::string equilibrium_sentences(const Table& table) {
    const Table rest = table.where("part", "equilibrium"), fit = table.where("part", "fit");
    std::string text = "Tools at rest against closed forms, stiffness 1 N/mm:";
    for (const std::string& what : rest.distinct("scene")) {
        const Table rows = rest.where("scene", what);
        text += fmt::format(" {}: force within {:.2g} %, torque within {:.2g} {};", what,
                            100 * largest(rows.numbers("force_off_share")),
                            (largest(rows.numbers("closed_form_nmm")) > 0 ? 100 : 1) *
                                largest(rows.numbers("torque_off_share")),
                            largest(rows.numbers("closed_form_nmm")) > 0 ? "%" : "N mm");
    }
    text.back() = '.';
    text += fmt::format(
        " The points of a ball lie up to {:.3f} mm deeper than a true ball's surface would. A peg "
        "of {:.0f} points with a quarter of a voxel around it goes in and out; {:.2g} % of the "
        "updates go on in the next tick, none takes more than {:.0f} rounds.",
        largest(rest.where("scene", "ball on a ball").numbers("parameter")),
        fit.number(0, "points"), 100 * fit.number(0, "unfinished_share"),
        fit.number(0, "rounds_most"));
    return text;
}

Figure lever_figure(const Table& table) {
    const Table rows = table.where("part", "equilibrium").where("scene", "rod on its end");
    Figure figure;
    figure.suffix = "lever";
    figure.width = 800;
    figure.height = 460;
    figure.caption =
        "A rod on its end, its middle held on the plane and turned: torque in closed form (grey, "
        "wide) and as rendered.";
    Panel panel;
    panel.x = {.title = "turn of the hand [rad]", .low = 0};
    panel.y = {.title = "torque [N mm]", .low = 0};
    panel.add(Draw::line, "closed form", {.colour = "#c0c0c0", .width = 6},
              rows.rows_of({"parameter", "closed_form_nmm"}));
    panel.add(Draw::points, "rendered",
              {.colour = colours::vermilion, .marker = Marker::open_circle, .size = 1.2},
              rows.rows_of({"parameter", "torque_nmm"}));
    figure.panels.push_back(std::move(panel));
    return figure;
}

}  // namespace palpate::evaluation
