// Edit: finds the bricks that an edit touches and computes each of their samples.
#include "palpate/edit.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>

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

/// The capsule of space that a stroke touches, in millimetres along the grid's axes.
class Touch {
  public:
    Touch(const edit::Stroke& stroke, const Geometry& geometry)
        : spacing_(geometry.spacing),
          from_(index_from_physical(geometry, stroke.from).cwiseProduct(spacing_)),
          along_(index_from_physical(geometry, stroke.to).cwiseProduct(spacing_) - from_),
          length_squared_(along_.squaredNorm()),
          radius_(stroke.brush.radius),
          edge_(2 * std::max(spacing_.maxCoeff(), (1 - stroke.brush.hardness) * radius_)) {}

    /// 1 inside, 0.5 at the radius, 0 outside.
    double weight(const Index3& at) const {
        const Vec3 p = spacing_.cwiseProduct(at.cast<double>()) - from_;
        const double t =
            length_squared_ > 0 ? std::clamp(p.dot(along_) / length_squared_, 0.0, 1.0) : 0;
        const double distance = (p - t * along_).norm();
        return std::clamp(0.5 + (radius_ - distance) / edge_, 0.0, 1.0);
    }
    SampleBox box() const {
        const Vec3 reach = Vec3::Constant(radius_ + 0.5 * edge_);
        const Vec3 low = (from_.cwiseMin(from_ + along_) - reach).cwiseQuotient(spacing_);
        const Vec3 high = (from_.cwiseMax(from_ + along_) + reach).cwiseQuotient(spacing_);
        // Kept within what an index can hold; the caller clips to the grid.
        const Vec3 most = Vec3::Constant(1 << 21);
        return {low.cwiseMax(-most).cwiseMin(most).array().ceil().cast<int>(),
                high.cwiseMin(most).cwiseMax(-most).array().floor().cast<int>()};
    }

  private:
    Vec3 spacing_, from_, along_;
    double length_squared_, radius_, edge_;
};

/// The 3 x 3 x 3 binomial mean of the samples before the edit; those beyond the border count as
/// those on it.
double blurred(const Samples& samples, const Index3& at) {
    const Index3 last = samples.geometry().size - Index3::Ones();
    double sum = 0;
    for (int n = 0; n < 27; ++n) {
        const Index3 by(n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1);
        const Index3 from = (at + by).cwiseMax(Index3::Zero()).cwiseMin(last);
        sum += samples.sample(from) * (8 >> by.cwiseAbs().sum());
    }
    return sum / 64;
}

/// A sample after a stroke.
template <class T>
T touched(const edit::Stroke& stroke, const Touch& touch, const Samples& before, const Index3& at,
          T old) {
    const double w = touch.weight(at);
    if (!(w > 0)) return old;  // or NaN, where the ends are so far apart that squares overflow
    const Brush& brush = stroke.brush;
    if (brush.kind == BrushKind::paint) return moved(old, brush.value, w * brush.strength);
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
    Rewriting(const Samples& before, const SampleBox& box)
        : before_(before),
          geometry_(before.geometry()),
          box_{box.low.cwiseMax(Index3::Zero()),
               box.high.cwiseMin(geometry_.size - Index3::Ones())},
          minimum_(before.minimum()),
          maximum_(before.maximum()) {}

    /// `value(at, old)` gives the new value of a sample.
    template <class T, class F>
    Edited run(const std::shared_ptr<const Samples>& samples, F&& value) {
        if (box_.empty()) return {samples, {}};
        bricks_ = before_.bricks() ? *before_.bricks() : no_bricks(geometry_);
        // A sample on the border of a brick lies in the brick before as well.
        const Index3 first = (box_.low - Index3::Ones()).cwiseMax(Index3::Zero()) / Bricks::cells;
        const Index3 last = box_.high / Bricks::cells;
        for (int k = first[2]; k <= last[2]; ++k) {
            for (int j = first[1]; j <= last[1]; ++j) {
                for (int i = first[0]; i <= last[0]; ++i) rewrite<T>({i, j, k}, value);
            }
        }
        if (changed_.empty()) return {samples, {}};
        return {std::make_shared<const Samples>(before_.volume(), std::move(bricks_), minimum_,
                                                maximum_),
                changed_};
    }

  private:
    template <class T>
    std::shared_ptr<std::byte[]> copy_of(const Index3& low) const {
        auto brick = std::shared_ptr<std::byte[]>(new std::byte[Bricks::per_brick * sizeof(T)]());
        auto* to = reinterpret_cast<T*>(brick.get());
        const T* whole = static_cast<const T*>(before_.volume().data());
        const Index3 end = (low + Index3::Constant(Bricks::samples)).cwiseMin(geometry_.size);
        for (int k = low[2]; k < end[2]; ++k) {
            for (int j = low[1]; j < end[1]; ++j) {
                const auto from =
                    (std::ptrdiff_t{k} * geometry_.size[1] + j) * geometry_.size[0] + low[0];
                std::copy_n(whole + from, end[0] - low[0], to + place({low[0], j, k}, low));
            }
        }
        return brick;
    }
    static std::ptrdiff_t place(const Index3& at, const Index3& low) {
        return (std::ptrdiff_t{at[2] - low[2]} * Bricks::samples + at[1] - low[1]) *
                   Bricks::samples +
               at[0] - low[0];
    }

    template <class T, class F>
    void rewrite(const Index3& brick, F&& value) {
        const Index3 low = brick * Bricks::cells;
        const SampleBox part{box_.low.cwiseMax(low),
                             box_.high.cwiseMin(low + Index3::Constant(Bricks::cells))};
        auto& held = bricks_.at[bricks_.place(brick)];
        std::shared_ptr<std::byte[]> fresh;
        if (held) {
            fresh = std::shared_ptr<std::byte[]>(new std::byte[Bricks::per_brick * sizeof(T)]);
            std::memcpy(fresh.get(), held.get(), Bricks::per_brick * sizeof(T));
        } else {
            fresh = copy_of<T>(low);
        }
        SampleBox changed;
        T* const samples = reinterpret_cast<T*>(fresh.get());
        for (int k = part.low[2]; k <= part.high[2]; ++k) {
            for (int j = part.low[1]; j <= part.high[1]; ++j) {
                for (int i = part.low[0]; i <= part.high[0]; ++i) {
                    const Index3 at(i, j, k);
                    T& sample = samples[place(at, low)];
                    const T now = value(at, sample);
                    if (now == sample) continue;
                    sample = now;
                    minimum_ = std::min(minimum_, double(now));
                    maximum_ = std::max(maximum_, double(now));
                    changed = united(changed, {at, at});
                }
            }
        }
        if (changed.empty()) return;
        held = std::move(fresh);
        changed_ = united(changed_, changed);
    }

    const Samples& before_;
    const Geometry& geometry_;
    SampleBox box_, changed_;
    double minimum_, maximum_;
    Bricks bricks_;
};

template <class T>
Edited edited_as(const std::shared_ptr<const Samples>& samples, const Edit& edit) {
    if (const auto* stroke = std::get_if<edit::Stroke>(&edit)) {
        const Touch touch(*stroke, samples->geometry());
        return Rewriting(*samples, touch.box()).run<T>(samples, [&](const Index3& at, T old) {
            return touched(*stroke, touch, *samples, at, old);
        });
    }
    if (const auto* fill = std::get_if<edit::Fill>(&edit)) {
        const T value = fitted<T>(fill->value);
        return Rewriting(*samples, fill->box).run<T>(samples, [&](const Index3&, T) {
            return value;
        });
    }
    const auto& replace = std::get<edit::Replace>(edit);
    const SampleBox box{replace.at, replace.at + replace.samples.geometry().size - Index3::Ones()};
    return Rewriting(*samples, box).run<T>(samples, [&](const Index3& at, T) {
        return fitted<T>(replace.samples.sample(at - replace.at));
    });
}

void check_brush(const Brush& brush) {
    if (!(brush.radius > 0) || !std::isfinite(brush.radius)) {
        throw std::invalid_argument("a brush's radius [mm] must be finite and above 0");
    }
    if (!(brush.hardness >= 0 && brush.hardness <= 1)) {
        throw std::invalid_argument("a brush's hardness must be 0 to 1");
    }
    if (!(brush.strength > 0 && brush.strength <= 1)) {
        throw std::invalid_argument("a brush's strength must be above 0 and at most 1");
    }
    if (brush.kind == BrushKind::smooth) return;
    if (!std::isfinite(brush.value) || !std::isfinite(brush.level)) {
        throw std::invalid_argument("a brush's value and level must be finite");
    }
    if (brush.kind == BrushKind::paint) return;
    const bool above = brush.value > brush.level;
    const bool solid = above == (brush.solid == Solid::above) && brush.value != brush.level;
    if (brush.kind == BrushKind::carve && (solid || brush.value == brush.level)) {
        throw std::invalid_argument("what carving leaves must lie on the free side of the level");
    }
    if (brush.kind == BrushKind::add && !solid) {
        throw std::invalid_argument("what adding leaves must lie on the solid side of the level");
    }
}

}  // namespace

std::string_view name_of(BrushKind kind) {
    switch (kind) {
        case BrushKind::carve:
            return "carve";
        case BrushKind::add:
            return "add";
        case BrushKind::smooth:
            return "smooth";
        case BrushKind::paint:
            break;
    }
    return "paint";
}

BrushKind brush_kind_from(std::string_view name) {
    for (const auto kind :
         {BrushKind::carve, BrushKind::add, BrushKind::smooth, BrushKind::paint}) {
        if (name == name_of(kind)) return kind;
    }
    throw std::invalid_argument("unknown brush '" + std::string(name) +
                                "': use carve, add, smooth or paint");
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
    } else if (const auto* fill = std::get_if<edit::Fill>(&edit)) {
        if (!std::isfinite(fill->value)) {
            throw std::invalid_argument("the value that fills a box must be finite");
        }
    } else if ((std::get<edit::Replace>(edit).at.array().abs() > 1 << 20).any()) {
        throw std::invalid_argument("the samples to put in place lie far outside the grid");
    }
}

Edited edited(const std::shared_ptr<const Samples>& samples, const Edit& edit) {
    check(edit, *samples);
    return with_type(samples->type(),
                     [&](auto zero) { return edited_as<decltype(zero)>(samples, edit); });
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
