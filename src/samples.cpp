// Samples: versions of the numbers on a grid, their bricks, and moments between frames.
#include "palpate/samples.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <stdexcept>
#include <tuple>

namespace palpate {
namespace {

double sample_of(SampleType type, const void* data, std::size_t at) {
    return with_type(type, [&](auto zero) {
        return static_cast<double>(static_cast<const decltype(zero)*>(data)[at]);
    });
}

void check_frames(const std::vector<Frame>& frames, double period) {
    if (frames.empty()) throw std::invalid_argument("a sequence needs at least one frame");
    const Volume& first = frames.front().volume;
    for (std::size_t i = 0; i < frames.size(); ++i) {
        const Frame& frame = frames[i];
        const std::string which = "frame " + std::to_string(i);
        if (!(frame.volume.geometry() == first.geometry())) {
            throw std::invalid_argument(which + " does not lie on the grid of the first frame");
        }
        if (frame.volume.type() != first.type()) {
            throw std::invalid_argument(which + " has samples of another type than the first");
        }
        if (!std::isfinite(frame.time) || (i > 0 && !(frame.time > frames[i - 1].time))) {
            throw std::invalid_argument("the time of " + which + " does not lie after the last");
        }
    }
    if (!(period == 0 || period > frames.back().time - frames.front().time)) {
        throw std::invalid_argument("the period does not end after the last frame");
    }
}

/// Copies the samples of a brick that lie in the grid into a whole volume.
void copy_brick(const std::byte* brick, const Index3& low, const Geometry& geometry,
                std::size_t bytes, std::byte* whole) {
    const Index3 last =
        (low + Index3::Constant(Bricks::cells)).cwiseMin(geometry.size - Index3::Ones());
    const auto run = static_cast<std::size_t>(last[0] - low[0] + 1) * bytes;
    for (int k = low[2]; k <= last[2]; ++k) {
        for (int j = low[1]; j <= last[1]; ++j) {
            const auto from = static_cast<std::size_t>((k - low[2]) * Bricks::samples + j - low[1]);
            const auto to =
                (static_cast<std::size_t>(k) * geometry.size[1] + j) * geometry.size[0] + low[0];
            std::memcpy(whole + to * bytes, brick + from * Bricks::samples * bytes, run);
        }
    }
}

template <class T>
void blend(const Volume& from, const Volume& to, double weight, std::byte* whole) {
    const auto a = from.samples<T>();
    const auto b = to.samples<T>();
    auto* out = reinterpret_cast<T*>(whole);
    for (std::size_t i = 0; i < a.size(); ++i) {
        const double value = (1 - weight) * double(a[i]) + weight * double(b[i]);
        out[i] = static_cast<T>(std::is_integral_v<T> ? std::nearbyint(value) : value);
    }
}

}  // namespace

// A grid of one sample has no cell inside; its samples still need a brick.
Bricks::Bricks(const Index3& size)
    : count_((size + Index3::Constant(cells - 1)) / cells),
      blocks_((count_ + Index3::Constant(3)) / 4) {}

Bricks Bricks::with(std::span<const Change> changes) const {
    Bricks after = *this;
    std::map<std::array<int, 3>, std::shared_ptr<Block>> changed;
    for (const Change& change : changes) {
        if ((change.brick.array() < 0).any() || (change.brick.array() >= count_.array()).any()) {
            throw std::out_of_range("a brick outside the grid");
        }
        const Index3 at = change.brick / 4;
        std::shared_ptr<Block>& block = changed[{at[0], at[1], at[2]}];
        if (!block) {
            const auto* before = blocks_.at(at);
            block =
                before && *before ? std::make_shared<Block>(**before) : std::make_shared<Block>();
        }
        Brick& brick = (*block)[place_in_block(change.brick)];
        after.size_ += change.to ? 1 : 0;
        after.size_ -= brick ? 1 : 0;
        brick = change.to;
    }
    std::vector<Blocks::Change> blocks;
    for (auto& [at, block] : changed) {
        const bool empty = std::ranges::all_of(*block, [](const Brick& brick) { return !brick; });
        blocks.push_back({{at[0], at[1], at[2]}, empty ? nullptr : std::move(block)});
    }
    after.blocks_ = blocks_.with(blocks);
    return after;
}

void Bricks::for_each_apart(
    const Bricks& other,
    const std::function<void(const Index3&, const Brick&, const Brick&)>& visit) const {
    const Brick none;
    blocks_.for_each_apart(other.blocks_,
                           [&](const Index3& at, const auto& mine, const auto& theirs) {
                               if (mine == theirs) return;
                               for (std::size_t i = 0; i < std::tuple_size_v<Block>; ++i) {
                                   const Brick& a = mine ? (*mine)[i] : none;
                                   const Brick& b = theirs ? (*theirs)[i] : none;
                                   const auto in = static_cast<int>(i);
                                   if (a != b)
                                       visit(4 * at + Index3(in & 3, in >> 2 & 3, in >> 4), a, b);
                               }
                           });
}

void Bricks::for_each(const std::function<void(const Index3&, const Brick&)>& visit) const {
    for_each_apart(Bricks(count_ * cells), [&](const Index3& brick, const Brick& samples,
                                               const Brick&) { visit(brick, samples); });
}

std::size_t Bricks::table_bytes_apart(const Bricks& other) const {
    std::size_t bytes = blocks_.bytes_apart(other.blocks_);
    blocks_.for_each_apart(other.blocks_, [&](const Index3&, const auto& mine, const auto& theirs) {
        bytes += mine && mine != theirs ? sizeof(Block) : 0;
    });
    return bytes;
}

Samples::Samples(Volume volume) : minimum_(volume.minimum()), maximum_(volume.maximum()) {
    frames_.push_back({0, std::move(volume), -1});
    geometry_ = this->volume().geometry();
}

Samples::Samples(Volume volume, Bricks bricks, double minimum, double maximum)
    : Samples(Samples(std::move(volume)).with(std::move(bricks), minimum, maximum)) {}

Samples Samples::with(Bricks bricks, double minimum, double maximum) const {
    if (bricks.count() != Bricks(geometry().size).count()) {
        throw std::invalid_argument("the bricks do not fit the grid");
    }
    Samples edited = *this;
    edited.bricks_ = std::move(bricks);
    edited.minimum_ = std::min(minimum_, minimum);
    edited.maximum_ = std::max(maximum_, maximum);
    return edited;
}

Samples Samples::with(ResidentBricks resident) const {
    if (resident.count() != ResidentBricks(geometry().size).count()) {
        throw std::invalid_argument("the bricks do not fit the grid");
    }
    Samples other = *this;
    other.resident_ = std::move(resident);
    return other;
}

Samples::Samples(std::vector<Frame> frames, double period)
    : frames_(std::move(frames)), period_(period) {
    check_frames(frames_, period);
    geometry_ = volume().geometry();
    minimum_ = volume().minimum();
    maximum_ = volume().maximum();
    for (const Frame& frame : frames_) {
        minimum_ = std::min(minimum_, frame.volume.minimum());
        maximum_ = std::max(maximum_, frame.volume.maximum());
    }
}

Samples::Samples(Volume overview, const Geometry& geometry, ResidentBricks resident, double minimum,
                 double maximum)
    : geometry_(geometry), resident_(std::move(resident)), minimum_(minimum), maximum_(maximum) {
    check(geometry);
    geometry_ = orthonormal(geometry);
    if (resident_->count() != ResidentBricks(geometry.size).count()) {
        throw std::invalid_argument("the bricks do not fit the grid");
    }
    if (!(std::isfinite(minimum) && std::isfinite(maximum) && minimum <= maximum)) {
        throw std::invalid_argument("the least sample must be finite and at most the greatest");
    }
    frames_.push_back({0, std::move(overview), -1});
}

Moment Samples::moment_at(double time) const noexcept {
    const double begin = frames_.front().time;
    const std::size_t last = frames_.size() - 1;
    if (last == 0 || std::isnan(time)) return {};
    if (period_ > 0) {
        if (std::isinf(time)) return {};
        time = begin + std::fmod(time - begin, period_);
        if (time < begin) time += period_;
    }
    if (time <= begin) return {};
    const auto after = std::upper_bound(frames_.begin(), frames_.end(), time,
                                        [](double t, const Frame& f) { return t < f.time; });
    const auto next = static_cast<std::size_t>(after - frames_.begin());
    const std::size_t from = next - 1;
    if (next > last && period_ == 0) return {last, last, 0};
    const std::size_t to = next > last ? 0 : next;
    const double end = next > last ? begin + period_ : frames_[next].time;
    const double weight = (time - frames_[from].time) / (end - frames_[from].time);
    if (!(weight > 0)) return {from, from, 0};
    return weight < 1 ? Moment{from, to, weight} : Moment{to, to, 0};
}

double Samples::within(double time) const noexcept {
    return period_ > 0 ? time : std::clamp(time, frames_.front().time, frames_.back().time);
}

double Samples::sample(const Index3& i, const Moment& moment) const {
    if (bricks_) {
        const std::byte* brick = bricks_->of_cell(i);
        if (brick) {
            const Index3 in(i[0] & 15, i[1] & 15, i[2] & 15);
            const auto at = (in[2] * Bricks::samples + in[1]) * Bricks::samples + in[0];
            return sample_of(type(), brick, static_cast<std::size_t>(at));
        }
    }
    if (resident_) {
        return sample_of(type(), resident_->of_sample(i)->samples.get(),
                         static_cast<std::size_t>(ResidentBricks::place_of(i)));
    }
    const double from = frames_[moment.from].volume.sample(i);
    if (!(moment.weight > 0)) return from;
    return (1 - moment.weight) * from + moment.weight * frames_[moment.to].volume.sample(i);
}

Volume flattened(const Samples& samples, const Moment& moment) {
    const Volume& from = samples.frames()[moment.from].volume;
    const bool between = moment.weight > 0;
    const Bricks* bricks = samples.bricks();
    if (!between && !bricks) return from;
    if (samples.resident()) return flattened(*ShownEdits(from).of(samples));

    const std::shared_ptr<std::byte[]> whole(new std::byte[from.bytes()]);
    if (between) {
        const Volume& to = samples.frames()[moment.to].volume;
        with_type(samples.type(),
                  [&](auto zero) { blend<decltype(zero)>(from, to, moment.weight, whole.get()); });
    } else {
        std::memcpy(whole.get(), from.data(), from.bytes());
    }
    const auto put = [&](const Index3& brick, const Bricks::Brick& edited) {
        copy_brick(edited.get(), brick * Bricks::cells, from.geometry(), size_of(samples.type()),
                   whole.get());
    };
    if (bricks) bricks->for_each(put);
    return {from.geometry(), samples.type(), std::shared_ptr<const void>(whole, whole.get()),
            from.bytes()};
}

std::size_t bytes_apart(const Samples& samples, const Samples& other) {
    const Bricks* mine = samples.bricks();
    if (!mine) return 0;
    const Bricks none(samples.geometry().size);
    std::size_t apart = 0;
    mine->for_each_apart(other.bricks() ? *other.bricks() : none,
                         [&](const Index3&, const Bricks::Brick& here, const Bricks::Brick&) {
                             apart += here ? 1 : 0;
                         });
    return apart * Bricks::per_brick * size_of(samples.type());
}

}  // namespace palpate
