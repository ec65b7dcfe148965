// Guards devices, and stops them in a handler. A handler can reach globals only: these are the
// writable globals of the devices.
#include "palpate/devices/last_resort.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <mutex>
#include <stdexcept>

#include "devices/ends.hpp"

namespace palpate::devices {
namespace {

std::mutex changes;  // of what is guarded, by any thread; handlers do not take it
std::array<std::atomic<Device*>, LastResort::most> guarded{};
/// Devices that a handler has told to stop.
std::array<std::atomic<Device*>, LastResort::most> told{};
std::atomic<LastResort::Pause> pause_in_handler{&sleep_in_handler};

/// How long a handler waits [ms]: at least, for devices that cannot tell, and at most.
constexpr int least_wait = 100;
constexpr int most_wait = 1000;

bool is_stopping(const std::atomic<Device*>& place) {
    const Device* const device = place.load();
    return device && device->is_stopping();
}

}  // namespace

bool stop_guarded() noexcept {
    bool wait = false;
    for (std::size_t i = 0; i < guarded.size(); ++i) {
        if (Device* const device = guarded[i].load()) told[i].store(device);
        if (Device* const device = guarded[i].exchange(nullptr)) device->stop();
        wait = wait || told[i].load();
    }
    return wait;
}

void wait_for_zeros() noexcept {
    constexpr int step = 5;
    for (int waited = 0; waited < most_wait; waited += step) {
        if (waited >= least_wait && std::ranges::none_of(told, is_stopping)) return;
        pause_in_handler.load()(step);
    }
}

LastResort::LastResort(Device& device, Pause pause) {
    const std::lock_guard lock(changes);
    if (std::ranges::any_of(guarded, [&](const auto& place) { return place.load() == &device; })) {
        throw std::logic_error("this device has a last resort already");
    }
    const auto free_place = std::ranges::find_if(guarded, [&](std::atomic<Device*>& place) {
        Device* nobody = nullptr;
        return place.compare_exchange_strong(nobody, &device);
    });
    if (free_place == guarded.end()) {
        throw std::logic_error("too many devices are guarded against crashes at once");
    }
    place_ = static_cast<std::size_t>(free_place - guarded.begin());
    pause_in_handler.store(pause ? pause : &sleep_in_handler);
    handle_ends();
}

LastResort::~LastResort() {
    const std::lock_guard lock(changes);
    guarded[place_].store(nullptr);
    told[place_].store(nullptr);
    const bool last = std::ranges::none_of(guarded, [](const auto& place) { return place.load(); });
    if (last) forget_ends();
}

}  // namespace palpate::devices
