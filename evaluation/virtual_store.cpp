// The formula of the balls, and waiting as for a network.
#include "evaluation/virtual_store.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <condition_variable>

namespace palpate::evaluation {
namespace {

constexpr int size = 12288, levels = 8, chunk = 64;
constexpr double period = 768, radius = 256;  // [voxel]
constexpr double pause_after_failure_s = 0.1;

/// From the nearest plane through centres, along one axis [voxel].
double from_centre(double voxel) {
    const double in_period = voxel - period * std::floor(voxel / period);
    return in_period - period / 2;
}

/// Sleeps; throws stream::Cancelled as soon as it is to stop.
void sleep_for(double seconds, const std::stop_token& stop) {
    std::mutex mutex;
    std::condition_variable_any never;
    std::unique_lock lock(mutex);
    never.wait_for(lock, stop, std::chrono::duration<double>(seconds), [] { return false; });
    if (stop.stop_requested()) throw stream::Cancelled{};
}

/// Squared distances from the nearest centre along one axis, of the samples of a level.
std::vector<double> squares(int level, int low, int high) {
    std::vector<double> all;
    for (int i = low; i <= high; ++i) {
        const double away = from_centre(std::ldexp(i + 0.5, level) - 0.5);
        all.push_back(away * away);
    }
    return all;
}

}  // namespace

double ball_depth(const Vec3& point) {
    return radius - (point / ball_voxel).unaryExpr(&from_centre).norm();
}

VirtualStore::VirtualStore(const Network& network, std::uint64_t seed)
    : network_(network), random_(seed) {
    info_.address = "balls";
    info_.format = "computed";
    info_.range = stream::Range{0, 255};
    for (int level = 0; level < levels; ++level) {
        Geometry geometry;
        geometry.size = Index3::Constant(size >> level);
        geometry.spacing = Vec3::Constant(std::ldexp(ball_voxel, level));
        geometry.origin = Vec3::Constant(0.5 * (std::ldexp(ball_voxel, level) - ball_voxel));
        info_.levels.push_back({geometry, Index3::Constant(chunk)});
    }
}

void VirtualStore::read(int level, const SampleBox& box, std::span<std::byte> out,
                        std::stop_token stop) const {
    wait_for_answer(out.size(), stop);
    const auto x = squares(level, box.low[0], box.high[0]);
    const auto y = squares(level, box.low[1], box.high[1]);
    const auto z = squares(level, box.low[2], box.high[2]);
    auto* sample = reinterpret_cast<std::uint8_t*>(out.data());
    for (const double in_z : z) {
        for (const double in_y : y) {
            for (const double in_x : x) {
                const double depth = radius - std::sqrt(in_x + in_y + in_z);
                *sample++ = static_cast<std::uint8_t>(
                    std::clamp(std::floor(ball_isovalue + 0.5 + depth / 2), 0.0, 255.0));
            }
        }
    }
}

stream::Traffic VirtualStore::traffic() const {
    const std::scoped_lock lock(mutex_);
    return traffic_;
}

void VirtualStore::wait_for_answer(std::size_t bytes, const std::stop_token& stop) const {
    for (;;) {
        sleep_for(network_.latency_s, stop);
        const bool failed = chance() < network_.failures;
        {
            const std::scoped_lock lock(mutex_);
            ++traffic_.requests;
            traffic_.retries += failed;
            if (!failed) traffic_.bytes += bytes;
        }
        if (!failed) return;
        sleep_for(pause_after_failure_s * (0.5 + chance()), stop);
    }
}

double VirtualStore::chance() const {
    const std::scoped_lock lock(mutex_);
    return std::uniform_real_distribution(0.0, 1.0)(random_);
}

}  // namespace palpate::evaluation
