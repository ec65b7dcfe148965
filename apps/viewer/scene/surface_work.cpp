// Extraction in steps.
#include "apps/viewer/scene/surface_work.hpp"

#include <chrono>
#include <cmath>
#include <exception>
#include <new>

#include "apps/viewer/scene/patience.hpp"
#include "pictures/surface.hpp"

namespace palpate::viewer {
namespace {

struct GivenUp {};

using Clock = std::chrono::steady_clock;

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

SurfaceWork::SurfaceWork(Results results, const SurfaceLimits& limits)
    : results_(std::move(results)), limits_(limits) {
    thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

SurfaceWork::~SurfaceWork() {
    thread_.request_stop();
    thread_.join();
}

void SurfaceWork::ask(std::uint64_t wish, const Field& field, double isovalue) {
    {
        const std::lock_guard lock(mutex_);
        next_.emplace(Wish{wish, field, isovalue});
        waiting_ = true;
    }
    changed_.notify_all();
}

void SurfaceWork::forget() {
    const std::lock_guard lock(mutex_);
    next_.reset();
    waiting_ = false;
    forgotten_ = true;
}

bool SurfaceWork::outdated(const std::stop_token& stop, bool first) const {
    return stop.stop_requested() || forgotten_ || (waiting_ && !first);
}

void SurfaceWork::run(const std::stop_token& stop) {
    stand_back();
    while (!stop.stop_requested()) {
        std::optional<Wish> wish;
        {
            std::unique_lock lock(mutex_);
            if (!changed_.wait(lock, stop, [this] { return next_.has_value(); })) return;
            wish.swap(next_);
            waiting_ = false;
            forgotten_ = false;
        }
        try {
            carry_out(*wish, stop);
        } catch (const GivenUp&) {
        } catch (const std::bad_alloc&) {
            results_.failed(wish->number, "there is not enough memory for the surface");
        } catch (const std::exception& error) {
            results_.failed(wish->number, error.what());
        }
    }
}

void SurfaceWork::carry_out(const Wish& wish, const std::stop_token& stop) {
    const auto start = Clock::now();
    const Vec3 origin = physical_centre(wish.field.geometry());
    const std::vector<int> steps = steps_for(wish.field.geometry().size);
    for (std::size_t i = 0; i < steps.size(); ++i) {
        const bool first = i == 0 && steps.size() > 1;
        const auto check = [&] {
            if (outdated(stop, first)) throw GivenUp();
        };
        check();
        pictures::SurfaceWork work;
        work.every = steps[i];
        work.most_triangles = limits_.most_triangles;
        work.progress = [&](double) { check(); };
        const pictures::ShadedSurface made =
            pictures::shaded_surface(wish.field, wish.isovalue, work);
        DrawnSurface result;
        result.mesh = std::make_shared<const DrawnMesh>(drawn_mesh(made.surface, origin));
        check();
        result.moving = result.mesh->triangle_count() <= limits_.moving_triangles
                            ? result.mesh
                            : std::make_shared<const DrawnMesh>(
                                  simplified(*result.mesh, limits_.moving_triangles));
        check();
        result.wish = wish.number;
        result.isovalue = wish.isovalue;
        result.every = made.every;
        // One that was too large for its step came out coarser; a finer step would, too.
        result.finished = i + 1 == steps.size() || made.every > steps[i];
        result.seconds = seconds_since(start);
        const bool finished = result.finished;
        results_.made(std::move(result));
        if (finished) return;
    }
}

}  // namespace palpate::viewer
