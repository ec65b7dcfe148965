// Steps along straight lines through the field until free becomes solid, then bisects.
#include "scenes/contact.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace palpate::scenes {
namespace {

struct Interval {
    double from, to;
};

/// The part of origin + s * along [index space] inside the grid with a voxel of padding.
Interval inside_padded_grid(const Geometry& geometry, const Vec3& origin, const Vec3& along) {
    Interval part{std::numeric_limits<double>::lowest(), std::numeric_limits<double>::max()};
    for (int a = 0; a < 3; ++a) {
        double enter = -1 - origin[a], leave = geometry.size[a] - origin[a];
        if (along[a] == 0) {
            if (enter > 0 || leave < 0) return {0, -1};
            continue;
        }
        enter /= along[a];
        leave /= along[a];
        part.from = std::max(part.from, std::min(enter, leave));
        part.to = std::min(part.to, std::max(enter, leave));
    }
    return part;
}

/// One search: the line, and what is solid on it.
struct Line {
    const Field& field;
    double isovalue;
    const Vec3& target;
    const Vec3& inward;

    bool solid(double s) const {
        return field.sign() * (value_at(field, Vec3(target + s * inward)) - isovalue) > 0;
    }

    /// The free end of a free-to-solid step, to the last bit that matters.
    double halved(double free_end, double solid_end) const {
        for (int i = 0; i < 60; ++i) {
            const double middle = 0.5 * (free_end + solid_end);
            (solid(middle) ? solid_end : free_end) = middle;
        }
        return free_end;
    }
};

struct Crossing {
    double at, clearance;
};

/// `target` itself (s = 0) is always one of the points examined, so a speck there is not stepped
/// over.
std::optional<Crossing> first_crossing(const Line& line, const Interval& part) {
    constexpr int most_steps = 20000;
    const double step = std::max(0.25 * line.field.geometry().spacing.minCoeff(),
                                 (part.to - part.from) / most_steps);
    double before = part.from, free_since = part.from;
    bool was_solid = line.solid(before);
    while (before < part.to) {
        double s = std::min(before + step, part.to);
        if (before < 0 && s > 0) s = 0;
        const bool is_solid = line.solid(s);
        if (is_solid && !was_solid) {
            const double at = line.halved(before, s);
            return Crossing{at, at - free_since};
        }
        if (was_solid && !is_solid) free_since = s;
        was_solid = is_solid;
        before = s;
    }
    return std::nullopt;
}

bool outside_samples(const Geometry& geometry, const Vec3& physical) {
    const Vec3 index = index_from_physical(geometry, physical);
    const Vec3 last = geometry.size.cast<double>() - Vec3::Ones();
    return (index.array() < 0).any() || (index.array() > last.array()).any();
}

/// The first solid sample in memory order, or none.
std::optional<Vec3> solid_sample(const Field& field, double isovalue) {
    const Volume& volume = field.volume();
    const double best = field.sign() > 0 ? volume.maximum() : volume.minimum();
    if (!(field.sign() * (best - isovalue) > 0)) return std::nullopt;
    const Index3 size = volume.geometry().size;
    for (int k = 0; k < size[2]; ++k) {
        for (int j = 0; j < size[1]; ++j) {
            for (int i = 0; i < size[0]; ++i) {
                if (field.sign() * (volume.sample({i, j, k}) - isovalue) > 0) {
                    return physical_from_index(volume.geometry(), Vec3(i, j, k));
                }
            }
        }
    }
    return std::nullopt;
}

Vec3 random_point(const Geometry& geometry, Random& random) {
    Vec3 index;
    for (int a = 0; a < 3; ++a) index[a] = random.uniform(0, geometry.size[a] - 1);
    return physical_from_index(geometry, index);
}

}  // namespace

Contact reach(const Field& field, double isovalue, const Vec3& target, const Vec3& inward) {
    const Geometry& geometry = field.geometry();
    const Interval part = inside_padded_grid(
        geometry, index_from_physical(geometry, target),
        grid_axes_from_physical(geometry, inward).cwiseQuotient(geometry.spacing));
    Contact contact{target, inward, 0, false, false};
    if (part.from > part.to) return contact;
    contact.clearance = std::max(0.0, -part.from);
    const auto crossing = first_crossing({field, isovalue, target, inward}, part);
    if (!crossing) return contact;
    contact.found = true;
    contact.point = target + crossing->at * inward;
    contact.clearance = crossing->clearance;
    contact.at_border = outside_samples(geometry, contact.point);
    return contact;
}

Contact any_contact(const Field& field, double isovalue, Random& random) {
    const Geometry& geometry = field.geometry();
    constexpr int tries = 32;
    Contact best = reach(field, isovalue, physical_centre(geometry), unit_vector(random));
    for (int i = 0; i < 2 * tries && (!best.found || best.at_border); ++i) {
        const Vec3 target = i < tries ? physical_centre(geometry) : random_point(geometry, random);
        const Contact contact = reach(field, isovalue, target, unit_vector(random));
        if (contact.found && (!best.found || !contact.at_border)) best = contact;
    }
    if (best.found) return best;
    const auto sample = solid_sample(field, isovalue);
    return sample ? reach(field, isovalue, *sample, best.inward) : best;
}

Vec3 inward_normal(const Field& field, const Contact& contact) {
    const Geometry& geometry = field.geometry();
    Vec3 rise = Vec3::Zero();
    for (int a = 0; a < 3; ++a) {
        const Vec3 voxel = geometry.direction.col(a) * geometry.spacing[a];
        const double difference = value_at(field, Vec3(contact.point + voxel)) -
                                  value_at(field, Vec3(contact.point - voxel));
        rise += geometry.direction.col(a) * (difference / geometry.spacing[a]);
    }
    rise *= field.sign();
    const double length = rise.norm();
    return rise.dot(contact.inward) > 0.5 * length ? Vec3(rise / length) : contact.inward;
}

Vec3 unit_vector(Random& random) {
    for (;;) {
        Vec3 v;
        for (int a = 0; a < 3; ++a) v[a] = random.uniform(-1, 1);
        const double length = v.norm();
        if (length <= 1 && length > 0.1) return v / length;
    }
}

Vec3 unit_vector_across(const Vec3& axis, Random& random) {
    for (;;) {
        const Vec3 v = unit_vector(random);
        const Vec3 across = v - v.dot(axis) * axis;
        const double length = across.norm();
        if (length > 0.1) return across / length;
    }
}

double chord(const Geometry& geometry, const Vec3& along) {
    const Vec3 grid = grid_axes_from_physical(geometry, along);
    double shortest = std::numeric_limits<double>::max();
    for (int a = 0; a < 3; ++a) {
        const double length = geometry.size[a] * geometry.spacing[a];
        if (grid[a] != 0) shortest = std::min(shortest, length / std::abs(grid[a]));
    }
    return shortest;
}

}  // namespace palpate::scenes
