// Draws lines through walls, and moves a proxy along them. Rays are cast exactly, on the lattice.
#include "evaluation/fall_through/crossing.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>

#include "scenes/random.hpp"

namespace palpate::evaluation {
namespace {

// In voxels (of the shortest side).
constexpr double thinnest_wall = 1e-3, thickest_wall = 16;
constexpr double end_in_body = 4;
constexpr double end_behind_wall = 3;
constexpr double flattest = 0.2588190451025208;  // cosine of 75 degrees
constexpr double off_surface = 1e-6;  // from where a ray starts on the other side of a surface

Vec3 unit_vector(scenes::Random& random) {
    for (;;) {
        const Vec3 v(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
        const double length = v.norm();
        if (length <= 1 && length > 0.1) return v / length;
    }
}

struct Lines {
    const Subject& subject;
    const Outside& outside;
    Target target;
    Field inverse;  // solid and free exchanged: a ray in it finds where it leaves a wall
    double voxel, farthest;

    std::optional<Crossing> draw(scenes::Random& random) const {
        const Field& field = subject.field;
        const Geometry& geometry = field.geometry();
        Vec3 through;
        for (int a = 0; a < 3; ++a) through[a] = random.uniform(0, geometry.size[a] - 1);
        through = physical_from_index(geometry, through);
        Crossing crossing;
        crossing.along = unit_vector(random);
        const RayHit in = cast_ray(field, subject.isovalue, through - farthest * crossing.along,
                                   through + farthest * crossing.along);
        if (!in.hit || -in.normal.dot(crossing.along) < flattest) return {};
        crossing.entry = in.point;
        const auto at = [&](double s) { return Vec3(in.point + s * crossing.along); };
        const double hair = off_surface * voxel;
        const RayHit out =
            cast_ray(inverse, subject.isovalue, at(hair), at(hair + thickest_wall * voxel));
        crossing.wall = (out.point - in.point).norm();
        if (crossing.wall < thinnest_wall * voxel) return {};  // it grazes
        const double behind = crossing.wall + hair;
        const RayHit next =
            cast_ray(field, subject.isovalue, at(behind), at(behind + 2 * end_behind_wall * voxel));
        crossing.end = behind + 0.5 * (next.point - at(behind)).norm();
        if (out.hit && !outside.holds(at(crossing.end))) return crossing;
        if (target == Target::behind_walls) return {};
        crossing.end = std::min(end_in_body * voxel, 0.5 * crossing.wall);
        crossing.wall = std::numeric_limits<double>::infinity();
        return crossing;
    }
};

}  // namespace

std::vector<Crossing> draw_crossings(const Subject& subject, const Outside& outside, Target target,
                                     std::size_t count, std::uint64_t seed) {
    const Field& field = subject.field;
    const Geometry& geometry = field.geometry();
    const Solid other = field.solid() == Solid::above ? Solid::below : Solid::above;
    const Lines lines{subject,
                      outside,
                      target,
                      Field(field.volume(), other, field.background(), field.interpolation()),
                      geometry.spacing.minCoeff(),
                      2 * geometry.size.cast<double>().cwiseProduct(geometry.spacing).norm()};
    scenes::Random random(seed);
    std::vector<Crossing> crossings;
    for (std::size_t tries = 0; crossings.size() < count; ++tries) {
        if (const auto crossing = lines.draw(random)) crossings.push_back(*crossing);
        if (tries == 1000 + 100 * count) {
            throw std::invalid_argument(
                subject.name +
                ": hardly a straight line through it meets anything solid; choose another level or "
                "volume");
        }
    }
    return crossings;
}

Passage cross(const Subject& subject, const Outside& outside, const Crossing& crossing,
              ProxyMethod method, double step, double phase) {
    constexpr double counts_as_inside = 0.01;  // of the data's range
    constexpr double most_steps_behind = 50;
    const Field& field = subject.field;
    Proxy proxy;
    place(proxy, field, crossing.entry - phase * step * crossing.along, subject.isovalue);
    Passage passage;
    double excess = 0;
    const auto tick = [&](double s) {
        const ProxyUpdate update =
            method(proxy, field, crossing.entry + s * crossing.along, {}, {});
        excess = field.sign() * (update.density - subject.isovalue) / field.range();
        passage.worst = std::max(passage.worst, excess);
        passage.felt |= update.mode == Mode::constrained;
        ++passage.ticks;
    };
    const auto inside = [&] {
        return excess > counts_as_inside || !outside.holds(proxy.scp_physical);
    };
    const double end = std::min(crossing.end, crossing.wall + most_steps_behind * step);
    const double solid_end = std::min(crossing.wall, end);
    for (int k = 1; (k - phase) * step < end; ++k) {
        const double s = (k - phase) * step;
        tick(s);
        passage.pressed |= s < solid_end;
        if (s < solid_end && s + step >= solid_end) passage.inside_pressed = inside();
    }
    tick(end);
    tick(end);
    passage.inside = inside();
    return passage;
}

}  // namespace palpate::evaluation
