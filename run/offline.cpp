// Renders a trajectory and sums it up.
#include "palpate/run/offline.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <stdexcept>

namespace palpate::run {
namespace {

constexpr std::int64_t ticks_between_progress = 1024;

std::int64_t steady_ns() noexcept {
    return std::chrono::nanoseconds(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// Passes the corners of the SCP's polyline on. A crossed wall is no corner, nor is a goal. The
/// last corner of a tick is held back for its SCP, from which it differs by rounding: that is
/// computed in index space, and where the SCP has reached the HIP it is the HIP, bit for bit.
struct PathTap {
    const OfflineSinks* sinks;
    std::int64_t tick = 0;
    std::optional<Vec3> last = {};

    static void on_step(const Step& step, void* context) {
        if (step.kind == StepKind::cross || step.kind == StepKind::goal) return;
        auto& tap = *static_cast<PathTap*>(context);
        if (tap.last) tap.sinks->corner(tap.tick, *tap.last);
        tap.last = step.point;
    }
    void end_tick(const Vec3& scp) {
        if (last) sinks->corner(tick, scp);
        last.reset();
    }
};

void add_to_summary(OfflineSummary& summary, const Tick& tick, double range) {
    ++summary.ticks;
    summary.out_of_budget += tick.proxy.status == UpdateStatus::out_of_budget;
    summary.recovering += tick.proxy.status == UpdateStatus::recovering;
    summary.refused +=
        tick.proxy.status == UpdateStatus::refused || tick.proxy.status == UpdateStatus::not_finite;
    summary.mean_tetrahedra += tick.proxy.tetrahedra;
    summary.mean_ns += static_cast<double>(tick.update_ns);
    summary.largest_force = std::max(summary.largest_force, tick.force.norm());
    const bool felt =
        tick.proxy.status == UpdateStatus::done || tick.proxy.status == UpdateStatus::out_of_budget;
    if (felt && tick.proxy.mode == Mode::constrained) {
        ++summary.constrained;
        summary.worst_surface_error =
            std::max(summary.worst_surface_error,
                     std::abs(tick.proxy.density - tick.proxy.isovalue) / range);
    }
}

void finish(OfflineSummary& summary, std::vector<std::int64_t>& times) {
    const auto n = static_cast<double>(summary.ticks);
    summary.mean_tetrahedra /= n;
    summary.mean_ns /= n;
    std::ranges::sort(times);
    const auto at = [&](double part) {
        return times[static_cast<std::size_t>(part * static_cast<double>(times.size() - 1))];
    };
    summary.p50_ns = at(0.5);
    summary.p99_ns = at(0.99);
    summary.p999_ns = at(0.999);
    summary.max_ns = times.back();
}

}  // namespace

OfflineSummary render_offline(Renderer& renderer, const io::Trajectory& trajectory,
                              const OfflineSinks& sinks) {
    const Vec3& first = trajectory.position.front();
    const auto& layers = renderer.settings.layers;
    const bool has_surfaces = layers && !layers->layers.empty();  // they place the proxy themselves
    if (!has_surfaces && !place(renderer.proxy, renderer.field, first, renderer.proxy.isovalue)) {
        throw std::invalid_argument(
            "no free space was found at this isovalue: everything is solid; choose another "
            "isovalue or background");
    }
    OfflineSummary summary;
    std::vector<std::int64_t> times;
    times.reserve(trajectory.time.size());
    PathTap tap{&sinks};
    const StepObserver observer =
        sinks.corner ? StepObserver{&PathTap::on_step, &tap} : StepObserver{};
    if (sinks.corner && !has_surfaces) sinks.corner(0, renderer.proxy.scp_physical);
    const auto count = static_cast<std::int64_t>(trajectory.time.size());
    for (std::int64_t i = 0; i < count; ++i) {
        tap.tick = i;
        const auto at = static_cast<std::size_t>(i);
        const Vec3 hand =
            device_from_physical(renderer.settings.transform, trajectory.position[at]);
        if (sinks.change) sinks.change(renderer, i);
        const DeviceState device{trajectory.time[at], hand, true};
        // A renderer is a value: a copy of it is watched, so that the time of the update is that of
        // the update and nothing else.
        if (sinks.corner) {
            Renderer watched = renderer;
            render(watched, device, observer);
        }
        const Tick tick = render(renderer, device, {}, &steady_ns);
        tap.end_tick(tick.proxy.scp);
        if (sinks.row) sinks.row(io::trace_row(tick));
        times.push_back(tick.update_ns);
        add_to_summary(summary, tick, renderer.field.range());
        if (sinks.progress && i % ticks_between_progress == 0) {
            sinks.progress(static_cast<double>(i) / static_cast<double>(count));
        }
    }
    finish(summary, times);
    return summary;
}

}  // namespace palpate::run
