// Asks the system for the privileges of a thread that talks to a device. Linux and Windows give it
// those of the servo's thread. See link.hpp.
#include <optional>

#include "devices/ends.hpp"
#include "devices/link.hpp"
#include "servo/clocks.hpp"
#include "servo/privileges.hpp"

namespace palpate::devices {
namespace {

constexpr int priority_of_devices = 81;  // just above the servo's

thread_local bool talks_to_a_device = false;  // plain, for signal handlers
thread_local std::optional<Alarm> alarm;

}  // namespace

void sleep_until(std::int64_t ns) noexcept {
    if (alarm) return alarm->sleep_until(ns);
    Alarm().sleep_until(ns);
}

bool is_device_thread() noexcept {
    return talks_to_a_device;
}

void prepare_device_thread() noexcept {
    talks_to_a_device = true;
    alarm.emplace();
    take_priority(priority_of_devices);
    leave_ends_to_others();
}

}  // namespace palpate::devices
