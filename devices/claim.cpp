// The devices that hands of this process have.
#include "devices/claim.hpp"

#include <map>
#include <mutex>
#include <utility>

#include "palpate/devices/devices.hpp"

namespace palpate::devices {
namespace {

struct Holder {
    const void* hand;
    int times;
};
struct Held {
    std::mutex mutex;
    std::map<std::string, Holder> devices;
};
Held& held() {
    static Held all;
    return all;
}

thread_local const void* opening_hand = nullptr;

}  // namespace

OpenedBy::OpenedBy(const void* hand) {
    opening_hand = hand;
}

OpenedBy::~OpenedBy() {
    opening_hand = nullptr;
}

Claim::Claim(std::string device) : device_(std::move(device)) {
    const std::lock_guard lock(held().mutex);
    const auto [at, is_new] = held().devices.try_emplace(device_, Holder{opening_hand, 0});
    if (!is_new && (opening_hand == nullptr || at->second.hand != opening_hand)) {
        throw DeviceError(device_ + " serves another hand: give each hand a device of its own");
    }
    ++at->second.times;
}

Claim::~Claim() {
    const std::lock_guard lock(held().mutex);
    const auto at = held().devices.find(device_);
    if (--at->second.times == 0) held().devices.erase(at);
}

}  // namespace palpate::devices
