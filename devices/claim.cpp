// The devices that hands of this process have.
#include "devices/claim.hpp"

#include <map>
#include <mutex>
#include <utility>

#include "palpate/devices/devices.hpp"

namespace palpate::devices {
namespace {

/// The hand that has a device.
struct Holder {
    const void* hand;
    std::uint64_t number;  // of its claim
    bool has_left = false;
};
struct Held {
    std::mutex mutex;
    std::map<std::string, Holder> holders;  // by their devices
    std::uint64_t last_number = 0;

    bool is_by(const void* hand, const std::string& device) {
        const std::lock_guard lock(mutex);
        const auto at = holders.find(device);
        return at != holders.end() && at->second.hand == hand && !at->second.has_left;
    }
};
Held& held() {
    // Never destroyed: a thread that was left alone may end while the program does.
    static Held& all = *new Held;
    return all;
}

thread_local const OpenedBy* opening = nullptr;

}  // namespace

OpenedBy::OpenedBy(const void* hand, std::function<void()> close)
    : hand_(hand), close_(std::move(close)) {
    opening = this;
}

OpenedBy::~OpenedBy() {
    opening = nullptr;
}

const void* opening_hand() {
    return opening ? opening->hand_ : nullptr;
}

Claim::Claim(std::string device, const void* hand) : device_(std::move(device)) {
    const bool can_close = opening && opening->hand_ == hand && opening->close_;
    if (can_close && held().is_by(hand, device_)) opening->close_();
    const std::lock_guard lock(held().mutex);
    number_ = ++held().last_number;
    const auto [at, is_free] = held().holders.try_emplace(device_, Holder{hand, number_});
    if (is_free) return;
    if (at->second.has_left) {
        throw DeviceError(device_ +
                          " is not free yet: its driver has not returned since it was last opened "
                          "or closed. Try again later; if it never returns, switch the device off "
                          "and on, or start this program again");
    }
    throw DeviceError(device_ + " serves another hand: give each hand a device of its own");
}

std::function<void()> Claim::leaving() const {
    return [device = device_, number = number_] {
        const std::lock_guard lock(held().mutex);
        const auto at = held().holders.find(device);
        if (at != held().holders.end() && at->second.number == number) at->second.has_left = true;
    };
}

Claim::~Claim() {
    if (device_.empty()) return;
    const std::lock_guard lock(held().mutex);
    held().holders.erase(device_);
}

}  // namespace palpate::devices
