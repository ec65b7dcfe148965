// Makes surfaces step by step, from coarse to full, block by block.
#include "apps/viewer/scene/surface_maker.hpp"

#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>
#include <new>
#include <stdexcept>
#include <utility>

#include "apps/viewer/scene/threads.hpp"

namespace palpate::viewer {
namespace {

using namespace std::chrono_literals;
using Outcome = SurfaceBlocks::Outcome;

// Without a large change for so long, finer surfaces are worth it.
constexpr auto still = 150ms;
// The time for surfaces while large changes come one after the other [s].
constexpr double streaming_seconds = 0.04;
// Coarse samples that stay for the next change, which the last and largest step can do without.
constexpr std::int64_t most_kept = 4'000'000;
constexpr std::size_t no_limit = std::numeric_limits<std::size_t>::max();

double seconds_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
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

SurfaceMaker::SurfaceMaker(const SurfaceLimits& limits)
    : limits_(limits),
      most_triangles_(limits.most_triangles),
      moving_triangles_(limits.moving_triangles),
      thread_([this](const std::stop_token& stop) { run(stop); }) {}

SurfaceMaker::~SurfaceMaker() {
    thread_.request_stop();
    thread_.join();
}

void SurfaceMaker::ask(bool other, const SampleBox& changed) {
    {
        const std::lock_guard lock(mutex_);
        Request request{++number_, field_, levels_, part_, other, changed};
        if (next_) {
            request.other = other || next_->other;
            request.changed = united(next_->changed, changed);
        }
        next_ = std::move(request);
        waiting_ = true;
        cancelled_ = cancelled_ || other;
    }
    changed_.notify_all();
}

void SurfaceMaker::set_field(const Field& field, std::vector<double> levels,
                             const std::optional<PatchBounds>& part) {
    field_ = field;
    levels_ = std::move(levels);
    part_ = part;
    ask(true, {});
    if (part) return;
    oldest_ = number_;
    surfaces_.clear();
}

void SurfaceMaker::update_field(const Field& field, const SampleBox& changed) {
    field_ = field;
    if (!changed.empty()) ask(false, changed);
}

void SurfaceMaker::set_levels(std::vector<double> levels) {
    if (levels == levels_) return;
    levels_ = std::move(levels);
    if (field_) ask(false, {});
}

void SurfaceMaker::set_moving_triangles(std::size_t triangles) {
    if (moving_triangles_.exchange(triangles) != triangles && field_) ask(false, {});
}

void SurfaceMaker::clear() {
    if (!field_) return;
    field_.reset();
    surfaces_.clear();
    ask(true, {});
    answered_ = number_;
    oldest_ = number_ + 1;
}

// From here on it is the thread.

void SurfaceMaker::run(const std::stop_token& stop) {
    lower_thread_priority();
    const GoOn first_goes_on = [&] { return !stop.stop_requested() && !cancelled_; };
    const GoOn finer_goes_on = [&] { return first_goes_on() && !waiting_; };
    const auto is_asked = [this] { return next_.has_value(); };
    std::unique_lock lock(mutex_);
    while (!stop.stop_requested()) {
        // Surfaces that are due come first: levels that are dragged and moments are seen to change.
        if (next_ && (cancelled_ || !is_due())) {
            Request request = *std::exchange(next_, std::nullopt);
            waiting_ = cancelled_ = false;
            lock.unlock();
            take_up(std::move(request));
            lock.lock();
            continue;
        }
        if (streaming_ && !is_due()) {
            streaming_ = changed_.wait_for(lock, stop, still, is_asked);
            continue;
        }
        Growing* const one = next_work();
        if (!one) {
            std::erase_if(coarse_,
                          [](const auto& step) { return step.second.samples() > most_kept; });
            changed_.wait(lock, stop, is_asked);
            continue;
        }
        lock.unlock();
        work(*one, first_goes_on, finer_goes_on);
        lock.lock();
    }
}

bool SurfaceMaker::is_due() const {
    return std::ranges::any_of(growing_, &Growing::due);
}

/// Overdue work comes first, then growing surfaces.
SurfaceMaker::Growing* SurfaceMaker::next_work() {
    auto found = std::ranges::find_if(growing_, &Growing::due);
    if (found == growing_.end()) {
        found = std::ranges::find_if(growing_, [](const Growing& g) { return !g.steps.empty(); });
    }
    return found == growing_.end() ? nullptr : &*found;
}

void SurfaceMaker::take_up(Request request) {
    begun_ = Clock::now();
    request_ = std::move(request);
    if (request_.other) {
        coarse_.clear();
        streaming_ = false;
        streaming_step_ = 0;
        for (Growing& one : growing_) {
            one.shown.reset();
            if (!request_.part) one.made = {};
        }
    }
    if (!request_.field) {
        growing_.clear();
        return;
    }
    const SampleBox& changed = request_.changed;
    for (auto& [step, samples] : coarse_) samples.mark(changed);
    const bool all = changed == whole_box(request_.field->geometry());
    if (all && !request_.other) {
        streaming_ = true;
        if (streaming_step_ == 0) streaming_step_ = steps().front();
    }
    for (Growing& one : growing_) {
        if (streaming_ && all) restart(one, streaming_step_);
        for (auto* blocks : {&one.shown, &one.moving, &one.finer}) {
            if (*blocks) (*blocks)->mark(changed);
        }
        one.due = one.due || !changed.empty();
    }
    if (!all) streaming_ = false;
    take_up_levels();
    if (!is_due()) tell();
}

/// Each level takes the surface that has it already, or else any, which stands in for it.
void SurfaceMaker::take_up_levels() {
    std::vector<Growing> before = std::exchange(growing_, {});
    const std::vector<double>& levels = request_.levels;
    growing_.resize(levels.size());
    std::vector<bool> has(levels.size());
    const auto claim = [&](auto fits) {
        for (std::size_t i = 0; i < levels.size(); ++i) {
            const auto found =
                std::ranges::find_if(before, [&](const Growing& g) { return fits(g, levels[i]); });
            if (has[i] || found == before.end()) continue;
            growing_[i] = std::move(*found);
            before.erase(found);
            has[i] = true;
        }
    };
    claim([](const Growing& g, double level) { return g.level == level; });
    claim([](const Growing&, double) { return true; });
    for (std::size_t i = 0; i < levels.size(); ++i) {
        Growing& one = growing_[i];
        one.most = i == 0 ? most_triangles_.load() : limits_.most_of_others;
        const std::size_t before =
            std::exchange(one.quick, i == 0 ? moving_triangles_.load() : limits_.moving_of_others);
        if (one.shown && one.level == levels[i]) {
            // A level that only has another place keeps its meshes.
            const bool limited = i == 0 && one.quick < before;
            one.due = one.due || (limited && !is_quick(one, one.moving ? *one.moving : *one.shown));
            continue;
        }
        one.level = levels[i];
        restart(one, streaming_ ? streaming_step_ : steps().front());
    }
}

void SurfaceMaker::restart(Growing& one, int step) {
    one.shown = blocks_of(step);
    one.moving.reset();
    one.finer.reset();
    one.steps = steps();
    std::erase_if(one.steps, [&](int finer) { return finer >= step; });
    one.due = true;
    one.begun = begun_;
}

std::vector<int> SurfaceMaker::steps() const {
    return limits_.coarse_first ? steps_for(request_.field->geometry().size) : std::vector{1};
}

SurfaceBlocks SurfaceMaker::blocks_of(int every) const {
    const Field& field = *request_.field;
    const Geometry& whole = request_.part ? request_.part->grid : field.geometry();
    return {field.geometry(), every, field.interpolation(), physical_centre(whole)};
}

void SurfaceMaker::work(Growing& one, const GoOn& first_goes_on, const GoOn& finer_goes_on) {
    std::string what = "there is not enough memory for the surface";
    try {
        if (!one.due) return make_finer(one, finer_goes_on);
        make_first(one, first_goes_on);
        if (streaming_ && !is_due()) adapt_step();
        return;
    } catch (const std::bad_alloc&) {
    } catch (const std::exception& error) {
        what = error.what();
    }
    const double level = one.level;
    one = {};
    one.level = level;
    tell();
    hand_over(this, [this, what] { Q_EMIT problem(QString::fromStdString(what)); });
}

SurfaceBlocks::Outcome SurfaceMaker::renew(const Growing& one, SurfaceBlocks& blocks,
                                           const GoOn& go_on, std::size_t most) {
    const int every = blocks.every();
    const Field& field = *request_.field;
    return blocks.renew(
        every == 1 ? field : coarse_.try_emplace(every, every).first->second.of(field), one.level,
        go_on, most);
}

/// The first picture that has the change in it.
void SurfaceMaker::make_first(Growing& one, const GoOn& go_on) {
    if (!std::isfinite(one.level)) throw std::invalid_argument("the isovalue is not finite");
    for (;;) {
        const bool is_new = one.shown->triangles() == 0;
        const Outcome outcome = renew(one, *one.shown, go_on, is_new ? one.most : no_limit);
        if (outcome == Outcome::interrupted) return;
        if (outcome == Outcome::done) break;
        one.shown = blocks_of(one.shown->every() + 1);
        one.steps.clear();
    }
    if (!make_moving(one, go_on)) return;
    one.due = false;
    publish(one);
}

/// Quick to draw, and to bring up to date.
bool SurfaceMaker::is_quick(const Growing& one, const SurfaceBlocks& blocks) {
    const Index3 size = coarse_size(request_.field->geometry().size, blocks.every());
    return size.maxCoeff() == 1 ||
           (blocks.triangles() <= one.quick &&
            (blocks.every() == 1 || size.cast<double>().prod() <= most_kept));
}

bool SurfaceMaker::make_moving(Growing& one, const GoOn& go_on) {
    if (is_quick(one, *one.shown)) {
        one.moving.reset();
        return true;
    }
    if (!one.moving) one.moving = blocks_of(2 * one.shown->every());
    for (;;) {
        if (renew(one, *one.moving, go_on, no_limit) != Outcome::done) return false;
        if (is_quick(one, *one.moving)) return true;
        one.moving = blocks_of(2 * one.moving->every());
    }
}

/// The finished blocks of a step that is interrupted are kept.
void SurfaceMaker::make_finer(Growing& one, const GoOn& go_on) {
    const int step = one.steps.front();
    if (!one.finer) one.finer = blocks_of(step);
    const Outcome outcome = renew(one, *one.finer, go_on, one.most);
    if (outcome == Outcome::interrupted) return;
    one.steps.erase(one.steps.begin());
    if (outcome == Outcome::too_many) {
        // A finer step would be too large as well. What is shown may be the next coarser one.
        one.finer.reset();
        one.steps.clear();
        if (step + 1 < one.shown->every()) one.steps.push_back(step + 1);
        if (one.steps.empty()) publish(one);
        return;
    }
    if (is_quick(one, *one.finer)) {
        one.moving.reset();
    } else if (!one.moving) {
        one.moving = std::move(one.shown);
    }
    one.shown = std::exchange(one.finer, std::nullopt);
    publish(one);
}

void SurfaceMaker::publish(Growing& one) {
    one.made.isovalue = one.level;
    one.made.blocks = one.shown->meshes();
    one.made.moving = (one.moving ? *one.moving : *one.shown).meshes();
    one.made.every = one.shown->every();
    one.made.finished = one.steps.empty();
    one.made.seconds = seconds_since(one.begun);
    one.made.part = request_.part;
    tell();
}

/// Surfaces of an older request are taken, too, while there are no newer ones. Never of other data.
void SurfaceMaker::tell() {
    std::vector<ExtractedSurface> all;
    for (const Growing& one : growing_) all.push_back(one.made);
    const bool done = !next_work();
    hand_over(this, [this, number = request_.number, all = std::move(all), done] {
        if (number < oldest_) return;
        surfaces_ = all;
        if (done) answered_ = number;
        Q_EMIT made();
    });
}

/// The finest step whose surfaces come within streaming_seconds.
void SurfaceMaker::adapt_step() {
    const double seconds = seconds_since(begun_), p = streaming_step_;
    if (seconds > 1.25 * streaming_seconds) {
        streaming_step_ = std::min(streaming_step_ + 1, 2 * steps().front());
    } else if (p > 1 && seconds * std::pow(p / (p - 1), 3) < streaming_seconds) {
        --streaming_step_;
    }
}

std::vector<ExtractedSurface> label_surfaces(const Overlay& overlay,
                                             const std::function<void(double)>& progress) {
    constexpr std::size_t most_triangles = 4'000'000, moving_triangles = 40'000;
    const Vec3 origin = physical_centre(overlay.volume.geometry());
    std::vector<ExtractedSurface> surfaces;
    for (const Label& label : overlay.labels) {
        progress(double(surfaces.size()) / double(overlay.labels.size()));
        // Linear: what is a sample wide stays whole.
        const Field field(label_mask(overlay, label), Solid::above, 0, Interpolation::linear);
        const auto meshes = [&](int every) {
            SurfaceBlocks blocks(field.geometry(), every, field.interpolation(), origin);
            (void)blocks.renew(
                every == 1 ? field : CoarseSamples(every).of(field), 0.5, [] { return true; },
                most_triangles);
            return blocks.meshes();
        };
        ExtractedSurface surface;
        surface.blocks = surface.moving = meshes(1);
        const std::size_t few =
            std::max<std::size_t>(500, moving_triangles / overlay.labels.size());
        const int most = field.geometry().size.maxCoeff();
        for (int every = 2; triangle_count(surface.moving) > few && every < most; every *= 2) {
            surface.moving = meshes(every);
        }
        surface.finished = true;
        surfaces.push_back(std::move(surface));
    }
    progress(1);
    return surfaces;
}

}  // namespace palpate::viewer
