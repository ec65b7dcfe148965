// Lines into heads, and the pressing.
#include "evaluation/penetration/course.hpp"

#include <fmt/format.h>

#include <array>
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
bool set_entry(PressingCourse& course, const Vec3& through) {
    const Geometry& g = course.subject.field.geometry();
    const Vec3 outside = through - 2 * diagonal(g) * course.inward;
    const RayHit hit = cast_ray(course.subject.field, course.subject.isovalue, outside, through);
    course.entry = hit.point;
    return hit.hit && (hit.point - outside).norm() > 0;
}

/// The CT head lies face up and was stored upside down: its crown is at z = 0. Over the left brow
/// the skull has no sinus; the direction is about the skin's normal.
PressingCourse ct_head(Subject subject) {
    PressingCourse course(std::move(subject));
    course.inward = Vec3(0, 1, 0.6).normalized();
    if (!set_entry(course, Vec3(103, 64, 44))) {
        throw std::invalid_argument("the CT head is not the one that the line was chosen for");
    }
    course.depth = 30;
    course.ranges = {{500, 900}, {1200, infinity}};  // between them: muscle and brain
    course.levels = {{500, "skin"}, {1200, "skull"}};
    course.view = pictures::rolled(pictures::view_from(35, -20), 180);
    return course;
}

PressingCourse shepp_logan(bool quick) {
    PressingCourse course(synthetic(quick ? "shepp-logan:48x48x48" : "shepp-logan"));
    course.inward = Vec3(-1, 0, 0);
    const double half = 0.5 * course.subject.field.geometry().size[0];
    set_entry(course, half * Vec3(0, 0.02, 0.05));
    course.depth = course.entry[0];
    // Up to soft tissue; neither skin's inside (60 HU), brain (40) nor ventricles (8).
    course.ranges = {{course.subject.isovalue, 0}, {500, infinity}};
    course.levels = {{course.subject.isovalue, "skin"}, {530, "skull"}};
    course.view = pictures::view_from(55, 20);
    return course;
}

PressingCourse of_a_user(const Subject& subject) {
    PressingCourse course(subject);
    const Geometry& g = subject.field.geometry();
    const Vec3 centre = physical_centre(g);
    const double most = subject.field.volume().maximum(), least = subject.isovalue;
    course.ranges = {{least, least + 0.25 * (most - least)},
                     {least + 0.5 * (most - least), infinity}};
    course.levels = {{least, "minimum"}};
    for (const double side : {1.0, -1.0}) {
        for (const int axis : {1, 0, 2}) {
            course.inward = side * g.direction.col(axis);
            if (!set_entry(course, centre)) continue;
            course.depth = (centre - course.entry).norm();
            if (course.depth > 0) return course;
        }
    }
    throw std::invalid_argument(subject.name +
                                ": no line from a side of the volume to its middle meets the "
                                "surface; choose another level");
}

}  // namespace

std::vector<PressingCourse> pressing_courses(const std::vector<Subject>& subjects,
                                             const std::filesystem::path& data, bool quick,
                                             const std::function<void(const std::string&)>& note) {
    std::vector<PressingCourse> courses;
    for (const Subject& subject : subjects) courses.push_back(of_a_user(subject));
    if (!courses.empty()) return courses;
    if (!quick) {
        if (auto head = real(data, "ct-head")) {
            courses.push_back(ct_head(std::move(*head)));
        } else {
            note("penetration: without the CT head (--data FOLDER says where cthead_unc.nrrd is)");
        }
    }
    courses.push_back(shepp_logan(quick));
    return courses;
}

double pressing_scale(const PressingCourse& course) {
    return scale_for_voxels_per_mm(course.subject.field.geometry(), 1);
}

std::vector<PressingTick> press(const PressingCourse& course, const Penetrability& penetrability,
                                const PressingPlan& plan) {
    const Field& field = course.subject.field;
    const double scale = pressing_scale(course);
    const double step = plan.speed / plan.rate * scale;  // [mm of volume]
    const double start = -plan.approach * scale;
    const auto one_way = static_cast<int>(std::ceil((course.depth - start) / step));
    Proxy proxy;
    place(proxy, field, course.entry + start * course.inward, course.subject.isovalue);
    std::vector<PressingTick> ticks;
    for (int i = 0; i <= 2 * one_way; ++i) {
        PressingTick tick;
        tick.inwards = i <= one_way;
        tick.depth = start + step * (tick.inwards ? i : 2 * one_way - i);
        const Vec3 hip = course.entry + tick.depth * course.inward;
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
