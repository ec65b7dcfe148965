// Edit: finds the bricks that an edit touches and computes each of their samples.
#include "palpate/edit.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <type_traits>
#include <vector>

#include "edit/before.hpp"
#include "edit/reach.hpp"
#include "palpate/names.hpp"

namespace palpate {
namespace {

/// A value rounded and clamped to the sample type.
template <class T>
T fitted(double value) {
    if constexpr (std::is_integral_v<T>) value = std::nearbyint(value);
    constexpr double low = std::numeric_limits<T>::lowest(), high = std::numeric_limits<T>::max();
    return static_cast<T>(std::clamp(value, low, high));
}

/// `old` moved by a fraction of its difference to `aim`. Integers move by at least one unit where
/// rounding would leave them as they are.
template <class T>
T moved(T old, double aim, double part) {
    const double change = part * (aim - double(old));
    const T value = fitted<T>(double(old) + change);
    if (std::is_floating_point_v<T> || value != old || std::abs(change) < 1.0 / 16) return value;
    return fitted<T>(double(old) + (change > 0 ? 1 : -1));
}

/// The 3 x 3 x 3 binomial mean of the samples before the edit; those beyond the border count as
/// those on it.
double blurred(const Before& before, const Index3& at) {
    double sum = 0;
    for (int n = 0; n < 27; ++n) {
        const Index3 by(n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1);
        const Index3 from = (at + by).cwiseMax(Index3::Zero()).cwiseMin(before.last());
        sum += before.sample(from) * (8 >> by.cwiseAbs().sum());
    }
    return sum / 64;
}

/// A sample where a brush has this effect.
template <class T>
T brushed(const Brush& brush, double w, const Before& before, const Index3& at, T old) {
    if (!(w > 0)) return old;  // or NaN, where the ends are so far apart that squares overflow
    if (brush.kind == BrushKind::paint) {
        // A value between two whole numbers would be passed with every touch, to and fro.
        const bool whole = std::is_integral_v<T>;
        return moved(old, whole ? std::nearbyint(brush.value) : brush.value, w * brush.strength);
    }
    if (brush.kind == BrushKind::smooth) {
        return fitted<T>(double(old) + w * brush.strength * (blurred(before, at) - double(old)));
    }
    // A ramp that has the level at the radius, equally steep on both sides of it.
    const double aim = brush.level + (brush.value - brush.level) * (2 * w - 1);
    const bool downwards = (brush.kind == BrushKind::carve) == (brush.solid == Solid::above);
    const bool counts = downwards ? aim < double(old) : aim > double(old);
    return counts ? moved(old, aim, brush.strength) : old;
}

/// Copies and changes the bricks that hold samples of a box; bricks that do not change stay shared.
class Rewriting {
  public:
    Rewriting(Before& before, const SampleBox& box, const OnProgress& progress)
        : before_(before),
          progress_(progress),
          box_{box.low.cwiseMax(Index3::Zero()), box.high.cwiseMin(before.last())},
          minimum_(before.samples().minimum()),
          maximum_(before.samples().maximum()) {}

    /// `value(at, old)` gives the new value of a sample, `reaches(at)` says whether it may differ.
    /// `around`: how far the samples lie from it that it depends on.
    template <class T>
    Edited run(const std::shared_ptr<const Samples>& samples, int around, auto&& reaches,
               auto&& value) {
        if (box_.empty()) return {samples, {}};
        // A sample on the border of a brick lies in the brick before as well.
        const Index3 first = (box_.low - Index3::Ones()).cwiseMax(Index3::Zero()) / Bricks::edge;
        const Index3 last = box_.high / Bricks::edge;
        constexpr std::size_t between = 4;  // each may take milliseconds
        const auto bricks_along = (last - first + Index3::Ones()).cast<std::size_t>();
        ReportedItems told(progress_, bricks_along.prod(), between);
        for_each_index({first, last}, [&](const Index3& brick) {
            told.done();
            if (before_.is_large() && !prepare(brick, around, reaches)) return;
            rewrite<T>(brick, value);
        });
        if (changed_.empty()) return {samples, {}};
        const Bricks bricks =
            samples->bricks() ? *samples->bricks() : Bricks(samples->geometry().size);
        return {std::make_shared<const Samples>(
                    samples->with(bricks.with(changes_), minimum_, maximum_)),
                changed_};
    }

  private:
    /// The samples of a brick that the edit may change.
    SampleBox part_of(const Index3& brick) const {
        const Index3 low = brick * Bricks::edge;
        return {box_.low.cwiseMax(low), box_.high.cwiseMin(low + Index3::Constant(Bricks::edge))};
    }

    /// For a large grid: fetches samples for a brick. False if the edit does not reach it.
    bool prepare(const Index3& brick, int around, auto&& reaches) {
        const bool reached = any_index(part_of(brick), reaches);
        const bool held = before_.samples().bricks() && before_.samples().bricks()->at(brick);
        if (!reached || (held && around == 0)) return reached;
        const Index3 low = brick * Bricks::edge;
        before_.fetch(
            {low - Index3::Constant(around), low + Index3::Constant(Bricks::edge + around)});
        return true;
    }

    template <class T>
    std::shared_ptr<std::byte[]> copy_of(const Index3& low) const {
        auto brick = std::shared_ptr<std::byte[]>(new std::byte[Bricks::per_brick * sizeof(T)]());
        const Index3 end =
            (low + Index3::Constant(Bricks::edge + 1)).cwiseMin(before_.last() + Index3::Ones());
        const auto row = static_cast<std::size_t>(end[0] - low[0]) * sizeof(T);
        for (int k = low[2]; k < end[2]; ++k) {
            for (int j = low[1]; j < end[1]; ++j) {
                const Index3 at(low[0], j, k);
                const auto to = static_cast<std::size_t>(place(at, low)) * sizeof(T);
                std::memcpy(brick.get() + to, before_.row(at), row);
            }
        }
        return brick;
    }
    static std::ptrdiff_t place(const Index3& at, const Index3& low) {
        const Index3 in = at - low;  // up to the edge, which place_of() takes for the next brick's
        return in[0] + in[1] * Bricks::row + in[2] * Bricks::slice;
    }

    template <class T>
    void rewrite(const Index3& brick, auto&& value) {
        const Index3 low = brick * Bricks::edge;
        const Bricks* before = before_.samples().bricks();
        const Brick* const held = before ? before->at(brick) : nullptr;
        std::shared_ptr<std::byte[]> fresh;
        if (held) {
            fresh = std::shared_ptr<std::byte[]>(new std::byte[Bricks::per_brick * sizeof(T)]);
            std::memcpy(fresh.get(), held->samples.get(), Bricks::per_brick * sizeof(T));
        } else {
            fresh = copy_of<T>(low);
        }
        SampleBox changed;
        T* const samples = reinterpret_cast<T*>(fresh.get());
        for_each_index(part_of(brick), [&](const Index3& at) {
            T& sample = samples[place(at, low)];
            const T now = value(at, sample);
            if (now == sample) return;
            sample = now;
            minimum_ = std::min(minimum_, double(now));
            maximum_ = std::max(maximum_, double(now));
            changed = united(changed, {at, at});
        });
        if (changed.empty()) return;
        changes_.push_back({brick, {std::move(fresh)}});
        changed_ = united(changed_, changed);
    }

    Before& before_;
    const OnProgress& progress_;
    SampleBox box_, changed_;
    double minimum_, maximum_;
    std::vector<Bricks::Change> changes_;
};

/// Whether a brush never changes a sample of this value. Saves computing its effect in the air.
bool is_beyond(const Brush& brush, double old) {
    if (brush.kind == BrushKind::smooth || brush.kind == BrushKind::paint) return false;
    const bool downwards = (brush.kind == BrushKind::carve) == (brush.solid == Solid::above);
    return downwards ? old <= brush.value : old >= brush.value;
}

template <class T>
Edited edited_by(const std::shared_ptr<const Samples>& samples, Before& before, const Brush& brush,
                 const auto& reach, const OnProgress& progress) {
    return Rewriting(before, reach.box(), progress)
        .run<T>(
            samples, brush.kind == BrushKind::smooth ? 1 : 0,
            [&](const Index3& at) { return reach.weight(at) > 0; },
            [&](const Index3& at, T old) {
                if (is_beyond(brush, double(old))) return old;
                return brushed(brush, reach.weight(at), before, at, old);
            });
}

template <class T>
Edited edited_as(const std::shared_ptr<const Samples>& samples, const Edit& edit,
                 const ReadSamples& read, const OnProgress& progress) {
    const Geometry& geometry = samples->geometry();
    Before before(*samples, read);
    if (const auto* stroke = std::get_if<edit::Stroke>(&edit)) {
        return edited_by<T>(samples, before, stroke->brush, StrokeReach(*stroke, geometry),
                            progress);
    }
    if (const auto* sweep = std::get_if<edit::Sweep>(&edit)) {
        return edited_by<T>(samples, before, sweep->brush, SweepReach(*sweep, geometry), progress);
    }
    const auto everywhere = [](const Index3&) { return true; };
    if (const auto* fill = std::get_if<edit::Fill>(&edit)) {
        const T value = fitted<T>(fill->value);
        return Rewriting(before, fill->box, progress)
            .run<T>(samples, 0, everywhere, [&](const Index3&, T) { return value; });
    }
    const auto& replace = std::get<edit::Replace>(edit);
    const SampleBox box{replace.at, replace.at + replace.samples.geometry().size - Index3::Ones()};
    return Rewriting(before, box, progress)
        .run<T>(samples, 0, everywhere, [&](const Index3& at, T) {
            return fitted<T>(replace.samples.sample(at - replace.at));
        });
}

void check_brush(const Brush& brush) {
    check_ranges(brush);
    if (brush.kind == BrushKind::smooth || brush.kind == BrushKind::paint) return;
    const bool above = brush.value > brush.level;
    const bool solid = above == (brush.solid == Solid::above) && brush.value != brush.level;
    if (brush.kind == BrushKind::carve && (solid || brush.value == brush.level)) {
        throw std::invalid_argument("what carving leaves must lie on the free side of the level");
    }
    if (brush.kind == BrushKind::add && !solid) {
        throw std::invalid_argument("what adding leaves must lie on the solid side of the level");
    }
}

void check_sweep(const edit::Sweep& sweep, const Geometry& geometry) {
    check_brush(sweep.brush);
    if (!sweep.body) throw std::invalid_argument("a sweep needs the body of a tool");
    for (const Pose& pose : {sweep.from, sweep.to}) {
        if (!pose.position.allFinite() || !(std::abs(pose.orientation.squaredNorm() - 1) < 1e-6)) {
            throw std::invalid_argument(
                "a sweep's poses must be finite, with orientations of length 1");
        }
    }
    if (!(sweep.body->reach() >= reach_of(sweep.brush, geometry))) {
        throw std::invalid_argument(
            "the tool's body does not reach as far as the brush: make it with body_for()");
    }
    if (!(poses_of(sweep, geometry) <= most_poses)) {
        throw std::invalid_argument("a sweep is too long: divide it into several");
    }
}

}  // namespace

void check(const edit::Fill& fill, SampleType type) {
    with_type(type, [&](auto zero) {
        using T = decltype(zero);
        const auto low = double(std::numeric_limits<T>::lowest());
        const auto high = double(std::numeric_limits<T>::max());
        // Rounded first, as by fitted().
        const double value = std::is_integral_v<T> ? std::nearbyint(fill.value) : fill.value;
        if (value >= low && value <= high) return;
        throw std::invalid_argument("the value " + number_text(fill.value) +
                                    " does not fit into the samples, which hold " +
                                    number_text(low) + " to " + number_text(high));
    });
}

void check(const Edit& edit, const Samples& samples) {
    if (samples.frames().size() > 1) {
        throw std::invalid_argument(
            "a sequence cannot be edited: open one frame of it by its time step");
    }
    if (const auto* stroke = std::get_if<edit::Stroke>(&edit)) {
        check_brush(stroke->brush);
        if (!stroke->from.allFinite() || !stroke->to.allFinite()) {
            throw std::invalid_argument("a stroke's ends must be finite");
        }
    } else if (const auto* sweep = std::get_if<edit::Sweep>(&edit)) {
        check_sweep(*sweep, samples.geometry());
    } else if (const auto* fill = std::get_if<edit::Fill>(&edit)) {
        if (!std::isfinite(fill->value)) {
            throw std::invalid_argument("the value that fills a box must be finite");
        }
    } else if ((std::get<edit::Replace>(edit).at.array().abs() > 1 << 20).any()) {
        throw std::invalid_argument("the samples to put in place lie far outside the grid");
    }
}

Edited edited(const std::shared_ptr<const Samples>& samples, const Edit& edit,
              const ReadSamples& read, const OnProgress& progress) {
    check(edit, *samples);
    if (samples->resident() && !read) {
        throw std::invalid_argument(
            "samples that are not in memory can only be edited as they are "
            "read: give what reads them");
    }
    return with_type(samples->type(), [&](auto zero) {
        return edited_as<decltype(zero)>(samples, edit, read, progress);
    });
}

Brush brush_for(BrushKind kind, const Field& field, double isovalue, double radius) {
    Brush brush;
    brush.kind = kind;
    brush.radius = radius;
    brush.level = isovalue;
    brush.solid = field.solid();
    const double depth = field.sign() * (isovalue - field.background());
    // A background that is itself solid, or as good as felt: then what the data have most of.
    const double least = 0.01 * field.range();
    const double free = isovalue - field.sign() * std::max(depth, least);
    brush.value = kind == BrushKind::carve ? free : 2 * isovalue - free;
    return brush;
}

}  // namespace palpate
