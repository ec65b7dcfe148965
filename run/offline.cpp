// Renders a trajectory and sums it up.
#include "palpate/run/offline.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iterator>
#include <optional>
#include <span>
#include <stdexcept>

#include "palpate/lattice.hpp"
#include "stream/while_telling.hpp"

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

/// Passes the poses of a tool's proxy on, and their places as corners.
struct PoseTap {
    const OfflineSinks* sinks;
    std::int64_t tick = 0;
    std::optional<Pose> last = {};

    static void on_pose(const Pose& pose, void* context) {
        auto& tap = *static_cast<PoseTap*>(context);
        tap.last = pose;
        if (tap.sinks->pose) tap.sinks->pose(tap.tick, pose);
        if (tap.sinks->corner) tap.sinks->corner(tap.tick, pose.position);
    }
};

/// Largest |f - isovalue| at what touches [data units].
double surface_error(const Renderer& renderer, const Tick& tick) {
    if (!renderer.settings.tool) return std::abs(tick.proxy.density - tick.proxy.isovalue);
    const ToolProxy& proxy = *renderer.tool_proxy;
    double most = 0;
    for (const ToolContact& contact :
         std::span(proxy.contacts.data(), std::size_t(proxy.contact_count))) {
        if (!(contact.pressure > 0)) continue;
        const Vec3& point = proxy.tool().points()[std::size_t(contact.point)];
        const double density = value_at(renderer.field, physical_from_tool(proxy.pose, point));
        most = std::max(most, std::abs(density - tick.proxy.isovalue));
    }
    return most;
}

void add_to_summary(OfflineSummary& summary, const Tick& tick, const Renderer& renderer) {
    ++summary.ticks;
    summary.out_of_budget += tick.proxy.status == UpdateStatus::out_of_budget;
    summary.recovering += tick.proxy.status == UpdateStatus::recovering;
    summary.refused +=
        tick.proxy.status == UpdateStatus::refused || tick.proxy.status == UpdateStatus::not_finite;
    summary.mean_tetrahedra += tick.proxy.tetrahedra;
    summary.mean_ns += static_cast<double>(tick.update_ns);
    summary.largest_force = std::max(summary.largest_force, tick.force.norm());
    summary.largest_torque = std::max(summary.largest_torque, tick.torque.norm());
    summary.most_contacts = std::max(summary.most_contacts, std::int64_t{tick.tool.contacts});
    const bool felt =
        tick.proxy.status == UpdateStatus::done || tick.proxy.status == UpdateStatus::out_of_budget;
    if (felt && tick.proxy.mode == Mode::constrained) {
        ++summary.constrained;
        summary.worst_surface_error = std::max(
            summary.worst_surface_error, surface_error(renderer, tick) / renderer.field.range());
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

/// How far from the hand [mm] a tick may look at samples.
double reach_of(const Renderer& renderer, const Vec3& hip, const Quaternion& turned) {
    if (const auto& tool = renderer.settings.tool) {
        const ToolProxy& proxy = *renderer.tool_proxy;
        if (!proxy.placed) return tool->radius();
        const double turn =
            tool->gyration() * rotation_between(proxy.pose.orientation, turned).norm();
        return std::hypot((proxy.pose.position - hip).norm(), turn) + tool->radius();
    }
    double reach = renderer.proxy.placed ? (renderer.proxy.scp_physical - hip).norm() : 0;
    if (renderer.layers.moved) reach += (renderer.layers.hip - hip).norm();
    return reach;
}

/// The proxy's reference point [mm, physical], or the hand where there is no proxy yet.
Vec3 scp_or(const Renderer& renderer, const Vec3& hip) {
    if (renderer.settings.tool) {
        const ToolProxy& proxy = *renderer.tool_proxy;
        return proxy.placed ? proxy.pose.position : hip;
    }
    return renderer.proxy.placed ? renderer.proxy.scp_physical : hip;
}

std::shared_ptr<stream::BrickLoader> loader_of(const LoadedVolume& loaded) {
    return std::make_shared<stream::BrickLoader>(loaded.streamed->store, loaded.volume,
                                                 loaded.streamed->loader);
}

void take_bricks(stream::BrickLoader& loader, Renderer& renderer) {
    const auto version = loader.take();
    if (!version) return;
    field_will_change(renderer.proxy, felt_field(renderer));
    renderer.field.use(version->samples);
}

}  // namespace

io::TraceExtras trace_extras(const RendererSettings& settings, bool streamed) {
    io::TraceExtras extras;
    extras.tool = settings.tool != nullptr;
    extras.streamed = streamed;
    if (!settings.layers) return extras;
    std::ranges::transform(settings.layers->layers, std::back_inserter(extras.layer_names),
                           &Layer::name);
    extras.nested_layers = level_count(*settings.layers);
    return extras;
}

std::function<void(Renderer&, std::int64_t)> wait_for_bricks(const LoadedVolume& loaded,
                                                             const io::Trajectory& trajectory,
                                                             std::function<void()> tell) {
    if (!loaded.streamed) return {};
    return [loader = loader_of(loaded), &trajectory, tell = std::move(tell)](Renderer& renderer,
                                                                             std::int64_t tick) {
        const auto at = static_cast<std::size_t>(tick);
        const Vec3& hip = trajectory.position[at];
        const Quaternion turned =
            trajectory.orientation.empty() ? Quaternion::Identity() : trajectory.orientation[at];
        const double reach = reach_of(renderer, hip, turned);
        if (is_resident(renderer.field, hip, reach)) return;
        stream::while_telling(
            tell, [&](const std::stop_token& stop) { loader->wait_for(hip, reach, stop); });
        take_bricks(*loader, renderer);
    };
}

std::function<void(Renderer&, std::int64_t)> keep_pace(
    const LoadedVolume& loaded, const io::Trajectory& trajectory,
    std::function<std::chrono::steady_clock::time_point(double seconds)> wait_until) {
    return [loader = loaded.streamed ? loader_of(loaded) : nullptr, &trajectory,
            wait_until = std::move(wait_until),
            motion = stream::HandMotion{}](Renderer& renderer, std::int64_t tick) mutable {
        const auto at = static_cast<std::size_t>(tick);
        const double time = trajectory.time[at];
        const auto now = wait_until(time - trajectory.time.front());
        if (!loader) return;
        motion.see(time, trajectory.position[at]);
        const stream::Interest hand{scp_or(renderer, motion.at), motion.at, motion.velocity};
        loader->look(std::span(&hand, 1), now);
        take_bricks(*loader, renderer);
    };
}

OfflineSummary render_offline(Renderer& renderer, const io::Trajectory& trajectory,
                              const OfflineSinks& sinks) {
    const Vec3& first = trajectory.position.front();
    // They place the proxy themselves.
    const bool has_surfaces = have_surfaces(renderer.settings.layers);
    const bool streamed = renderer.field.samples().resident() != nullptr;
    if (!has_surfaces && !streamed &&
        !place(renderer.proxy, renderer.field, first, renderer.proxy.isovalue)) {
        throw std::invalid_argument(
            "no free space was found at this isovalue: everything is solid; choose another "
            "isovalue or background");
    }
    OfflineSummary summary;
    std::vector<std::int64_t> times;
    times.reserve(trajectory.time.size());
    PathTap tap{&sinks};
    PoseTap pose_tap{&sinks};
    const StepObserver observer =
        sinks.corner ? StepObserver{&PathTap::on_step, &tap} : StepObserver{};
    const PoseObserver pose_observer{&PoseTap::on_pose, &pose_tap};
    const bool has_tool = renderer.settings.tool != nullptr;
    const bool watches = has_tool ? sinks.corner || sinks.pose : bool(sinks.corner);
    if (sinks.corner && !has_surfaces && !has_tool && !streamed) {
        sinks.corner(0, renderer.proxy.scp_physical);
    }
    const auto count = static_cast<std::int64_t>(trajectory.time.size());
    for (std::int64_t i = 0; i < count; ++i) {
        tap.tick = pose_tap.tick = i;
        const auto at = static_cast<std::size_t>(i);
        const Vec3 hand =
            device_from_physical(renderer.settings.transform, trajectory.position[at]);
        if (sinks.change) sinks.change(renderer, i);
        TickInput device{trajectory.time[at], hand, true};
        if (!trajectory.orientation.empty()) {
            device.orientation = renderer.settings.transform.rotation.transpose() *
                                 trajectory.orientation[at].toRotationMatrix();
        }
        // A renderer is a value: a copy of it is watched, so that the time of the update is that of
        // the update and nothing else.
        if (watches) {
            Renderer watched = renderer;
            render(watched, device, observer, nullptr, pose_observer);
            // A tick without motion has a pose, too: that of the one before.
            if (has_tool && !pose_tap.last) {
                pose_tap.on_pose(watched.tool_proxy->pose, &pose_tap);
            }
            pose_tap.last.reset();
        }
        const Tick tick = render(renderer, device, {}, &steady_ns);
        tap.end_tick(tick.proxy.scp);
        if (sinks.row) sinks.row(io::trace_row(tick));
        times.push_back(tick.update_ns);
        add_to_summary(summary, tick, renderer);
        if (sinks.progress && i % ticks_between_progress == 0) {
            sinks.progress(static_cast<double>(i) / static_cast<double>(count));
        }
    }
    finish(summary, times);
    return summary;
}

}  // namespace palpate::run
