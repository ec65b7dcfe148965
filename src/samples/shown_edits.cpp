// Edits of a large grid as an overview of it shows them, brick by brick.
#include <array>
#include <set>
#include <vector>

#include "palpate/samples.hpp"

namespace palpate {
namespace {

/// The edited samples nearest to those of another grid.
class Nearest {
  public:
    Nearest(const Geometry& shown, const Samples& edited) : edited_(edited) {
        const auto there = [&](const Vec3& index) {
            return index_from_physical(edited.geometry(), physical_from_index(shown, index));
        };
        zero_ = there(Vec3::Zero());
        for (int a = 0; a < 3; ++a) axes_.col(a) = there(Vec3::Unit(a)) - zero_;
    }
    /// Returns nothing if the nearest sample is not in an edited brick of its own.
    std::optional<double> operator()(const Index3& index) const {
        const Vec3 at = zero_ + axes_ * index.cast<double>();
        const Vec3 end = edited_.geometry().size.cast<double>();
        const Vec3 near = (at.array() + 0.5).floor();
        if ((near.array() < 0).any() || (near.array() >= end.array()).any()) return std::nullopt;
        const Index3 sample = near.cast<int>();
        const Bricks* bricks = edited_.bricks();
        if (!bricks || !bricks->of_sample(sample)) return std::nullopt;
        return edited_.sample(sample);
    }

  private:
    const Samples& edited_;
    Vec3 zero_;
    Mat3 axes_;
};

/// Samples of a grid that may be nearest to samples of a brick of another one.
SampleBox samples_near(const Geometry& shown, const Geometry& edited, const Index3& brick) {
    Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity()), high = -low;
    for (int corner = 0; corner < 8; ++corner) {
        Vec3 at = (brick * Bricks::edge).cast<double>() - Vec3::Constant(0.5);
        for (int a = 0; a < 3; ++a) at[a] += (corner >> a & 1) ? Bricks::edge : 0;
        const Vec3 there = index_from_physical(shown, physical_from_index(edited, at));
        low = low.cwiseMin(there);
        high = high.cwiseMax(there);
    }
    const Vec3 end = (shown.size - Index3::Ones()).cast<double>();
    return {low.array().floor().max(0).min(end.array() + 1).cast<int>(),
            high.array().ceil().max(-1).min(end.array()).cast<int>()};
}

}  // namespace

ShownEdits::ShownEdits(Volume shown)
    : plain_(std::make_shared<const Samples>(std::move(shown))),
      with_edits_(plain_),
      bricks_(plain_->geometry().size) {}

std::shared_ptr<const Samples> ShownEdits::of(const Samples& edited) {
    if (!edited.bricks() && !from_) return with_edits_;  // a table of a large grid is large, too
    const Geometry &here = plain_->geometry(), &there = edited.geometry();
    const Bricks now = edited.bricks() ? *edited.bricks() : Bricks(there.size);
    if (!from_) from_.emplace(there.size);
    bool changed = false;
    std::set<std::array<int, 3>> touched;
    now.for_each_apart(*from_, [&](const Index3& brick, const auto&, const auto&) {
        changed = true;
        const SampleBox box = samples_near(here, there, brick);
        if (box.empty()) return;
        // The first samples of a brick are the last of the one before, too.
        const Index3 first = (box.low - Index3::Ones()).cwiseMax(0) / Bricks::edge;
        const Index3 last = (box.high / Bricks::edge).cwiseMin(bricks_.count() - Index3::Ones());
        for_each_index({first, last}, [&](const Index3& at) {
            touched.insert({at[0], at[1], at[2]});
        });
    });
    if (changed) from_ = now;
    if (touched.empty()) return with_edits_;
    std::vector<Bricks::Change> changes;
    for (const auto& at : touched) {
        const Index3 brick(at[0], at[1], at[2]);
        changes.push_back({brick, brick_of(brick, edited)});
    }
    bricks_ = bricks_.with(changes);
    with_edits_ = bricks_.size() == 0 ? plain_
                                      : std::make_shared<const Samples>(plain_->with(
                                            bricks_, edited.minimum(), edited.maximum()));
    return with_edits_;
}

/// Null if none of its samples shows an edit.
Brick ShownEdits::brick_of(const Index3& brick, const Samples& edited) const {
    const Nearest nearest(plain_->geometry(), edited);
    const Index3 low = brick * Bricks::edge, size = plain_->geometry().size;
    return with_type(edited.type(), [&](auto zero) -> Brick {
        using T = decltype(zero);
        const std::shared_ptr<std::byte[]> made(new std::byte[Bricks::per_brick * sizeof(T)]{});
        T* out = reinterpret_cast<T*>(made.get());
        bool any = false;
        for_each_index({low, low + Index3::Constant(Bricks::edge)}, [&](const Index3& at) {
            T& sample = *out++;
            if ((at.array() >= size.array()).any()) return;
            const std::optional<double> edit = nearest(at);
            sample = static_cast<T>(edit ? *edit : plain_->sample(at));
            any = any || edit;
        });
        return any ? Brick{made} : Brick{};
    });
}

}  // namespace palpate
