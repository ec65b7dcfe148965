// Stores the newest reading and the newest wrench with their ages.
#include "devices/link.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

namespace palpate::devices {

std::int64_t monotonic_ns() noexcept {
    return std::chrono::duration_cast<std::chrono::nanoseconds>(
               std::chrono::steady_clock::now().time_since_epoch())
        .count();
}

DeviceReading Link::read(std::int64_t now) const noexcept {
    const auto report = reading_.get();
    if (!report) return {};
    DeviceReading reading = report->reading;
    reading.age += 1e-9 * static_cast<double>(std::max<std::int64_t>(0, now - report->at));
    if (reading.status == DeviceStatus::ready && !(reading.age <= Device::longest_force)) {
        reading.status = DeviceStatus::stale;
    }
    return reading;
}

void Link::write(const Wrench& wrench, std::int64_t now) noexcept {
    const auto& [f, t] = wrench;
    wrench_.put({{f[0], f[1], f[2]}, {t[0], t[1], t[2]}, now});
}

void Link::report(const DeviceReading& reading, std::int64_t now) noexcept {
    last_ = reading;
    // An age below 0 would come to look fresh when time is added to it.
    if (!(last_.age >= 0)) last_.age = std::numeric_limits<double>::quiet_NaN();
    if (last_.opening && !std::isfinite(*last_.opening)) last_.opening.reset();
    reading_.put({last_, now});
}

void Link::report(DeviceStatus status, std::int64_t now) noexcept {
    last_.status = status;
    last_.age = 0;
    reading_.put({last_, now});
}

Wrench Link::wrench(std::int64_t now) const noexcept {
    if (stopped()) {
        if (zeros_.load(std::memory_order_relaxed) < 2) zeros_.fetch_add(1);
        return {};
    }
    const auto newest = wrench_.get();
    if (!newest) return {};
    const double age = 1e-9 * static_cast<double>(now - newest->at);
    const Wrench wrench{Vec3(newest->force), Vec3(newest->torque)};
    const bool good =
        age <= Device::longest_force && wrench.force.allFinite() && wrench.torque.allFinite();
    return good ? wrench : Wrench{};
}

bool Link::is_driven(std::int64_t now) const noexcept {
    const auto newest = wrench_.get();
    return !stopped() && newest &&
           1e-9 * static_cast<double>(now - newest->at) <= Device::longest_force;
}

void Link::stop() noexcept {
    stopped_.store(true, std::memory_order_release);
}

bool Link::stopping() const noexcept {
    return stopped() && zeros_.load(std::memory_order_acquire) < 2;
}

bool Link::stopped() const noexcept {
    return stopped_.load(std::memory_order_acquire);
}

}  // namespace palpate::devices
