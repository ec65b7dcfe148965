// Samples: versions of the numbers on a grid, their bricks, and moments between frames.
#include "palpate/samples.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>

namespace palpate {
namespace {

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
        (low + Index3::Constant(Bricks::edge)).cwiseMin(geometry.size - Index3::Ones());
    const auto run = static_cast<std::size_t>(last[0] - low[0] + 1) * bytes;
    for (int k = low[2]; k <= last[2]; ++k) {
        for (int j = low[1]; j <= last[1]; ++j) {
            const auto from = static_cast<std::size_t>((k - low[2]) * Bricks::row + j - low[1]);
            const auto to = static_cast<std::size_t>(sample_place({low[0], j, k}, geometry.size));
            std::memcpy(whole + to * bytes, brick + from * Bricks::row * bytes, run);
        }
    }
}

template <class T>
void blend(std::span<const T> a, std::span<const T> b, double weight, T* out) {
    for (std::size_t i = 0; i < a.size(); ++i) {
        const double value = (1 - weight) * double(a[i]) + weight * double(b[i]);
        out[i] = static_cast<T>(std::is_integral_v<T> ? std::nearbyint(value) : value);
    }
}

/// All samples at a moment, without edits.
template <class T>
void copy_samples(std::span<const Frame> frames, const Moment& moment, T* out,
                  const OnProgress& progress) {
    constexpr std::size_t between = std::size_t{1} << 20;
    const auto from = frames[moment.from].volume.samples<T>();
    const auto to = frames[moment.to].volume.samples<T>();
    for (std::size_t at = 0; at < from.size(); at += between) {
        const std::size_t count = std::min(between, from.size() - at);
        if (moment.weight > 0) {
            blend(from.subspan(at, count), to.subspan(at, count), moment.weight, out + at);
        } else {
            std::memcpy(out + at, &from[at], count * sizeof(T));
        }
        if (progress) progress(double(at) / double(from.size()));
    }
}

}  // namespace

Samples::Samples(Volume volume) : minimum_(volume.minimum()), maximum_(volume.maximum()) {
    frames_.push_back({0, std::move(volume), -1});
    geometry_ = this->volume().geometry();
}

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

double Samples::sample(const Index3& index, const Moment& moment) const {
    return with_type(type(), [&](auto zero) {
        const auto in = [](const void* samples, std::ptrdiff_t place) {
            return double(static_cast<const decltype(zero)*>(samples)[place]);
        };
        if (const Brick* brick = bricks_ ? bricks_->of_sample(index) : nullptr) {
            return in(brick->samples.get(), Bricks::place_of(index));
        }
        if (resident_) {
            const Brick* const brick = resident_->of_sample(index);
            return in(brick->samples.get(), ResidentBricks::place_of(index));
        }
        const std::ptrdiff_t place = sample_place(index, geometry_.size);
        const double from = in(frames_[moment.from].volume.data(), place);
        if (!(moment.weight > 0)) return from;
        return (1 - moment.weight) * from +
               moment.weight * in(frames_[moment.to].volume.data(), place);
    });
}

Volume flattened(const Samples& samples, const Moment& moment, const OnProgress& progress) {
    const Volume& from = samples.frames()[moment.from].volume;
    const bool between = moment.weight > 0;
    const Bricks* bricks = samples.bricks();
    if (!between && !bricks) return from;
    if (samples.resident()) return flattened(*ShownEdits(from).of(samples));

    const std::shared_ptr<std::byte[]> whole(new std::byte[from.bytes()]);
    with_type(samples.type(), [&](auto zero) {
        auto* out = reinterpret_cast<decltype(zero)*>(whole.get());
        copy_samples(samples.frames(), moment, out, progress);
    });
    const auto put = [&](const Index3& brick, const Brick& edited) {
        copy_brick(edited.samples.get(), brick * Bricks::edge, from.geometry(),
                   size_of(samples.type()), whole.get());
    };
    if (bricks) bricks->for_each(put);
    return {from.geometry(), samples.type(), std::shared_ptr<const void>(whole, whole.get()),
            from.bytes(), progress};
}

std::size_t bytes_apart(const Samples& samples, const Samples& other) {
    const Bricks* mine = samples.bricks();
    if (!mine) return 0;
    const Bricks none(samples.geometry().size);
    std::size_t apart = 0;
    mine->for_each_apart(
        other.bricks() ? *other.bricks() : none,
        [&](const Index3&, const Brick& here, const Brick&) { apart += here ? 1 : 0; });
    return apart * Bricks::per_brick * size_of(samples.type());
}

}  // namespace palpate
