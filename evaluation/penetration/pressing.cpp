// Chooses lines into heads, and presses a hand along them.
#include "evaluation/penetration/pressing.hpp"

#include <cmath>
#include <limits>
#include <stdexcept>

#include "palpate/renderer.hpp"

namespace palpate::evaluation {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

double diagonal(const Geometry& g) {
    return g.size.cast<double>().cwiseProduct(g.spacing).norm();
}

/// Sets where the line through `through` meets the body; false if it does not.
bool set_entry(PressingLine& line, const Vec3& through) {
    const Geometry& g = line.subject.field.geometry();
    const Vec3 outside = through - 2 * diagonal(g) * line.inward;
    const RayHit hit = cast_ray(line.subject.field, line.subject.isovalue, outside, through);
    line.entry = hit.point;
    return hit.hit && (hit.point - outside).norm() > 0;
}

/// The CT head lies face up and was stored upside down: its crown is at z = 0. Over the left brow
/// the skull has no sinus; the direction is about the skin's normal.
PressingLine ct_head(Subject subject) {
    PressingLine line(std::move(subject));
    line.inward = Vec3(0, 1, 0.6).normalized();
    if (!set_entry(line, Vec3(103, 64, 44))) {
        throw std::invalid_argument("the CT head is not the one that the line was chosen for");
    }
    line.depth = 30;
    line.ranges = {{500, 900}, {1200, infinity}};  // between them: muscle and brain
    line.levels = {{500, "skin"}, {1200, "skull"}};
    line.view = pictures::rolled(pictures::view_from(35, -20), 180);
    return line;
}

PressingLine shepp_logan(bool quick) {
    PressingLine line(synthetic(quick ? "shepp-logan:48x48x48" : "shepp-logan"));
    line.inward = Vec3(-1, 0, 0);
    const double half = 0.5 * line.subject.field.geometry().size[0];
    set_entry(line, half * Vec3(0, 0.02, 0.05));
    line.depth = line.entry[0];
    // Up to soft tissue; neither skin's inside (60 HU), brain (40) nor ventricles (8).
    line.ranges = {{line.subject.isovalue, 0}, {500, infinity}};
    line.levels = {{line.subject.isovalue, "skin"}, {530, "skull"}};
    line.view = pictures::view_from(55, 20);
    return line;
}

PressingLine of_a_user(const Subject& subject) {
    PressingLine line(subject);
    const Geometry& g = subject.field.geometry();
    const Vec3 centre = physical_centre(g);
    const double most = subject.field.volume().maximum(), least = subject.isovalue;
    line.ranges = {{least, least + 0.25 * (most - least)},
                   {least + 0.5 * (most - least), infinity}};
    line.levels = {{least, "minimum"}};
    for (const double side : {1.0, -1.0}) {
        for (const int axis : {1, 0, 2}) {
            line.inward = side * g.direction.col(axis);
            if (!set_entry(line, centre)) continue;
            line.depth = (centre - line.entry).norm();
            if (line.depth > 0) return line;
        }
    }
    throw std::invalid_argument(subject.name +
                                ": no line from a side of the volume to its middle meets the "
                                "surface; choose another level");
}

}  // namespace

std::vector<PressingLine> pressing_lines(const std::vector<Subject>& subjects,
                                         const std::filesystem::path& data, bool quick,
                                         const std::function<void(const std::string&)>& note) {
    std::vector<PressingLine> lines;
    for (const Subject& subject : subjects) lines.push_back(of_a_user(subject));
    if (!lines.empty()) return lines;
    if (!quick) {
        if (auto head = real(data, "ct-head")) {
            lines.push_back(ct_head(std::move(*head)));
        } else {
            note("penetration: without the CT head (no data folder with cthead_unc.nrrd)");
        }
    }
    lines.push_back(shepp_logan(quick));
    return lines;
}

double pressing_scale(const PressingLine& line) {
    return scale_for_voxels_per_mm(line.subject.field.geometry(), 1);
}

std::vector<PressingTick> press(const PressingLine& line, const Penetrability& penetrability,
                                const PressingPlan& plan) {
    const Field& field = line.subject.field;
    const double scale = pressing_scale(line);
    const double step = plan.speed / plan.rate * scale;  // [mm of volume]
    const double start = -plan.approach * scale;
    const auto one_way = static_cast<int>(std::ceil((line.depth - start) / step));
    Proxy proxy;
    place(proxy, field, line.entry + start * line.inward, line.subject.isovalue);
    std::vector<PressingTick> ticks;
    for (int i = 0; i <= 2 * one_way; ++i) {
        PressingTick tick;
        tick.inwards = i <= one_way;
        tick.depth = start + step * (tick.inwards ? i : 2 * one_way - i);
        const Vec3 hip = line.entry + tick.depth * line.inward;
        tick.update = update_exact(proxy, field, hip);
        apply_penetrability(penetrability, field, 1 / scale, proxy, tick.update);
        tick.pull = (tick.update.scp - hip).norm() / scale;
        tick.force = tick.update.mode == Mode::constrained ? plan.stiffness * tick.pull : 0;
        tick.density_at_hand = value_at(field, hip);
        ticks.push_back(tick);
    }
    return ticks;
}

}  // namespace palpate::evaluation
