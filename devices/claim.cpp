// The devices that hands of this process have.
#include "devices/claim.hpp"

#include <map>
#include <mutex>
#include <utility>

#include "palpate/devices/devices.hpp"

namespace palpate::devices {
namespace {

struct Held {
    std::mutex mutex;
    std::map<std::string, const void*> hands;  // by their devices

    bool is_by(const void* hand, const std::string& device) {
        const std::lock_guard lock(mutex);
        const auto at = hands.find(device);
        return at != hands.end() && at->second == hand;
    }
};
Held& held() {
    // Never destroyed: a thread that was left alone may end while the program does.
    static Held& all = *new Held;
    return all;
}

thread_local const OpenedBy* opening = nullptr;

}  // namespace

OpenedBy::OpenedBy(const void* hand, std::function<void()> let_go)
    : hand_(hand), let_go_(std::move(let_go)) {
    opening = this;
}

OpenedBy::~OpenedBy() {
    opening = nullptr;
}

const void* opening_hand() {
    return opening ? opening->hand_ : nullptr;
}

Claim::Claim(std::string device, const void* hand) : device_(std::move(device)) {
    if (opening && opening->hand_ == hand && held().is_by(hand, device_)) opening->let_go_();
    const std::lock_guard lock(held().mutex);
    if (!held().hands.try_emplace(device_, hand).second) {
        throw DeviceError(device_ + " serves another hand: give each hand a device of its own");
    }
}

void Claim::leave() {
    const std::lock_guard lock(held().mutex);
    held().hands[device_] = nullptr;
}

Claim::~Claim() {
    if (device_.empty()) return;
    const std::lock_guard lock(held().mutex);
    held().hands.erase(device_);
}

}  // namespace palpate::devices
