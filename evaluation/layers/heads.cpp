// Lines into heads, and the order in which a hand meets their layers.
#include "evaluation/layers/heads.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "palpate/io/sample_volume.hpp"
#include "palpate/io/volume_file.hpp"

namespace palpate::evaluation {
namespace {

constexpr double stroke_speed = 20;  // [mm/s]
constexpr double before_skin = 3;    // [mm] of free space
constexpr double most_force = 5;     // [N] at which the hand stops

/// Skin that gives way, and bone that does so only for a drill.
Layers head_layers(const LayeredHead& head, bool drills) {
    Layers layers;
    layers.name = head_sets[drills];
    Layer skin, bone;
    skin.name = "skin";
    skin.level = head.skin;
    skin[HapticProperty::stiffness] = 0.4;
    skin[HapticProperty::puncture_force] = 0.8;
    bone.name = "bone";
    bone.level = head.bone;
    bone[HapticProperty::stiffness] = 1.5;
    bone[HapticProperty::puncture_force] = drills ? 2.5 : std::numeric_limits<double>::infinity();
    layers.layers = {skin, bone};
    return layers;
}

/// Puts depth 0 where the line through `through` first meets the skin; false if it does not.
bool set_line(LayeredHead& head, const Vec3& through, const Vec3& inward) {
    const Geometry& g = head.field.geometry();
    const double far = 2 * g.size.cast<double>().cwiseProduct(g.spacing).norm();
    const Vec3 outside = through - far * inward;
    const RayHit hit = cast_ray(head.field, head.skin, outside, through);
    head.line = {hit.point, inward};
    return hit.hit && (hit.point - outside).norm() > 0;
}

LayeredHead known_head(const std::string& name, Field field, double skin, double bone,
                       const Vec3& through, const Vec3& inward) {
    LayeredHead head{name, std::move(field), skin, bone, {}, 28};
    if (!set_line(head, through, inward.normalized())) {
        throw std::invalid_argument(name + " is not the head that the line was chosen for");
    }
    return head;
}

/// From the first side of the box whose middle line meets the surface.
LayeredHead head_of_user(const Subject& subject) {
    const Field& field = subject.field;
    const double innermost = field.sign() > 0 ? field.volume().maximum() : field.volume().minimum();
    LayeredHead head{subject.name,
                     field,
                     subject.isovalue,
                     subject.isovalue + 0.5 * (innermost - subject.isovalue),
                     {},
                     0};
    const Vec3 centre = physical_centre(field.geometry());
    for (const double side : {1.0, -1.0}) {
        for (const int axis : {1, 0, 2}) {
            if (!set_line(head, centre, side * field.geometry().direction.col(axis))) continue;
            head.depth = (centre - head.line.origin).norm();
            if (head.depth > 0) return head;
        }
    }
    throw std::invalid_argument(subject.name +
                                ": no line from a side of the volume to its middle meets the "
                                "surface; choose another level");
}

/// A surface that the hand came to or went through.
struct Event {
    std::string what;
    double depth = 0;  // [mm]
    double force = 0;  // [N] the last before it
};

struct HeadStroke {
    std::vector<Event> events;
    double greatest_force = 0;  // [N]
    double deepest_bone = 0;    // of the SCP beyond the bone's level [range]; at least 0
    int bone_outside_skin = 0;  // ticks that touch bone with the skin still whole
    int ticks = 0;
    double stopped_at = 0;  // [mm]
};

/// Writes down surfaces that are met and that give way.
void note_events(HeadStroke& stroke, const Tick& last, const Tick& tick, const Layers& layers,
                 double depth) {
    const auto name = [&](const Tick& t) {
        return layers.layers[std::size_t(t.layers.touched)].name +
               (t.proxy.behind ? " from behind" : "");
    };
    if (tick.layers.punctured > 0 && last.layers.touched >= 0) {
        stroke.events.push_back({"through " + name(last), depth, last.force.norm()});
    }
    const bool is_new = tick.layers.touched >= 0 && (tick.layers.touched != last.layers.touched ||
                                                     tick.proxy.behind != last.proxy.behind);
    const std::string on = is_new ? "on " + name(tick) : "";
    // Where the surface lets go and is met again at once, that is no news.
    if (is_new && (stroke.events.empty() || stroke.events.back().what != on)) {
        stroke.events.push_back({on, depth, last.force.norm()});
    }
}

HeadStroke press_into(const LayeredHead& head, const Layers& layers, double resolution,
                      Table& table) {
    Renderer renderer = layered_renderer(head.field, std::make_shared<Layers>(layers));
    HeadStroke stroke;
    Tick last;
    double written = -std::numeric_limits<double>::infinity();
    const double step = stroke_speed / layers_rate;
    for (int i = 0; - before_skin + i * step < head.depth; ++i) {
        const double depth = -before_skin + i * step;
        const Vec3 hand = head.line.at(depth);
        const Tick tick = render(renderer, {.time = (i + 1) / layers_rate, .position = hand});
        note_events(stroke, last, tick, layers, depth);
        last = tick;
        ++stroke.ticks;
        stroke.stopped_at = depth;
        stroke.greatest_force = std::max(stroke.greatest_force, tick.force.norm());
        stroke.bone_outside_skin += tick.layers.touched == 1 && tick.layers.inside < 1;
        stroke.deepest_bone =
            std::max(stroke.deepest_bone,
                     head.field.sign() * (tick.proxy.density - head.bone) / head.field.range());
        const bool stops = tick.force.norm() > most_force;
        if (depth >= written + resolution || stops) {
            written = depth;
            table.add({{"part", "head curve"},
                       {"body", head.name},
                       {"surfaces", layers.name},
                       {"depth_mm", depth},
                       {"force_n", tick.force.norm()},
                       {"inside", double(tick.layers.inside)},
                       {"density_at_hand", value_at(head.field, hand)}});
        }
        if (stops) break;
    }
    return stroke;
}

}  // namespace

std::vector<LayeredHead> layered_heads(const Options& options) {
    std::vector<LayeredHead> heads;
    for (const Subject& subject : options.subjects) heads.push_back(head_of_user(subject));
    if (!heads.empty()) return heads;
    // Through the forehead beside the middle, along the skin's normal there. Both scans of this
    // head have the same axes.
    const Vec3 forehead(278.5, 160.5, 170.5), backwards(0, 1, -0.4);
    heads.push_back(
        known_head("sample head", Field(io::read_volume(io::sample_volume_path()).volume),
                   io::sample_volume_skin, io::sample_volume_bone, forehead, backwards));
    if (options.quick) return heads;
    if (auto ct = real(options.data, "ct-head")) {
        // Over the left brow the skull has no sinus; the crown is at z = 0.
        heads.push_back(
            known_head("ct-head", std::move(ct->field), 500, 1200, {103, 64, 44}, {0, 1, 0.6}));
    } else {
        options.note("layers: without the CT head (no data folder with cthead_unc.nrrd)");
    }
    if (auto human = real(options.data, "visible-human")) {
        heads.push_back(known_head("visible-human", std::move(human->field), io::sample_volume_skin,
                                   io::sample_volume_bone, forehead, backwards));
    } else {
        options.note(
            "layers: without the Visible Human head (no data folder with visible_human_head.nrrd)");
    }
    return heads;
}

void add_head(Table& table, const LayeredHead& head, bool quick) {
    for (const bool drills : {false, true}) {
        const Layers layers = head_layers(head, drills);
        const HeadStroke stroke = press_into(head, layers, quick ? 0.5 : curve_resolution, table);
        std::string order;
        for (const Event& event : stroke.events) {
            table.add({{"part", "head event"},
                       {"body", head.name},
                       {"surfaces", layers.name},
                       {"depth_mm", event.depth},
                       {"force_n", event.force},
                       {"order", event.what}});
            order += fmt::format("{}{} {:.1f}", order.empty() ? "" : "; ", event.what, event.depth);
        }
        table.add({{"part", "head"},
                   {"body", head.name},
                   {"surfaces", layers.name},
                   {"ticks", double(stroke.ticks)},
                   {"greatest_sampled_n", stroke.greatest_force},
                   {"depth_mm", stroke.stopped_at},
                   {"bone_outside_skin_ticks", double(stroke.bone_outside_skin)},
                   {"deepest_in_bone_of_range", stroke.deepest_bone},
                   {"order", order}});
    }
}

std::vector<Claim> head_claims(const Table& table) {
    const Table heads = table.where("part", "head");
    const double wrong = largest(heads.numbers("bone_outside_skin_ticks"));
    double ticks = 0;
    for (const double n : heads.numbers("ticks")) ticks += n;
    const double inside =
        largest(heads.where("surfaces", head_sets[0]).numbers("deepest_in_bone_of_range"));
    return {{"in heads the bone is never felt before the skin gave way", ticks > 0 && wrong == 0,
             fmt::format("{:.0f} of {:.0f} ticks", wrong, ticks)},
            {fmt::format("bone that never gives way is never entered (to {:g} of the data's "
                         "range)",
                         granted),
             ticks > 0 && inside <= granted, fmt::format("largest excess {:.2g}", inside)}};
}

std::string head_sentences(const Table& table) {
    std::string text = fmt::format(
        " Heads: a hand presses in at {:g} mm/s; skin gives way at 0.8 N, bone never (then the "
        "hand stops at {:g} N) or, as in drilling, at 2.5 N. Drilling, it meets in this order, "
        "with its depth in mm:",
        stroke_speed, most_force);
    const Table heads = table.where("part", "head").where("surfaces", head_sets[1]);
    for (std::size_t i = 0; i < heads.rows().size(); ++i) {
        text += fmt::format(" {}: {}.", heads.text(i, "body"), heads.text(i, "order"));
    }
    return text;
}

}  // namespace palpate::evaluation
