// Extracts the surface step by step, from coarse to fine, block by block.
#include "apps/viewer/scene/surface_extractor.hpp"

#include <algorithm>
#include <cmath>
#include <exception>
#include <iterator>
#include <limits>
#include <new>
#include <stdexcept>

#include "apps/viewer/model/sample_block.hpp"
#include "apps/viewer/scene/threads.hpp"

namespace palpate::viewer {
namespace {

using Clock = std::chrono::steady_clock;
using namespace std::chrono_literals;

// Without a large change for so long, finer surfaces are worth it.
constexpr auto still = 150ms;
// The time for a surface while large changes come one after the other [s].
constexpr double streaming_seconds = 0.04;
// Coarse samples that stay for the next level, which the last and largest step can do without.
constexpr std::int64_t most_kept = 4'000'000;
constexpr std::size_t no_limit = std::numeric_limits<std::size_t>::max();

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

}  // namespace

std::vector<int> steps_for(const Index3& size) {
    // The first takes a few hundredths of a second; each step is eight times the work.
    constexpr double first_samples = 350'000;
    const double samples = size.cast<double>().prod();
    std::vector<int> steps{1};
    while (samples / std::pow(steps.front(), 3) > first_samples) {
        steps.insert(steps.begin(), 2 * steps.front());
    }
    return steps;
}

SurfaceExtractor::SurfaceExtractor(Results results, const SurfaceLimits& limits)
    : results_(std::move(results)), limits_(limits) {
    thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

SurfaceExtractor::~SurfaceExtractor() {
    thread_.request_stop();
    thread_.join();
}

void SurfaceExtractor::ask(std::uint64_t request, const Field& field, double isovalue) {
    {
        const std::lock_guard lock(mutex_);
        next_.emplace(Request{request, field, isovalue, true, limits_.most_triangles, {}, origin_});
        waiting_ = true;
    }
    changed_.notify_all();
}

void SurfaceExtractor::update(std::uint64_t request, const Field& field, double isovalue,
                              const SampleBox& changed) {
    {
        const std::lock_guard lock(mutex_);
        const bool anew = next_ && next_->anew;
        const SampleBox all = next_ ? united(next_->changed, changed) : changed;
        next_.emplace(
            Request{request, field, isovalue, anew, limits_.most_triangles, all, origin_});
        waiting_ = true;
    }
    changed_.notify_all();
}

void SurfaceExtractor::set_most_triangles(std::size_t triangles) {
    const std::lock_guard lock(mutex_);
    limits_.most_triangles = triangles;
}

void SurfaceExtractor::set_origin(const Vec3& origin) {
    const std::lock_guard lock(mutex_);
    origin_ = origin;
}

void SurfaceExtractor::forget() {
    const std::lock_guard lock(mutex_);
    next_.reset();
    waiting_ = false;
    forgotten_ = true;
}

void SurfaceExtractor::run(const std::stop_token& stop) {
    lower_thread_priority();
    while (!stop.stop_requested()) {
        {
            std::unique_lock lock(mutex_);
            if (!changed_.wait(lock, stop, [this] { return next_.has_value(); })) return;
            // Requests were cancelled: the surface shown may be of other data.
            if (forgotten_) shown_.reset();
            Request request = *std::move(next_);
            next_.reset();
            waiting_ = false;
            forgotten_ = false;
            lock.unlock();
            take_up(std::move(request));
        }
        try {
            carry_out(stop);
            continue;
        } catch (const std::bad_alloc&) {
            results_.failed(request_->number, "there is not enough memory for the surface");
        } catch (const std::exception& error) {
            results_.failed(request_->number, error.what());
        }
        shown_.reset();
        finer_.reset();
    }
}

/// Decides which parts of the present surfaces can be kept, and which steps follow.
void SurfaceExtractor::take_up(Request request) {
    begun_ = Clock::now();
    const bool anew = request.anew || !shown_ || request.isovalue != request_->isovalue;
    const bool other = !request_ || request_->field.geometry() != request.field.geometry();
    const SampleBox changed = other ? SampleBox() : changed_between(request_->field, request.field);
    request_.emplace(std::move(request));
    if (other) coarse_.clear();
    for (auto& [step, samples] : coarse_) samples.mark(changed);
    const std::vector<int> steps =
        limits_.coarse_first ? steps_for(request_->field.geometry().size) : std::vector{1};
    if (anew) {
        finer_.reset();
        streaming_ = false;
        moving_step_ = 0;
        shown_ = blocks_of(steps.front());
        steps_.assign(steps.begin() + 1, steps.end());
        return;
    }
    shown_->mark(request_->changed);
    if (finer_) finer_->mark(request_->changed);
    if (!(request_->changed == whole_box(request_->field.geometry()))) {
        streaming_ = false;
        return;
    }
    stream(steps);
}

Field SurfaceExtractor::field_of(const SurfaceBlocks& blocks) {
    if (blocks.every() == 1) return request_->field;
    return coarse_.try_emplace(blocks.every(), blocks.every()).first->second.of(request_->field);
}

SurfaceBlocks SurfaceExtractor::blocks_of(int every) const {
    const Field& field = request_->field;
    return {field.geometry(), every, field.interpolation(),
            request_->origin.value_or(physical_centre(field.geometry()))};
}

/// All has changed: the first surface is coarse enough to be shown at once. A finer one is kept and
/// updated when there is time.
void SurfaceExtractor::stream(const std::vector<int>& steps) {
    streaming_ = true;
    if (moving_step_ == 0) moving_step_ = steps.front();
    if (shown_->every() == moving_step_) return;
    if (shown_->every() > moving_step_) {
        finer_.reset();
        steps_.clear();
        std::ranges::copy_if(steps, std::back_inserter(steps_),
                             [&](int step) { return step < moving_step_; });
    } else if (!finer_) {
        steps_.insert(steps_.begin(), shown_->every());
        finer_ = std::move(shown_);
    }
    shown_ = blocks_of(moving_step_);
}

void SurfaceExtractor::carry_out(const std::stop_token& stop) {
    if (!std::isfinite(request_->isovalue))
        throw std::invalid_argument("the isovalue is not finite");
    const auto wanted = [&] { return !stop.stop_requested() && !forgotten_; };
    if (!make_first(wanted)) {
        shown_.reset();
        return;
    }
    if (streaming_) rest(stop);
    while (!steps_.empty()) {
        if (!make_finer([&] { return wanted() && !waiting_; })) return;
    }
    std::erase_if(coarse_, [](const auto& one) { return one.second.samples() > most_kept; });
}

/// The first picture that has the change in it; the newest request waits for it.
bool SurfaceExtractor::make_first(const std::function<bool()>& go_on) {
    for (;;) {
        const bool coarse = shown_->triangles() == 0;
        const auto outcome = shown_->renew(field_of(*shown_), request_->isovalue, go_on,
                                           coarse ? request_->most_triangles : no_limit);
        if (outcome == SurfaceBlocks::Outcome::done) break;
        if (outcome == SurfaceBlocks::Outcome::interrupted) return false;
        shown_ = blocks_of(shown_->every() + 1);
        steps_.clear();
    }
    publish(steps_.empty());
    if (streaming_) adapt_step(seconds_since(begun_));
    return true;
}

/// False if a newer request waits; the finished blocks of the step are kept.
bool SurfaceExtractor::make_finer(const std::function<bool()>& go_on) {
    const int step = finer_ ? finer_->every() : steps_.front();
    if (!finer_) finer_ = blocks_of(step);
    switch (finer_->renew(field_of(*finer_), request_->isovalue, go_on, request_->most_triangles)) {
        case SurfaceBlocks::Outcome::interrupted:
            return false;
        case SurfaceBlocks::Outcome::too_many:
            // A finer step would be too large as well. What is shown may be the next coarser one.
            finer_.reset();
            steps_.clear();
            if (step + 1 < shown_->every()) {
                steps_.push_back(step + 1);
            } else {
                publish(true);
            }
            return true;
        case SurfaceBlocks::Outcome::done:
            break;
    }
    shown_ = std::move(finer_);
    finer_.reset();
    steps_.erase(steps_.begin());
    publish(steps_.empty());
    return true;
}

void SurfaceExtractor::publish(bool finished) {
    ExtractedSurface result;
    result.request = request_->number;
    result.isovalue = request_->isovalue;
    result.blocks = shown_->meshes();
    result.moving = shown_->simplified(limits_.moving_triangles);
    result.every = shown_->every();
    result.finished = finished;
    result.seconds = seconds_since(begun_);
    if (!forgotten_) results_.made(std::move(result));
}

/// Until something is asked for, or nothing was for a while.
void SurfaceExtractor::rest(const std::stop_token& stop) {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, stop, still, [this] { return waiting_ || forgotten_; });
}

/// The finest step that fits into streaming_seconds.
void SurfaceExtractor::adapt_step(double seconds) {
    const double p = shown_->every();
    if (seconds > 1.25 * streaming_seconds) {
        moving_step_ = shown_->every() + 1;
    } else if (p > 1 && seconds * std::pow(p / (p - 1), 3) < streaming_seconds) {
        moving_step_ = shown_->every() - 1;
    }
}

}  // namespace palpate::viewer
