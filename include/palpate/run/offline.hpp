// Renders a trajectory of the hand offline: the same ticks as a live run, as fast as possible.
#pragma once

#include <chrono>
#include <functional>
#include <string>
#include <vector>

#include "palpate/io/trace.hpp"
#include "palpate/io/trajectory.hpp"
#include "palpate/renderer.hpp"
#include "palpate/run/source.hpp"

namespace palpate::run {

/// Numbers about a rendered trajectory.
struct OfflineSummary {
    std::int64_t ticks = 0;
    std::int64_t constrained = 0;
    std::int64_t out_of_budget = 0;  ///< updates that the next tick had to continue
    std::int64_t recovering = 0;     ///< not yet out of the solid: no force
    std::int64_t refused = 0;        ///< positions extremely far away: no force, nothing changed
    double worst_surface_error =
        0;                      ///< largest |f - isovalue| / range at the SCP or points in contact
    double largest_force = 0;   ///< [N]
    double largest_torque = 0;  ///< [N mm]
    std::int64_t most_contacts = 0;  ///< of a tool in one tick
    double mean_tetrahedra = 0;
    /// Time of a proxy update [ns].
    double mean_ns = 0;
    std::int64_t p50_ns = 0, p99_ns = 0, p999_ns = 0, max_ns = 0;
};

/// Receivers of the ticks; any may be empty. The last corner of a tick is its SCP, bit for bit, and
/// the last pose that of the proxy.
struct OfflineSinks {
    /// Called before each tick; it may change the renderer.
    std::function<void(Renderer& renderer, std::int64_t tick)> change;
    std::function<void(const io::TraceRow&)> row;
    std::function<void(std::int64_t tick, const Vec3& corner)> corner;  ///< of the SCP's path [mm]
    std::function<void(std::int64_t tick, const Pose& pose)> pose;      ///< of a tool's way
    std::function<void(double fraction)> progress;
};

/// Columns that a trace has with these settings. `streamed`: the samples are those of a store.
io::TraceExtras trace_extras(const RendererSettings& settings, bool streamed = false);

/// For OfflineSinks::change, with a store: waits before each tick until all samples that it may
/// need are in memory, so the ticks are those of the whole volume. Keeps references to both
/// arguments. Null for other volumes. `tell` is called repeatedly during the wait, and may throw.
/// The function throws as stream::BrickLoader::wait_for() does.
std::function<void(Renderer&, std::int64_t)> wait_for_bricks(const LoadedVolume& loaded,
                                                             const io::Trajectory& trajectory,
                                                             std::function<void()> tell = {});

/// For OfflineSinks::change: keeps the pace of the trajectory. With a store, the proxy is held
/// where samples are missing (UpdateStatus::waiting), as in a live session, so the ticks depend on
/// how fast the store answers. Before each tick, `wait_until` is called with the seconds since the
/// first one. It waits, returns the time, and may throw. Keeps a reference to the trajectory.
std::function<void(Renderer&, std::int64_t)> keep_pace(
    const LoadedVolume& loaded, const io::Trajectory& trajectory,
    std::function<std::chrono::steady_clock::time_point(double seconds)> wait_until);

/// Renders each position of the trajectory (physical space) in order. The proxy begins at the first
/// position if that is free, else where recovery finds free space. With layers, it begins in the
/// tissue there if its surface can give way. A tool begins at the first pose, and recovers if it is
/// inside the solid. Throws std::invalid_argument if all of space is solid. Exceptions of a sink
/// are passed on.
OfflineSummary render_offline(Renderer& renderer, const io::Trajectory& trajectory,
                              const OfflineSinks& sinks);

}  // namespace palpate::run
