// Random edits on all kinds of grids, and a slow reference of the samples after an edit, written
// from the formulas in palpate/edit.hpp and docs/changing_data.md, over all samples, in
// physical space.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>

#include "palpate/edit.hpp"
#include "support/fields.hpp"
#include "support/random.hpp"

namespace palpate::support {

/// Grids with every kind of last brick: cut, whole, one sample wide, none at all.
inline std::vector<Geometry> odd_grids() {
    return {grid({1, 1, 1}),
            grid({2, 1, 17}, {1, 2, 0.5}),
            grid({16, 17, 18}),
            grid({33, 16, 5}, {0.5, 0.5, 2}, {-100, 50, 700}),
            grid({15, 33, 19}, {0.7, 1.1, 0.9}, {31, -44, 12}, oblique_direction()),
            grid({32, 31, 49}, Vec3::Constant(0.8))};
}

/// Range of values that tests put in samples of a type, well within it for numbers of any size.
struct Values {
    double low, high;
};
inline Values values_of(SampleType type) {
    switch (type) {
        case SampleType::uint8:
            return {0, 256};
        case SampleType::int16:
            return {-32768, 32768};
        case SampleType::uint16:
            return {0, 65536};
        case SampleType::float32:
            break;
    }
    return {-3, 5};
}

inline Volume noise_of(SampleType type, const Geometry& geometry, std::uint64_t seed) {
    const auto [low, high] = values_of(type);
    return with_type(type, [&, low = low, high = high](auto zero) {
        return noise_volume<decltype(zero)>(geometry, seed, low, high);
    });
}

inline bool same_bits(const Volume& a, const Volume& b) {
    return a.geometry() == b.geometry() && a.type() == b.type() &&
           std::memcmp(a.data(), b.data(), a.bytes()) == 0;
}

inline constexpr BrushKind brush_kinds[] = {BrushKind::carve, BrushKind::add, BrushKind::smooth,
                                            BrushKind::paint};

/// A brush stroke in and round the grid; values now and then beyond the type's.
inline edit::Stroke random_stroke(Random& random, const Geometry& geometry, SampleType type) {
    const auto [low, high] = values_of(type);
    const auto anywhere = [&] {
        Vec3 index;
        for (int a = 0; a < 3; ++a) index[a] = random.uniform(-3, geometry.size[a] + 2);
        return physical_from_index(geometry, index);
    };
    edit::Stroke stroke;
    Brush& brush = stroke.brush;
    brush.kind = brush_kinds[random.below(4)];
    brush.radius = random.uniform(0.3, 6) * geometry.spacing.minCoeff();
    brush.hardness = random.chance(0.3) ? 1 : random.uniform(0, 1);
    brush.strength = random.chance(0.3) ? 1 : std::pow(10.0, random.uniform(-3, 0));
    brush.solid = random.chance(0.5) ? Solid::above : Solid::below;
    brush.level = random.uniform(low, high);
    const double far = random.uniform(0.01, 1.5) * (high - low);
    const bool upwards = (brush.kind == BrushKind::add) == (brush.solid == Solid::above);
    brush.value = brush.level + (upwards ? far : -far);
    stroke.from = anywhere();
    stroke.to = random.chance(0.4) ? stroke.from : anywhere();
    return stroke;
}

/// A tool's shape swept in and round the grid: a point, a line, a ball, a box or a burr. The brush
/// reaches two voxels at most, or one in a slow build, because the cost of a body's distances grows
/// with the reach cubed.
inline edit::Sweep random_sweep(Random& random, const Geometry& geometry, SampleType type) {
    edit::Stroke like = random_stroke(random, geometry, type);
    const double voxel = geometry.spacing.minCoeff(), spacing = voxel;
    like.brush.radius = std::min(like.brush.radius, (is_slow_build ? 1 : 2) * voxel);
    const double size = random.uniform(0.5, 2) * voxel;
    const Tool tools[] = {point_tool(), rod_tool(size, spacing), sphere_tool(size, spacing),
                          box_tool({size, 2 * size, 0.7 * size}, spacing),
                          burr_tool(size, spacing)};
    const auto tool = std::make_shared<const Tool>(tools[random.below(5)]);
    edit::Sweep sweep{
        like.brush, nullptr, {like.from}, {like.from + 3 * voxel * random.point(-1, 1)}};
    sweep.body = std::make_shared<const ToolBody>(body_for(like.brush, geometry, tool));
    sweep.from.orientation = turned({1, 0, 0, 0}, random.uniform(0, 3) * random.direction());
    sweep.to.orientation =
        turned(sweep.from.orientation, random.uniform(0, 0.5) * random.direction());
    return sweep;
}

inline SampleBox random_box(Random& random, const Geometry& geometry) {
    SampleBox box;
    for (int a = 0; a < 3; ++a) {
        box.low[a] = random.below(geometry.size[a] + 6) - 4;
        box.high[a] = box.low[a] + random.below(geometry.size[a]) - 1;  // now and then none
    }
    return box;
}

inline Edit random_edit(Random& random, const Geometry& geometry, SampleType type) {
    const int kind = random.below(8);
    const auto [low, high] = values_of(type);
    if (kind == 0) {
        return edit::Fill{random_box(random, geometry), random.uniform(low, 1.2 * high)};
    }
    if (kind == 1) {
        const Geometry part = grid(Index3(1 + random.below(20), 1 + random.below(9), 1));
        return edit::Replace{
            random_box(random, geometry).low,
            noise_of(static_cast<SampleType>(random.below(4)), part, random.bits())};
    }
    if (kind < 4) return random_sweep(random, geometry, type);
    return random_stroke(random, geometry, type);
}

inline double cut_to(SampleType type, double value) {
    const auto [low, high] = values_of(type);
    if (type == SampleType::float32) return value;
    return std::clamp(std::nearbyint(value), low, high - 1);
}

/// How far a point lies from a segment.
inline double distance_to_segment(const Vec3& p, const Vec3& a, const Vec3& b) {
    const double squared = (b - a).squaredNorm();
    const double along = squared > 0 ? std::clamp((p - a).dot(b - a) / squared, 0.0, 1.0) : 0;
    return (p - (a + along * (b - a))).norm();
}

/// How far a point lies from the skin of a tool somewhere on its way, below 0 inside: at each of so
/// many poses that none of the tool's points moves by more than a quarter of a voxel between two.
inline double distance_to_sweep(const Vec3& p, const edit::Sweep& sweep, const Geometry& geometry) {
    const ToolBody& body = *sweep.body;
    const Vec3 turn = rotation_between(sweep.from.orientation, sweep.to.orientation);
    const double arm = body.low().cwiseAbs().cwiseMax(body.high().cwiseAbs()).norm() +
                       reach_of(sweep.brush, geometry);
    constexpr double far = std::numeric_limits<double>::infinity();  // no brush changes it
    if (distance_to_segment(p, sweep.from.position, sweep.to.position) > arm) return far;
    const double way = (sweep.to.position - sweep.from.position).norm() + turn.norm() * arm;
    const int steps = static_cast<int>(std::ceil(way / (0.25 * geometry.spacing.minCoeff())));
    double nearest = far;
    for (int i = 0; i <= steps; ++i) {
        const double t = steps > 0 ? double(i) / steps : 0;
        const Vec3 position = sweep.from.position + t * (sweep.to.position - sweep.from.position);
        const Quaternion orientation = turned(sweep.from.orientation, t * turn);
        nearest = std::min(nearest, body.distance(orientation.conjugate() * (p - position)));
    }
    return nearest;
}

/// 1 well inside the brush, 1/2 at its radius, 0 well outside; linear over the edge.
inline double brush_weight(const Brush& brush, const Geometry& geometry, double distance) {
    const double narrow = 2 * geometry.spacing.maxCoeff();        // two voxels
    const double wide = (1 - brush.hardness) * 2 * brush.radius;  // the brush
    return std::clamp(0.5 - (distance - brush.radius) / std::max(narrow, wide), 0.0, 1.0);
}

inline double binomial_mean(const Volume& volume, const Index3& at) {
    double sum = 0;
    for (int z = -1; z <= 1; ++z) {
        for (int y = -1; y <= 1; ++y) {
            for (int x = -1; x <= 1; ++x) {
                Index3 from = at + Index3(x, y, z);
                for (int a = 0; a < 3; ++a) {
                    from[a] = std::clamp(from[a], 0, volume.geometry().size[a] - 1);
                }
                sum += volume.sample(from) * (2 - std::abs(x)) * (2 - std::abs(y)) *
                       (2 - std::abs(z)) / 64.0;
            }
        }
    }
    return sum;
}

/// What a brush at this distance should make of a sample, before it is rounded and cut to its type.
inline double brushed(const Brush& brush, double distance, const Volume& before, const Index3& at) {
    const double old = before.sample(at);
    const double w = brush_weight(brush, before.geometry(), distance);
    if (w == 0) return old;
    const bool whole_numbers = before.type() != SampleType::float32;
    double aim = whole_numbers ? std::nearbyint(brush.value) : brush.value;
    double part = w * brush.strength;
    if (brush.kind == BrushKind::smooth) {
        aim = binomial_mean(before, at);
    } else if (brush.kind != BrushKind::paint) {
        aim = brush.level + (2 * w - 1) * (brush.value - brush.level);
        part = brush.strength;
        const double more_solid = (aim - old) * (brush.solid == Solid::above ? 1 : -1);
        if (brush.kind == BrushKind::carve ? more_solid > 0 : more_solid < 0) return old;
    }
    const double way = part * (aim - old);
    if (whole_numbers && brush.kind != BrushKind::smooth && std::abs(way) >= 1.0 / 16 &&
        std::abs(way) < 0.5) {
        return old + (way > 0 ? 1 : -1);
    }
    return old + way;
}

/// The same for any edit.
inline double value_after(const Edit& edit, const Volume& before, const Index3& at) {
    const double old = before.sample(at);
    const Vec3 place = physical_from_index(before.geometry(), at.cast<double>());
    if (const auto* stroke = std::get_if<edit::Stroke>(&edit)) {
        return brushed(stroke->brush, distance_to_segment(place, stroke->from, stroke->to), before,
                       at);
    }
    if (const auto* sweep = std::get_if<edit::Sweep>(&edit)) {
        return brushed(sweep->brush, distance_to_sweep(place, *sweep, before.geometry()), before,
                       at);
    }
    if (const auto* fill = std::get_if<edit::Fill>(&edit)) {
        const bool in = (at.array() >= fill->box.low.array()).all() &&
                        (at.array() <= fill->box.high.array()).all();
        return in ? fill->value : old;
    }
    const auto& replace = std::get<edit::Replace>(edit);
    const Index3 from = at - replace.at;
    const bool in =
        (from.array() >= 0).all() && (from.array() < replace.samples.geometry().size.array()).all();
    return in ? replace.samples.sample(from) : old;
}

/// Calls `visit` with the index of every sample of a grid.
template <class Visit>
void for_each_sample(const Geometry& geometry, Visit&& visit) {
    for (int z = 0; z < geometry.size[2]; ++z) {
        for (int y = 0; y < geometry.size[1]; ++y) {
            for (int x = 0; x < geometry.size[0]; ++x) visit(Index3(x, y, z));
        }
    }
}

inline std::shared_ptr<const Samples> samples_of(Volume volume) {
    return std::make_shared<const Samples>(std::move(volume));
}

}  // namespace palpate::support
